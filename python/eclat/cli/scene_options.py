# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The argument SCENE and the options that change the scene before it is rendered, which several commands share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import click
from click.shell_completion import CompletionItem

import eclat
from eclat.cli.build_facts import isa_option
from eclat.cli.command import F, option, together
from eclat.cli.parameters import ENVIRONMENT, POINT, SIZE, SUN, Number
from eclat.errors import EclatError, did_you_mean

if TYPE_CHECKING:
    from eclat.scene import Scene

T = TypeVar("T")

CAMERA, LIGHT, WORK, SURFACES = "Camera", "Light", "Work", "Surfaces"

material_option = option(
    "--material",
    "materials",
    metavar="NAME=KIND,…",
    multiple=True,
    section=SURFACES,
    help="Replace the material called NAME, or that of the mesh called NAME, by a Mitsuba bsdf with its properties, as "
    "in floor=roughplastic,distribution=ggx,alpha=0.2; repeatable. Properties that you do not give keep their values. "
    "`eclat info` lists the names.",
)
"""Adds the option `--material`."""

light_options = together(
    option(
        "--sun",
        type=SUN,
        section=LIGHT,
        help="Replace the scene's suns and environment by a sun and a sky; both angles are in degrees, the azimuth is "
        "measured from north.",
    ),
    option(
        "--environment",
        type=ENVIRONMENT,
        section=LIGHT,
        help="Replace the scene's environment by an image file or by a constant radiance R,G,B.",
    ),
    option(
        "--ies",
        metavar="LIGHT=FILE",
        multiple=True,
        section=LIGHT,
        help="Replace the point or spot light called LIGHT by a luminaire measured in this photometric file (IES LM-63), as in "
        "lamp=downlight.ies; repeatable.",
    ),
)
"""Adds the options that replace the scene's suns, environment and lamps."""

camera_options = together(
    option(
        "--camera",
        metavar="N|NAME",
        section=CAMERA,
        help="Use this camera of the scene, given by its number or its name; `eclat info` lists all cameras [0].",
    ),
    option("--camera-from", type=POINT, section=CAMERA, help="Place the camera at this position."),
    option(
        "--camera-to", type=POINT, section=CAMERA, help="Point the camera at this position [the middle of the scene]."
    ),
    option("--camera-up", type=POINT, section=CAMERA, help="Direction that points up in the picture [the scene's up]."),
    option(
        "--fov", type=Number(float, 0, 179.9, above=True), section=CAMERA, help="Vertical field of view in degrees."
    ),
    option("--size", type=SIZE, section=CAMERA, help="Width and height in pixels [the camera's, else 1280x720]."),
)
"""Adds the options that choose or replace the camera."""

work_options = together(
    option(
        "--seed",
        type=Number(int, 0, 2**32 - 1),
        default=0,
        section=WORK,
        help="Seed of the random numbers; another seed gives different noise [0].",
    ),
    option(
        "--threads",
        type=Number(int, 1, 1024),
        section=WORK,
        help="Number of threads; it does not change the result [all processors].",
    ),
    isa_option,
)
"""Adds the options `--seed`, `--threads` and `--isa`."""


def scene_argument(function: F) -> F:
    """Add the argument SCENE and the options `--root`, `--camera-path` and `--at`."""
    return moving_scene_argument(
        option(
            "--at",
            type=Number(float, -1e6, 1e6),
            metavar="SECONDS",
            section="Other",
            help="Take a scene that moves as it is at this time; `eclat info` tells its duration [its rest pose].",
        )(function)
    )


def moving_scene_argument(function: F) -> F:
    """Add the argument SCENE and the options `--root` and `--camera-path`."""
    function = option(
        "--camera-path",
        metavar="FILE",
        section="Other",
        help="Add a camera that follows the path in this JSON file; it becomes camera 0.",
    )(function)
    function = option(
        "--root",
        metavar="DIR",
        section="Other",
        help="Refuse every file that the scene reads, itself included, if it lies outside this folder [files may lie "
        "anywhere].",
    )(function)
    return click.argument("scene", metavar="SCENE", shell_complete=_complete_scene)(function)


