# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Repeating a run: the whole run from its picture's metadata, or a single sample."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eclat.cli.reporting import Reporter
from eclat.errors import EclatError

if TYPE_CHECKING:
    from eclat.images.image import Image

REPEATED = (
    *(
        "method",
        "settings",
        "cache",
        "max_error",
        "refine",
        "samples",
        "adaptive",
        "time",
        "max_depth",
        "seed",
        "size",
        "crop",
    ),
    *("camera", "camera_from", "camera_to", "camera_up", "fov", "sun", "environment", "materials"),
)
"""The flags that a picture's values depend on, by name; the scene is given anew, since files move."""

_WITH_SETTINGS = (".exr", ".png")
"""Pictures that hold metadata."""


def settings_of(flags: Mapping[str, Any], metadata: Mapping[str, Any]) -> dict[str, Any]:
    """What `--replay-settings` needs to make the same picture: the flags, with the samples that were really taken."""
    settings = {name: flags[name] for name in REPEATED}
    chosen = chosen_by_clock(flags, metadata)
    if chosen:
        settings["settings"] = chosen
    taken = metadata.get("statistics", {}).get("samples")
    if taken is not None:
        settings["samples"], settings["time"] = int(taken), None
        settings["adaptive"] = bool(metadata.get("adaptive"))
    # Through JSON, so that it is the same whether it comes from a file or from memory.
    plain: dict[str, Any] = json.loads(json.dumps(settings))
    return plain


def chosen_by_clock(flags: Mapping[str, Any], metadata: Mapping[str, Any]) -> list[str]:
    """The options of records that `--time` chose, as values of `--set` that choose the same without a clock."""
    from eclat.methods import METHODS

    options = metadata.get("options", {})
    method = METHODS.get(metadata.get("method", ""))
    if flags["time"] is None or flags["cache"] or method is None or not method.has_records:
        return []
    return [f"{name}={str(value).lower()}" for name, value in options.items()]


def replayed_flags(path: str, context: click.Context) -> dict[str, Any]:
    """The flags stored in a picture.

    Raises
    ------
    EclatError : the file holds none, or a flag is also given by hand.
    """
    given = click.core.ParameterSource.COMMANDLINE
    for name in REPEATED:
        if context.get_parameter_source(name) is given:
            flag = next(parameter.opts[-1] for parameter in context.command.params if parameter.name == name)
            raise EclatError(f"--replay-settings cannot be combined with {flag}: it repeats all settings")
    settings = _metadata(path).get("settings")
    if not isinstance(settings, dict) or not set(REPEATED) <= set(settings):
        raise EclatError(
            f"{path}: expected the settings of a run in the metadata, which `eclat render` writes; got none"
        )
    flags: dict[str, Any] = {}
    for parameter in context.command.params:
        if parameter.name in REPEATED:
            flags[parameter.name] = _checked(path, parameter, settings[parameter.name], context)
    return flags


def _checked(path: str, parameter: click.Parameter, value: Any, context: click.Context) -> Any:
    """The value after the same checks as on the command line, since files can be edited. Raises EclatError."""
    where = f"{path}, setting {parameter.name!r}"
    flag = isinstance(parameter.type, click.types.BoolParamType)
    several = parameter.multiple if isinstance(parameter, click.Option) else False
    plain = value is None or isinstance(value, str | int | float) or _is_plain_list(value)
    if not plain or (several and not isinstance(value, list)) or (flag and not isinstance(value, bool | None)):
        expected = "a list" if several else "true, false or null" if flag else "a number, a text or a list of them"
        raise EclatError(f"{where}: expected {expected}, got {json.dumps(value)[:60]}")
    try:
        return parameter.type_cast_value(context, value)
    except click.UsageError as error:
        raise EclatError(f"{where}: {' '.join(error.message.split())}") from None
    except (TypeError, ValueError, AttributeError, LookupError, ArithmeticError) as error:
        raise EclatError(f"{where}: expected what its flag takes, got {json.dumps(value)[:60]} ({error})") from None


def _is_plain_list(value: Any) -> bool:
    """Whether it is a list of numbers and texts, or (of flags that take several) of such lists."""
    if not isinstance(value, list):
        return False
    items = [item for part in value for item in (part if isinstance(part, list) else [part])]
    return all(isinstance(item, str | int | float) for item in items)


def say_replay_of_bad_samples(reporter: Reporter, image: Image, scene: str, outputs: Sequence[str]) -> None:
    """Where samples were not finite: the command that replays the first of them with all settings of the picture."""
    files = [name for name in outputs if Path(name).suffix.lower() in _WITH_SETTINGS]
    bad = image.metadata.get("bad_samples")
    if bad and files:
        place = ",".join(map(str, bad["first"]))
        words = ("eclat", "render", scene, "--replay-settings", files[0], "--replay", place)
        reporter.warn(f"to replay the first of these samples: {shlex.join(words)}")


def say_replayed_sample(reporter: Reporter, image: Image, replay: tuple[int, int, int]) -> None:
    """The value of the pixel whose sample was replayed."""
    x, y, sample = replay
    value = [float(channel) for channel in image.pixels[y, x]]
    # The pixel itself is the mean of what was finite.
    bad = image.metadata.get("bad_samples")
    finite = bad is None
    verdict = "finite" if bad is None else f"{bad['count']} NOT FINITE, the first is number {bad['first'][2]}"
    red, green, blue = value
    text = f"pixel ({x}, {y}), samples 0 to {sample}: {verdict}, mean radiance {red:.6g} {green:.6g} {blue:.6g}"
    reporter.result(text, pixel=[x, y], sample=sample, finite=finite, radiance=value)


def _metadata(path: str) -> dict[str, Any]:
    from eclat.images.image import Image
    from eclat.images.image_files import read_png_metadata

    if Path(path).suffix.lower() == ".png":
        return read_png_metadata(path)
    return Image.load(path).metadata
