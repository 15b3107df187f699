# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The scene and the flags that change it before it is rendered, shared by the commands."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import eclat
from eclat.cli.command import F, option
from eclat.cli.parameters import ENVIRONMENT, POINT, SIZE, SUN, Depth, Number
from eclat.errors import EclatError, did_you_mean

if TYPE_CHECKING:
    from eclat.scene import Scene

CAMERA, LIGHT, WORK = "Camera", "Light", "Work"

SEED = Number(int, 0, 2**32 - 1)
THREADS = Number(int, 1, 1024)
SAMPLES = Number(int, 1, 2**24)
MAX_DEPTH = Depth(int, -1, 10**6)
MAX_ERROR = Number(float, 0.0005, 0.5)


def light_options(function: F) -> F:
    """Flags that replace the scene's sun and surroundings."""
    for decorate in (
        option("--environment", type=ENVIRONMENT, section=LIGHT, help="Light from all around, instead of the scene's."),
        option(
            "--sun", type=SUN, section=LIGHT, help="Sun and sky instead of the scene's; degrees, azimuth from north."
        ),
    ):
        function = decorate(function)
    return function


def camera_options(function: F) -> F:
    """Flags that choose or replace the camera."""
    for decorate in (
        option("--size", type=SIZE, section=CAMERA, help="Width and height in pixels [the scene's, else 1280x720]."),
        option(
            "--fov", type=Number(float, 0, 179.9, above=True), section=CAMERA, help="Vertical field of view, degrees."
        ),
        option("--camera-up", type=POINT, section=CAMERA, help="What is up in the picture [the scene's up]."),
        option("--camera-to", type=POINT, section=CAMERA, help="Look at this point [the scene's middle]."),
        option("--camera-from", type=POINT, section=CAMERA, help="Look from this point."),
        option(
            "--camera",
            metavar="N|NAME",
            section=CAMERA,
            help="One of the scene's cameras [0]; `eclat info` lists them.",
        ),
    ):
        function = decorate(function)
    return function


def work_options(function: F) -> F:
    """Seed and threads."""
    for decorate in (
        option("--threads", type=THREADS, section=WORK, help="Threads [all processors]; the picture is the same."),
        option("--seed", type=SEED, default=0, section=WORK, help="Another seed, other noise."),
    ):
        function = decorate(function)
    return function


def scene_argument(function: F) -> F:
    """The one positional argument."""
    return click.argument("scene", metavar="SCENE")(function)


def scene_stem(name: str) -> str:
    """What files made from this scene are called."""
    return Path(name).stem or "scene"


def load_scene(flags: Mapping[str, Any]) -> Scene:
    """The scene that the flags ask for, with a camera and light in any case. Raises EclatError."""
    from eclat.defaults import complete

    names = ("camera_from", "camera_to", "camera_up", "fov", "sun", "environment", "size")
    return complete(eclat.load(flags["scene"]), **{name: flags[name] for name in names if flags.get(name) is not None})


def camera_index(scene: Scene, wanted: str | None) -> int:
    """The number of the camera called `wanted`, which is its number or its name. Raises EclatError."""
    if wanted is None:
        return 0
    names = [camera.name for camera in scene.cameras]
    if wanted in names:
        return names.index(wanted)
    if wanted.isdecimal() and int(wanted) < len(names):
        return int(wanted)
    listed = ", ".join(f"{i} {name!r}" if name else str(i) for i, name in enumerate(names))
    raise EclatError(f"--camera: expected one of {listed}, got {wanted!r}{did_you_mean(wanted, filter(None, names))}")
