# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Commands and calls as they are written, but with small pictures, few samples and coarse records: what the tests of
documentation run. `python -m support.small_work render room.glb` stands for `eclat render room.glb`.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from typing import Any

import pytest

import eclat

SIZE = (32, 24)
MOST = {"--samples": 4.0, "--reference-samples": 4.0, "--levels": 1.0, "--time": 3.0}
LEAST = {"--max-error": 0.2, "--texel-size": 0.25}
ADDED = {
    "render": ["--size", "32x24"],
    "animate": ["--size", "32x24", "--samples", "2", "--method", "path"],
    "solve": ["--size", "32x24", "--max-error", "0.2"],
    "irradiance": ["--max-error", "0.2"],
    "bake": ["--texel-size", "0.25", "--max-error", "0.2"],
    "compare": [
        "--size",
        "24x16",
        "--levels",
        "1",
        "--samples",
        "2",
        "--reference-samples",
        "4",
        "--methods",
        "path,direct",
    ],
}
"""Options that a command gets if they are not given."""

SETTINGS_STAY = ("--continue", "--replay-settings", "--replay")
"""Options with which a command takes all settings from a file."""


def smaller(arguments: list[str]) -> list[str]:
    """Return the arguments of a command with less work."""
    out = list(arguments)
    for i in range(len(out) - 1):
        name, value = out[i], out[i + 1]
        if name in MOST and is_number(value):
            out[i + 1] = f"{min(float(value), MOST[name]):g}"
        if name in LEAST and is_number(value):
            out[i + 1] = f"{max(float(value), LEAST[name]):g}"
        if name == "--frames":
            first = int(value.split(":")[0])
            out[i + 1] = f"{first}:{first + 1}"
        if name == "--size":
            out[i + 1] = f"{SIZE[0]}x{SIZE[1]}"
    if out and not any(name in out for name in SETTINGS_STAY) and "--help" not in out:
        added = ADDED.get(out[0], [])
        if out[0] == "render" and "--time" not in out:
            added = [*added, "--samples", "4", "--max-error", "0.2"]
        for name, value in zip(added[::2], added[1::2], strict=True):
            if name not in out and not (name == "--max-error" and "--cache" in out):
                out += [name, value]
    return out


def is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def make_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the functions of `eclat` do less work than they are asked for."""
    for name, added in {
        "render": {"size": SIZE, "samples": 4},
        "solve": {"size": SIZE},
        "bake": {"texel_size": 0.25, "max_error": 0.2},
        "irradiance": {"max_error": 0.2, "samples": 16},
    }.items():
        monkeypatch.setattr(eclat, name, with_less(getattr(eclat, name), added), raising=False)
    for method in (eclat.IrradianceCache, eclat.RadianceCache):
        monkeypatch.setattr(eclat, method.__name__, functools.partial(coarse, method), raising=False)


def coarse(method: type[Any], **options: Any) -> Any:
    """Make a method with coarse records."""
    return method(**{**options, "max_error": max(0.2, options.get("max_error", 0.2))})


def with_less(function: Callable[..., Any], added: dict[str, Any]) -> Callable[..., Any]:
    """Replace what determines the amount of work, where it is larger than what is added."""

    @functools.wraps(function)
    def call(*arguments: Any, **keywords: Any) -> Any:
        for name, value in added.items():
            if name == "samples" and ({"time", "continued"} & set(keywords) or "max_error" in keywords):
                continue
            if name == "size" and ({"continued", "points", "view_independent"} & set(keywords)):
                continue
            keywords[name] = value
        if "time" in keywords:
            keywords["time"] = min(3.0, keywords["time"])
        return function(*arguments, **keywords)

    return call


if __name__ == "__main__":
    from eclat.cli import main

    sys.exit(main(smaller(sys.argv[1:])))
