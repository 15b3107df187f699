# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The built-in scenes, made by code."""

from __future__ import annotations

import importlib
import inspect

from eclat.errors import EclatError, did_you_mean
from eclat.scene import Scene

NAMES: dict[str, str] = {
    "cornell-box": "a room with a red and a green wall, two boxes and one light; all diffuse",
    "glossy-box": "the same, with a floor and a tall box of rough metal",
    "furnace": "a closed room that glows and reflects everywhere alike: its radiance is known exactly",
    "two-rooms": "a lit and a dark room with a thin closed wall between them: a test for leaks",
    "door-ajar": "a furnished room lit only through a door left ajar",
    "atrium": "a courtyard with vaulted arcades, a gallery and open sky",
}
"""Name → what it shows."""


def build(name: str, **parameters: object) -> Scene:
    """Make the built-in scene `name`.

    Parameters
    ----------
    name
        One of `NAMES`.
    **parameters
        What that scene's own `build` function takes, e.g. `rho` of the furnace.

    Raises
    ------
    EclatError
        For an unknown scene or parameter, or a parameter's value out of range.
    """
    if name not in NAMES:
        raise EclatError(f"built-in scene: expected one of {', '.join(NAMES)}, got {name!r}{did_you_mean(name, NAMES)}")
    make = importlib.import_module(f"eclat.scenes.{name.replace('-', '_')}").build
    known = inspect.signature(make).parameters
    for key in parameters:
        if key not in known:
            expected = f"one of {', '.join(known)}" if known else "no parameters"
            raise EclatError(f"built-in scene {name}: expected {expected}, got {key!r}{did_you_mean(key, known)}")
    scene = make(**parameters)
    assert isinstance(scene, Scene)
    return scene
