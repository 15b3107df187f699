# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Repeating a run from the metadata of its picture, either the whole picture or one sample of a pixel."""

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
        "gathered_samples",
        "adaptive",
        "denoise",
        "halves",
        "time",
        "max_depth",
        "seed",
        "size",
        "crop",
        "light_groups",
    ),
    *("camera", "camera_from", "camera_to", "camera_up", "fov", "sun", "environment", "ies", "materials"),
    *("at", "camera_path"),
)
"""Names of the flags that determine the values of a picture. The scene is not among them: it is given again, since
files are moved."""

_NEWER = ("at", "camera_path", "gathered_samples")
"""Names of the flags that pictures of older versions do not hold. They had no effect then."""

_WITH_SETTINGS = (".exr", ".png")
"""Suffixes of picture files that store metadata."""


def settings_of(flags: Mapping[str, Any], metadata: Mapping[str, Any]) -> dict[str, Any]:
    """Collect the flags with which `--replay-settings` makes the same picture, with the number of samples taken."""
    settings = {name: flags[name] for name in REPEATED}
    chosen = chosen_by_clock(flags, metadata)
    if chosen:
        settings["settings"] = chosen
    made_by = metadata.get("method", flags["method"])
    if flags["time"] is not None and not flags["cache"] and made_by != flags["method"]:
        # There was no time for what the method needs, so another took its place.
        settings["method"], settings["settings"] = made_by, []
    if flags.get("shard"):
        settings["crop"] = metadata["continuable"]["crop"]
    taken = metadata.get("statistics", {}).get("samples")
    # Groups of lamps, each of which took its own number of samples, stop again where they did.
    if taken is not None and not flags["light_groups"]:
        settings["samples"], settings["time"] = int(taken), None
        added = metadata["statistics"].get("gathered_samples")
        settings["gathered_samples"] = None if added is None else int(added)
        settings["adaptive"] = metadata.get("adaptive", False)
        for name, made in (("denoise", "denoised"), ("halves", "halves")):
            settings[name] = bool(metadata.get(made))
    # Converting to JSON and back gives the same types that reading from a file gives.
    plain: dict[str, Any] = json.loads(json.dumps(settings))
    return plain


def chosen_by_clock(flags: Mapping[str, Any], metadata: Mapping[str, Any]) -> list[str]:
    """List the options that `--time` chose for the records as values of `--set`, with which the same records can be
    computed without `--time`.
    """
    from eclat.methods import METHODS

    options = metadata.get("options", {})
    method = METHODS.get(metadata.get("method", ""))
    if flags["time"] is None or flags["cache"] or method is None or not method.has_records:
        return []
    return [f"{name}={str(value).lower()}" for name, value in options.items()]


FREE_WHEN_CONTINUED = ("cache", "max_error", "refine", "samples", "gathered_samples", "denoise", "time")
"""Names of the flags among `REPEATED` that may differ when a picture is continued."""


def continued_flags(path: str, context: click.Context) -> dict[str, Any]:
    """Read the flags with which a picture that is continued was made, without those that say how far to go.

    Raises EclatError as `replayed_flags` does.
    """
    fixed = tuple(name for name in REPEATED if name not in FREE_WHEN_CONTINUED)
    return replayed_flags(path, context, fixed, "--continue")


def replayed_flags(
    path: str, context: click.Context, names: tuple[str, ...] = REPEATED, by: str = "--replay-settings"
) -> dict[str, Any]:
    """Read the flags of the given names that are stored in a picture; `by` is the flag that asks for it, for messages.

    Raises
    ------
    EclatError : the file holds no settings, or one of these flags is also given on the command line.
    """
    given = click.core.ParameterSource.COMMANDLINE
    for name in names:
        if context.get_parameter_source(name) is given:
            flag = next(parameter.opts[-1] for parameter in context.command.params if parameter.name == name)
            raise EclatError(f"{by} cannot be combined with {flag}: the file holds the value to use")
    settings = _metadata(path).get("settings")
    if isinstance(settings, dict):
        settings = dict.fromkeys(_NEWER) | settings
    if not isinstance(settings, dict) or not set(REPEATED) <= set(settings):
        raise EclatError(
            f"{path}: expected a picture that `eclat render` wrote, with the settings of its run in the metadata, got none"
        )
    flags: dict[str, Any] = {}
    for parameter in context.command.params:
        if parameter.name in names:
            flags[parameter.name] = _checked(path, parameter, settings[parameter.name], context)
    return flags


def _checked(path: str, parameter: click.Parameter, value: Any, context: click.Context) -> Any:
    """Check a stored value as if it were given on the command line, because files can be edited.

    Raises EclatError if the value is not valid.
    """
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
        raise EclatError(
            f"{where}: expected a value that its option accepts, got {json.dumps(value)[:60]} ({error})"
        ) from None


def _is_plain_list(value: Any) -> bool:
    """Return whether the value is a list of numbers and texts, or a list of such lists, as for repeatable options."""
    if not isinstance(value, list):
        return False
    items = [item for part in value for item in (part if isinstance(part, list) else [part])]
    return all(isinstance(item, str | int | float) for item in items)


def say_replay_of_bad_samples(reporter: Reporter, image: Image, scene: str, outputs: Sequence[str]) -> None:
    """If samples were not finite, print the command that repeats the first of them with the settings of the picture."""
    files = [name for name in outputs if Path(name).suffix.lower() in _WITH_SETTINGS]
    bad = image.metadata.get("bad_samples")
    if bad and files:
        place = ",".join(map(str, bad["first"]))
        words = ("eclat", "render", scene, "--replay-settings", files[0], "--replay", place)
        reporter.warn(f"to repeat the first of these samples, run: {shlex.join(words)}")


def say_replayed_sample(reporter: Reporter, image: Image, replay: tuple[int, int, int]) -> None:
    """Print the value of the pixel whose sample was repeated."""
    x, y, sample = replay
    value = [float(channel) for channel in image.pixels[y, x]]
    # The value of the pixel is the mean of the finite samples.
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
