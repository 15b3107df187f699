# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What is done with a damaged file of each format. Every function says what became of the file in a word, or raises:
EclatError is a refusal, all else is a finding."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import click
import numpy as np

import eclat
from eclat.brdf_table import brdf_table
from eclat.bridge.compiled import core_brdf
from eclat.cli.point_files import read_points
from eclat.cli.replay import replayed_flags
from eclat.loaders.files import read_texture
from eclat.methods.choosing import make_options
from eclat.scene import Scene
from eclat.scenes import build
from eclat.stage.defaults import complete
from support.mutations import check_mesh

Target = Callable[[Path, Random], str]

RENDERED = 0.1
"""The share of files that load of which a picture is made: it takes as long as ten loads."""

PICTURE: dict[str, Any] = {"size": (6, 5), "samples": 1, "max_depth": 4, "threads": 1, "check": False}
METHODS: tuple[Any, ...] = (
    # Those that solve take a hundred times as long as paths, and read the same scene.
    *[eclat.Path()] * 14,
    *[eclat.Direct()] * 4,
    eclat.PhotonMap(photons=1000, caustic_photons=1000),
    eclat.Radiosity(patches=100),
)


class NotFiniteError(Exception):
    """A scene that loads gives samples that are not finite."""


def try_scene(path: Path, random: Random) -> str:
    """Load a scene file; of some, check the meshes, and make a picture or ask for the light at a point."""
    return _try_loaded(eclat.load(path), random)


def try_dict(path: Path, random: Random) -> str:
    """The scene in a dict, which may hold values that JSON has not."""
    description = json.loads(path.read_text(encoding="utf-8", errors="surrogateescape"))
    if isinstance(description, dict):
        _with_foreign_values(description, random)
    return _try_loaded(eclat.load_dict(description, path.parent), random)


def _with_foreign_values(tree: dict[str, Any], random: Random) -> None:
    if random.random() < 0.5:
        key = random.choice(list(tree) or ["type"])
        values: tuple[Any, ...] = (
            *(np.eye(4), np.float32("nan"), np.zeros((3, 3)), np.zeros(0), b"bytes", {1: 2}, Path("a"), 1j),
            *(float("inf"), np.array(["x"]), object(), (1, 2, 3), np.array([1, 2], dtype=object)),
        )
        tree[key] = random.choice(values)


def _try_loaded(scene: Scene, random: Random) -> str:
    if scene.animation is not None:
        scene = scene.at(random.uniform(scene.animation.start - 1, scene.animation.end + 1))
    for mesh in scene.meshes:
        check_mesh(mesh)
    repr(scene)
    if random.random() >= RENDERED:
        return "loaded"
    if random.random() < 0.1:
        eclat.irradiance(scene, np.zeros((1, 3)), np.eye(3)[:1], "path", samples=2, threads=1)
        return "rendered"
    _picture(scene, random.choice(METHODS))
    return "rendered"


def _picture(scene: Scene, what: Any, **arguments: Any) -> None:
    image = eclat.render(scene, what, **{**PICTURE, **arguments})
    if "bad_samples" in image.metadata:
        raise NotFiniteError(f"{image.metadata['bad_samples']} of {getattr(what, 'name', what)}")


def try_image(path: Path, random: Random) -> str:
    """An image as a texture, as an environment, and as a picture of ours."""
    texture = read_texture(path, srgb=True, where="texture")
    assert np.isfinite(texture.image).all() and texture.image.ndim == 3
    refusals: list[str] = []
    attempts: list[Callable[[], Any]] = [lambda: complete(_small_scene(), environment=path)]
    if path.suffix in (".exr", ".pfm", ".npy"):
        attempts.append(lambda: eclat.Image.load(path))
    for attempt in attempts:
        try:
            found = attempt()
        except eclat.EclatError as error:
            refusals.append(str(error))
            continue
        if isinstance(found, Scene) and random.random() < RENDERED:
            _picture(found, eclat.Path())
            return "rendered"
    if len(refusals) == len(attempts):
        raise eclat.EclatError(refusals[0])
    return "loaded"


_scenes: dict[str, Scene] = {}


def _small_scene() -> Scene:
    """The same one each time, so that it is compiled once."""
    if "box" not in _scenes:
        _scenes["box"] = build("cornell-box")
    return _scenes["box"]


def try_points(path: Path, random: Random) -> str:
    """A file of points; of some, the light there."""
    points, normals = read_points(str(path))
    if random.random() >= RENDERED:
        return "loaded"
    found = eclat.irradiance(_small_scene(), points[:4], normals[:4], "path", samples=2, threads=1)
    if not np.isfinite(found).all():
        raise NotFiniteError(f"irradiance of {points[:4].tolist()}")
    return "rendered"


def try_solved(path: Path, random: Random) -> str:
    """A saved solution; of some, a picture."""
    solved = eclat.load_solved(path)
    if random.random() >= RENDERED:
        return "loaded"
    _picture(_small_scene(), solved, max_depth=-1)
    return "rendered"


def try_brdf(path: Path, random: Random) -> str:
    """A measured BRDF: load it, and look at it from some directions."""
    core = core_brdf(eclat.load_brdf(path))
    rng = np.random.default_rng(random.randrange(1 << 32))
    wo, wi = rng.normal(size=(2, 20, 3)).astype(np.float32)
    wo, wi = (w / np.linalg.norm(w, axis=1, keepdims=True) for w in (wo, wi))
    values, densities = core.eval(np.ascontiguousarray(wo), np.ascontiguousarray(wi))
    found = core.directions(np.ascontiguousarray(wo), rng.random((20, 2), np.float32))
    if not all(np.isfinite(array).all() for array in (values, densities, found)):
        raise NotFiniteError("values of a measured BRDF")
    return "loaded"


def try_brdf_cache(path: Path, random: Random) -> str:
    """A table in the cache folder: read, or computed anew with a warning."""
    os.environ["XDG_CACHE_HOME"] = str(path.parent.parent)
    table = brdf_table("lambert", order=2, threads=1)
    if not np.isfinite(table.lookup([[0.0, 0.0, 1.0]]).coefficients).all():
        raise NotFiniteError("coefficients of a table")
    return "loaded"


def try_settings(path: Path, random: Random) -> str:
    """The flags of a run from its picture."""
    from eclat.cli.render import command

    with click.Context(command) as context:
        replayed_flags(str(path), context)
    return "loaded"


def try_options(path: Path, random: Random) -> str:
    """Options of methods."""
    methods = json.loads(path.read_text(encoding="utf-8", errors="surrogateescape"))
    if not isinstance(methods, dict):
        return "loaded"
    refused: eclat.EclatError | None = None
    for name, options in methods.items():
        try:
            if isinstance(options, dict):
                make_options(name, **options)
        except eclat.EclatError as error:
            refused = error
    if refused is not None:
        raise refused
    return "loaded"


TARGETS: dict[str, Target] = {
    **dict.fromkeys(("gltf", "obj", "ply", "usd", "mitsuba", "serialized"), try_scene),
    "dict": try_dict,
    "image": try_image,
    "points": try_points,
    "solved": try_solved,
    "brdf": try_brdf,
    "brdf-cache": try_brdf_cache,
    "settings": try_settings,
    "options": try_options,
}
"""By format, as in `corpus`."""

SHARES: dict[str, int] = {
    **{"gltf": 5, "obj": 3, "ply": 3, "mitsuba": 4, "serialized": 1, "dict": 2, "image": 5, "points": 1, "solved": 3},
    **{"brdf": 1, "brdf-cache": 1, "settings": 1, "options": 1, "usd": 2},
}
"""How many of thirty inputs a format gets."""
