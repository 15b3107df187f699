# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Surfaces, points and probes almost on lamps of 100 m and of 1 m, against Lambert's formula: 1.88 to 2.10 was found for π at a
millimetre from a glowing triangle of 100 m, because rays missed the directions near its middle and lamps shadowed themselves."""

from __future__ import annotations

import math

import numpy as np
import pytest

import eclat
from eclat.methods import Method
from eclat.scene import Camera, FloatArray, Material, Mesh, Scene, grey, look_at

GLOW = Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(1.0))
SHAPES = {
    "triangle": np.array([(-0.5, 0, -0.5), (1, 0, -0.5), (-0.5, 0, 1)]),
    "quad": np.array([(-0.5, 0, -0.5), (0.5, 0, -0.5), (0.5, 0, 0.5), (-0.5, 0, 0.5)]),
    "sliver": np.array([(-0.5, 0, -1e-3), (0.5, 0, -1e-3), (0.5, 0, 1e-3), (-0.5, 0, 1e-3)]),
}
"""Lamps of a size of one, which face down at a height of 0."""
METHODS: dict[str, Method] = {
    "path": eclat.Path(),
    "irradiance-cache": eclat.IrradianceCache(max_error=0.1),
    "photon-map": eclat.PhotonMap(photons=2000, caustic_photons=1000),
    "radiosity": eclat.Radiosity(patches=200),
}

pytestmark = pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")


def lamp(corners: FloatArray) -> Mesh:
    triangles = [(0, i, i + 1) for i in range(1, len(corners) - 1)]
    return Mesh(np.asarray(corners, float), np.array(triangles), GLOW)


def lambert(corners: FloatArray, at: FloatArray, normal: FloatArray) -> float:
    """Irradiance of a polygon of unit radiance, all of which lies above the horizon of `normal`, by Lambert's formula."""
    rays = np.asarray(corners, float) - at
    total = 0.0
    for a, b in zip(rays, np.roll(rays, -1, axis=0), strict=True):
        across = np.cross(a, b)
        length = float(np.linalg.norm(across))
        total += float(across @ normal) / length * math.atan2(length, float(a @ b))
    return abs(total) / 2


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("size", [1.0, 100.0])
@pytest.mark.parametrize("method", METHODS)
def test_points_under_a_lamp(method: str, size: float, shape: str) -> None:
    """From a hundred-thousandth of its size on, under the middle and, facing it, beside it."""
    corners = size * SHAPES[shape]
    heights = size * np.array([1e-5, 1e-4, 1e-3, 1e-2, 1.0, 100.0])
    under = np.array([(0.01 * size, -h, 2e-4 * size) for h in heights])
    beside = np.array([(-0.6 * size, -h, 0) for h in heights[1:4]])
    points = np.concatenate((under, beside))
    normals = np.concatenate((np.tile((0.0, 1.0, 0.0), (len(under), 1)), np.tile((1.0, 0.0, 0.0), (len(beside), 1))))
    found = eclat.irradiance(Scene((lamp(corners),)), points, normals, METHODS[method], samples=2048)[:, 1]
    expected = [lambert(corners, p, n) for p, n in zip(points, normals, strict=True)]
    np.testing.assert_allclose(found, expected, rtol=0.03)
    assert float((found / expected).mean()) == pytest.approx(1, rel=0.01)


@pytest.mark.parametrize("method", METHODS)
def test_a_picture_of_a_gap_of_a_millimetre(method: str) -> None:
    """A floor of albedo ½ below a black lamp of 100 m shines with ½ of the lamp's radiance."""
    floor = 100 * SHAPES["quad"][::-1] - (0, 1e-3, 0)
    half = Mesh(floor, np.array([(0, 1, 2), (0, 2, 3)]), Material("diffuse", {"reflectance": grey(0.5)}))
    camera = Camera(look_at((0, -5e-4, 0), (1e-3, -1e-3, 2e-4), (0, 1, 0)), fov=20.0)
    scene = Scene((lamp(100 * SHAPES["quad"]), half), cameras=(camera,))
    pixels = eclat.render(scene, METHODS[method], size=(8, 8), samples=64, check=False).pixels
    assert float(np.mean(pixels)) == pytest.approx(0.5, rel=0.02)


def test_a_probe_under_a_lamp() -> None:
    """Half of all directions shine: c₀₀ = 2π Y₀₀."""
    r = 1e-4
    bounds = (-r, -1e-3 - r, -r, r, -1e-3 + r, r)
    scene = Scene((lamp(100 * SHAPES["quad"]),))
    found = eclat.probes(scene, eclat.Path(), grid=(1, 1, 1), bounds=bounds, samples=4096).coefficients[0, 0, 0]
    assert found[0] == pytest.approx(np.full(3, 2 * math.pi / math.sqrt(4 * math.pi)), rel=0.02)
