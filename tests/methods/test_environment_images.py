# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A small sun in a sky image is direct light in every method: irradiance in closed form, shadows where they belong."""

from __future__ import annotations

import math

import numpy as np
import pytest

import eclat
from eclat.measure.metrics import relative_rmse
from eclat.scene import Camera, Environment, Material, Mesh, Scene, look_at, rgb
from eclat.scenes.geometry import box
from support.quick_methods import QUICK

HEIGHT, WIDTH = 128, 256
SKY, SUN = 0.3, 5000.0


def sky_with_suns(*places: tuple[int, int]) -> np.ndarray:
    """An even sky with suns of 2 × 2 texels at (row, column)."""
    image = np.full((HEIGHT, WIDTH, 3), SKY, np.float32)
    for row, column in places:
        image[row : row + 2, column : column + 2] = SUN
    return image


def irradiance_from_above(image: np.ndarray) -> float:
    """∫ L cos θ over the upper hemisphere, texel by texel; the interpolation between texels moves light by less than one."""
    theta = np.arange(HEIGHT + 1) * math.pi / HEIGHT
    # ∫ cos θ sin θ dθ over each row, times its texels' 2π / width.
    rows = np.where(theta[1:] <= math.pi / 2 + 1e-9, (np.sin(theta[1:]) ** 2 - np.sin(theta[:-1]) ** 2) / 2, 0)
    return float((image[..., 0] * rows[:, None]).sum() * 2 * math.pi / WIDTH)


def floor(size: float = 20.0) -> Mesh:
    corners = np.array([(-size, 0, size), (size, 0, size), (size, 0, -size), (-size, 0, -size)])
    grey = Material("diffuse", {"reflectance": rgb(0.5, 0.5, 0.5)}, two_sided=False)
    return Mesh(corners, np.array([(0, 1, 2), (0, 2, 3)]), grey)


SKIES = {
    "a sun": sky_with_suns((30, 150)),
    "a sun at the zenith": sky_with_suns((0, 0)),
    "a low sun": sky_with_suns((56, 255 - 2)),
    "three suns": sky_with_suns((10, 20), (40, 200), (50, 60)),
    "no sun": sky_with_suns(),
}


@pytest.mark.parametrize("method", list(QUICK))
@pytest.mark.parametrize("sky", list(SKIES))
def test_irradiance_of_open_ground(sky: str, method: str) -> None:
    scene = Scene(meshes=(floor(),), environment=Environment(SKIES[sky]))
    places = np.random.default_rng(1).uniform(-8, 8, (6, 3)) * (1, 0, 1)
    found = eclat.irradiance(scene, places, np.tile((0, 1, 0), (6, 1)), QUICK[method], samples=256)
    np.testing.assert_allclose(found[:, 0], irradiance_from_above(SKIES[sky]), rtol=0.04)


def test_a_light_map_of_open_ground_holds_the_sun() -> None:
    scene = Scene(meshes=(floor(),), environment=Environment(SKIES["a sun"]))
    texels = eclat.bake(scene, texel_size=2.0, samples=64, charts_timeout=0).irradiance[..., 0]
    np.testing.assert_allclose(texels[texels > 0], irradiance_from_above(SKIES["a sun"]), rtol=0.04)


@pytest.mark.parametrize("turn", [0.0, 1.0, 2.5])
def test_a_rotated_environment_image_gives_the_same_sky(turn: float) -> None:
    # About x, so that the sun leaves its row of texels.
    c, s = math.cos(turn / 5), math.sin(turn / 5)
    matrix = np.array([(1, 0, 0), (0, c, -s), (0, s, c)])
    scene = Scene(meshes=(floor(),), environment=Environment(SKIES["a sun"], matrix))
    place, up = np.zeros((1, 3)), np.array([(0, 1.0, 0)])
    found, wanted = (
        eclat.irradiance(scene, place, up, method, samples=4096) for method in (QUICK["irradiance-cache"], eclat.Path())
    )
    np.testing.assert_allclose(found, wanted, rtol=0.04)


def block_in_the_sun() -> Scene:
    block = box((-0.5, -0.01, -0.5), (0.5, 1.0, 0.5))
    red = Material("diffuse", {"reflectance": rgb(0.8, 0.3, 0.2)}, two_sided=False)
    camera = Camera(look_at((3, 3, 4), (0, 0.3, 0)), fov=50, size=(48, 48))
    mesh = Mesh(block.positions, block.triangles, red)
    return Scene(meshes=(floor(), mesh), environment=Environment(SKIES["a sun"]), cameras=(camera,))


@pytest.mark.parametrize("method", [name for name in QUICK if name not in ("direct", "path")])
def test_a_block_in_the_sun_casts_one_sharp_shadow(method: str) -> None:
    scene = block_in_the_sun()
    a, b = (eclat.render(scene, eclat.Path(), samples=256, seed=seed).pixels for seed in (1, 2))
    picture = eclat.render(scene, QUICK[method], samples=32, seed=3)
    error = relative_rmse(picture.pixels, a, b)
    assert error < 0.12  # the photon map's blur; paths that leave the sun to chance err by 300 %
    if "estimated_error" in picture.metadata["statistics"]:
        assert error < 0.05
        assert error < 2 * picture.metadata["statistics"]["estimated_error_high"]


def test_sunlit_surfaces_receive_direct_light() -> None:
    scene = block_in_the_sun()
    direct = eclat.render(scene, QUICK["irradiance-cache"], samples=32).layers["direct"]
    wanted = eclat.render(scene, eclat.Direct(), samples=32).pixels
    # What the even sky brings to open ground, ρ L, is indirect light here: records answer for it.
    sun_alone = wanted[..., 0] - 0.5 * SKY
    lit = sun_alone > 0.5
    assert lit.mean() > 0.5
    assert np.median(direct[..., 0][lit] / sun_alone[lit]) == pytest.approx(1, abs=0.05)