def _complete_scene(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem[str]]:
    """Complete the names of built-in scenes, and files where no name begins so."""
    from eclat.scenes import NAMES

    named = [CompletionItem(name, help=text) for name, text in NAMES.items() if name.startswith(incomplete)]
    return [CompletionItem(incomplete, type="file"), *named]


def scene_stem(name: str) -> str:
    """Return the name, without a suffix, for files that are made from this scene."""
    return Path(name).stem or "scene"


def load_scene(flags: Mapping[str, Any]) -> Scene:
    """Load the scene with the changes that the flags ask for; if it has no camera or no light, add one.

    Raises EclatError if the scene cannot be loaded or a flag does not fit it.
    """
    return load_scene_to_show(flags)[0]


def load_scene_to_show(flags: Mapping[str, Any]) -> tuple[Scene, float | Literal["auto"]]:
    """Load the scene as `load_scene` does, and choose the exposure of its pictures.

    The exposure is that of the flags if they give one. Otherwise it is "auto" if light is in candela and lux, or comes from
    `--sun` or from a light that was added by default, and 0 if not.
    """
    from eclat.stage.defaults import complete, wants_exposure
    from eclat.stage.light_overrides import parsed_light_override
    from eclat.stage.material_overrides import parsed_override

    scene = load_file(flags)
    if flags["materials"]:
        scene = eclat.override_materials(scene, by_name("--material", flags["materials"], parsed_override))
    if flags.get("ies"):
        files = by_name("--ies", flags["ies"], parsed_light_override)
        try:
            scene = eclat.override_lights(scene, files)
        except EclatError as error:
            raise EclatError(f"--ies: {error}") from None
    exposure: float | Literal["auto"] | None = flags.get("exposure")
    if exposure is None:
        made_up = wants_exposure(scene, sun=flags.get("sun"), environment=flags.get("environment"))
        exposure = "auto" if made_up else 0.0
    names = ("camera_from", "camera_to", "camera_up", "fov", "sun", "environment", "size")
    scene = complete(scene, **{name: flags[name] for name in names if flags.get(name) is not None})
    return posed(scene, flags), exposure


def load_file(flags: Mapping[str, Any]) -> Scene:
    """Load the scene without changes, except for the camera of `--camera-path`."""
    scene = eclat.load(flags["scene"], root=flags["root"])
    return eclat.with_camera_path(scene, flags["camera_path"]) if flags.get("camera_path") else scene


def posed(scene: Scene, flags: Mapping[str, Any]) -> Scene:
    """Return the scene at the time of `--at`, if it is given. What was added by default stays where it is at rest."""
    if flags.get("at") is None:
        return scene
    if scene.animation is None:
        raise EclatError(f"--at: expected a scene that moves, but nothing moves in {flags['scene']}")
    return scene.at(flags["at"])


def by_name(flag: str, texts: Sequence[str], parsed: Callable[[str], tuple[str, T]]) -> dict[str, T]:
    """Parse the values NAME=… of a flag that may be repeated, each with another name."""
    values: dict[str, T] = {}
    for text in texts:
        try:
            name, value = parsed(text)
        except EclatError as error:
            raise EclatError(f"{flag}: {error}") from None
        if name in values:
            raise EclatError(f"{flag}: {name} is given twice, expected it once")
        values[name] = value
    return values


def camera_index(scene: Scene, wanted: str | None) -> int:
    """Return the index of the camera that `wanted` names by its index or its name; None means 0.

    Raises EclatError if the scene has no such camera.
    """
    if wanted is None:
        return 0
    names = [camera.name for camera in scene.cameras]
    if wanted in names:
        return names.index(wanted)
    if wanted.isdecimal() and int(wanted) < len(names):
        return int(wanted)
    listed = ", ".join(f"{i} {name!r}" if name else str(i) for i, name in enumerate(names))
    raise EclatError(f"--camera: expected one of {listed}, got {wanted!r}{did_you_mean(wanted, filter(None, names))}")
