# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Baked files as three.js shows them, in headless Chromium, beside what they ought to show: closed forms and paths."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import eclat
from eclat import scenes
from eclat.measure.metrics import away_from_edges, relative_rmse
from eclat.scene import Camera, Environment, Material, Scene, look_at, rgb
from eclat.scenes.geometry import icosphere, mesh
from support.browser import View, gltf_issues, render_in_three
from support.mirrored_room import save_mirrored_room

SIZE = (80, 80)
SAMPLES = 256
"""Paths a pixel of each of two references, so that their noise cancels from the error."""

VERSIONS = {"exr": 0.02, "embedded": 0.04}
"""Where irradiance is read from, and the relative RMSE that is allowed."""

WALL_TEXEL = 0.1
"""Metres; ten times what the wall between the two rooms is thick."""

BALL = (0.8, 0.5, 0.25)
SKY = 1.5


def ball_in_the_sky() -> Scene:
    """Convex and alone under a sky of one radiance: irradiance is π · SKY everywhere, without noise."""
    sky = Environment(np.full((1, 1, 3), SKY, dtype=np.float32))
    camera = Camera(look_at((0.7, 0.9, 2.4), (0, 0, 0)), fov=55, name="camera")
    ball = mesh([icosphere(2)], Material("diffuse", {"reflectance": rgb(*BALL)}, name="ball"), "ball")
    return Scene(meshes=(ball,), environment=sky, cameras=(camera,), name="ball")


@dataclass(frozen=True)
class Baked:
    """Files, and how three.js shows them."""

    scenes: dict[str, Scene]
    files: dict[str, Path]
    views: dict[tuple[str, str], View]
    """By scene and version."""
    said: list[str]


@pytest.fixture(scope="module")
def baked(tmp_path_factory: pytest.TempPathFactory) -> Baked:
    """All files of this module, shown in one browser."""
    folder = tmp_path_factory.mktemp("baked")
    baking: dict[str, tuple[Scene, dict[str, Any]]] = {
        "cornell-box": (scenes.build("cornell-box"), {"texel_size": 0.05, "max_error": 0.02}),
        # All charts of the box do not fit on one page of this size.
        "cornell-box-on-pages": (
            scenes.build("cornell-box"),
            {"texel_size": 0.05, "max_error": 0.02, "max_size": 64},
        ),
        "mirrored-room": (eclat.load(save_mirrored_room(folder)), {"texel_size": 0.06, "max_error": 0.03}),
        "two-rooms": (scenes.build("two-rooms"), {"texel_size": WALL_TEXEL, "max_error": 0.1}),
        "ball": (ball_in_the_sky(), {"texel_size": 0.05, "max_error": 0.1}),
    }
    files = {}
    for name, (scene, options) in baking.items():
        files[name] = folder / f"{name} lit.glb"
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="glTF has no environments")
            eclat.bake(scene, samples=64, **options).save(files[name])
    # The second camera of the two rooms looks at the dark side of their wall.
    wanted = {
        (name, version): {
            "file": files[name].name,
            "camera": len(scene.cameras) - 1,
            "width": SIZE[0],
            "height": SIZE[1],
            "supersampling": 4,
            "plugin": {"exr": version == "exr"},
        }
        for name, (scene, _) in baking.items()
        for version in VERSIONS
    }
    made, said = render_in_three(folder, list(wanted.values()))
    views = {}
    for key, view in zip(wanted, made, strict=True):
        assert isinstance(view, View), view
        views[key] = view
    return Baked({name: scene for name, (scene, _) in baking.items()}, files, views, said)


def test_the_validator_finds_nothing_wrong(baked: Baked) -> None:
    issues = gltf_issues(*baked.files.values())
    assert issues["errors"] == issues["warnings"] == []


def test_the_browser_reports_no_errors(baked: Baked) -> None:
    assert baked.said == []
    for (_, version), view in baked.views.items():
        kinds = {light_map["type"] for light_map in view.light_maps.values()}
        assert kinds == {"HalfFloatType" if version == "exr" else "UnsignedByteType"}


@pytest.mark.parametrize("name", ["cornell-box", "cornell-box-on-pages", "mirrored-room"])
def test_diffuse_surfaces_look_as_paths_say(baked: Baked, name: str) -> None:
    # Mirrored and stretched instances, two sets of texture coordinates, vertex colours, both sides of a sheet.
    a, b = (
        eclat.render(baked.scenes[name], eclat.Path(), size=SIZE, samples=SAMPLES, seed=seed, camera=0)
        for seed in (1, 2)
    )
    # three.js draws edges of objects as sharp as its samples, paths as smooth as theirs.
    inside = away_from_edges(a.layers["depth"], a.layers["normal"])
    for version, allowed in VERSIONS.items():
        error = relative_rmse(baked.views[name, version].pixels, a.pixels, b.pixels, mask=inside)
        assert error < allowed, f"{name}, {version}: {error:.4f}"


@pytest.mark.parametrize("version", VERSIONS)
def test_no_seam_shows_where_irradiance_is_the_same_everywhere(baked: Baked, version: str) -> None:
    # A texel from beyond a chart would be black, one of another pixel's chart would do no harm here; see above for that.
    pixels = baked.views["ball", version].pixels
    shown = pixels[..., 0] > 0
    rim = shown & ~_eroded(shown)
    assert shown.sum() > 800
    radiance = SKY * np.array(BALL)
    # Half floats, or a byte for the square root, roughly, of irradiance.
    tolerance = 0.002 if version == "exr" else 0.01
    np.testing.assert_allclose(
        pixels[shown & ~rim], np.broadcast_to(radiance, (int((shown & ~rim).sum()), 3)), rtol=tolerance
    )


@pytest.mark.parametrize("version", VERSIONS)
def test_no_light_comes_through_a_wall_of_a_centimetre(baked: Baked, version: str) -> None:
    scene = baked.scenes["two-rooms"]
    seen = eclat.render(scene, eclat.Direct(), size=SIZE, samples=1, camera=1)
    # Floor and ceiling reach below the wall into the lit room: there a texel has both sides.
    beyond = _positions(scene.cameras[1], seen.layers["depth"])[..., 0] > 2 * WALL_TEXEL
    wall = away_from_edges(seen.layers["depth"], seen.layers["normal"]) & (seen.layers["normal"][..., 0] > 0.99)
    assert min(beyond.mean(), wall.mean()) > 0.1
    leak = baked.views["two-rooms", version].pixels[beyond | wall].max()
    # The lit side of the wall is at about 1 W/(m² sr). Fitting texels for what is read between them lets a trace through.
    assert leak < 1e-4, f"up to {leak}"


def _positions(camera: Camera, depth: NDArray[np.float32]) -> NDArray[np.float64]:
    """(H, W, 3) what the pixels see, in world space."""
    height, width = depth.shape
    half_width, half_height = camera.half_extent(width / height)
    x = half_width * (2 * (np.arange(width) + 0.5) / width - 1)
    y = half_height * (1 - 2 * (np.arange(height) + 0.5) / height)
    rays = np.stack([*np.meshgrid(x, y), np.full(depth.shape, -1.0)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    return camera.to_world[:3, 3] + (depth[..., None] * rays) @ camera.to_world[:3, :3].T


def _eroded(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """True where all eight neighbours are too."""
    padded = np.pad(mask, 1)
    height, width = mask.shape
    return np.all([padded[y : y + height, x : x + width] for y in range(3) for x in range(3)], axis=0)
