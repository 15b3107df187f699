# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Closed lampshades: an integrating sphere that lets light out. Inside, a power Φ makes the mean irradiance Φ / (A (1 − ρ)), the
sum over all bounces; outside, each of its points shines with τ / π of what arrives within."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat.methods import Method
from eclat.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
    grey,
    look_at,
)

HALF_OPEN: dict[str, Method] = {
    "path": eclat.Path(),
    "irradiance-cache": eclat.IrradianceCache(max_error=0.03),
    "radiance-cache": eclat.RadianceCache(max_error=0.03),
    "photon-map": eclat.PhotonMap(photons=10_000, caustic_photons=1000),
    "photons alone": eclat.PhotonMap(photons=10_000, caustic_photons=1000, gather=0),
    "radiosity": eclat.Radiosity(patches=200),
    "patches": eclat.Radiosity(patches=200, gather=0),
}
METHODS: dict[str, Method] = {
    "path": eclat.Path(),
    "irradiance-cache": eclat.IrradianceCache(max_error=0.03),
    "patches": eclat.Radiosity(patches=200, gather=0),
}
REFLECTED, PASSED = 0.5, 0.3
INTENSITY = 4.0
SHADE = Material("translucent", {"reflectance": grey(REFLECTED), "transmittance": grey(PASSED)})
WHITE = Material("diffuse", {"reflectance": grey(1.0)})
SKY = Environment(np.ones((1, 1, 3), np.float32))

pytestmark = pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")


def ball(radius: float, material: Material, bands: int = 16) -> Mesh:
    """A ball of the same area, and about the same shape, as a sphere of that radius."""
    polar, turn = np.meshgrid(
        np.linspace(0, math.pi, bands + 1), np.linspace(0, 2 * math.pi, 2 * bands + 1), indexing="ij"
    )
    points = np.stack((np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)), axis=-1)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    corners = np.concatenate([np.stack(t, axis=-2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))])
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    corners, area = corners[area > 1e-9], area[area > 1e-9]
    grown = corners.reshape(-1, 3) * radius * math.sqrt(4 * math.pi / area.sum())
    return Mesh(grown, np.arange(len(grown)).reshape(-1, 3), material)


def lamp(radius: float) -> Mesh:
    """A white ball, which takes no light, that sends the power of the point light."""
    glow = INTENSITY / (math.pi * radius**2)
    return ball(radius, replace(WHITE, emission=grey(glow)), 8)


BULB = ball(0.3, Material("thin_dielectric"), 8)
ONE = (INTENSITY,) * 3
WITHIN = 4 * math.pi * INTENSITY
"""Power of the lamps, W."""
CONE = 2 * math.pi * INTENSITY * (1 - math.cos(math.radians(45)))
"""Power of the spot, W."""
AREA = 4 * math.pi


def around(power: float) -> float:
    """Radiance outside of a shade of radius 1 within which lamps send that power."""
    return PASSED / math.pi * power / (AREA * (1 - REFLECTED))


Parts = tuple[tuple[Mesh, ...], tuple[PointLight | DirectionalLight | SpotLight, ...], Environment | None, float]
LAMPS: dict[str, Parts] = {
    "point": ((), (PointLight((0.0, 0.0, 0.0), ONE),), None, around(WITHIN)),
    "lamp": ((lamp(0.15),), (), None, around(WITHIN)),
    # A pane that takes nothing changes no sum of all bounces.
    "lamp-in-a-bulb": ((lamp(0.15), BULB), (), None, around(WITHIN)),
    # It shines away from the camera, where all light is reflected at least once.
    "spot": ((), (SpotLight((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), ONE, 45.0, 45.0),), None, around(REFLECTED * CONE)),
    # From behind and without: its cross-section takes it, lets it in, and lets it out again.
    "sun": ((), (DirectionalLight((0.0, 0.0, 1.0), ONE),), None, around(PASSED * INTENSITY * math.pi)),
    "sky": ((), (), SKY, REFLECTED + around(PASSED * math.pi * AREA)),
}
SHADES = {
    "translucent": SHADE,
    "blend": Material(
        "blend",
        {"weight": grey(0.5)},
        children=(
            Material("translucent", {"reflectance": grey(0.2), "transmittance": grey(0.6)}),
            Material("diffuse", {"reflectance": grey(0.8)}),
        ),
    ),
}


def seen(shade: Material, parts: Parts, method: Method) -> np.ndarray:
    meshes, lights, environment, _ = parts
    camera = Camera(look_at((0, 0, 6), (0, 0, 0), (0, 1, 0)), fov=5.0)
    scene = Scene((ball(1.0, shade), *meshes), lights=lights, environment=environment, cameras=(camera,))
    mean: np.ndarray = np.asarray(
        eclat.render(scene, method, size=(8, 8), samples=64, seed=1, check=False).pixels
    ).mean(axis=(0, 1))
    return mean


# Radiosity passes no light of patches through panes, and says so.
CASES = [(light, method) for light in LAMPS for method in METHODS if (light, method) != ("lamp-in-a-bulb", "patches")]


@pytest.mark.parametrize(("light", "method"), CASES)
def test_a_closed_shade_shines_with_the_sum_of_all_bounces(light: str, method: str) -> None:
    assert seen(SHADE, LAMPS[light], METHODS[method]) == pytest.approx(LAMPS[light][-1], rel=0.05)


@pytest.mark.parametrize("method", METHODS)
def test_a_blend_of_transmitting_and_opaque_materials(method: str) -> None:
    assert seen(SHADES["blend"], LAMPS["point"], METHODS[method]) == pytest.approx(around(WITHIN), rel=0.04)


@pytest.mark.parametrize("method", HALF_OPEN)
def test_a_mask_that_is_half_open_around_a_shade(method: str) -> None:
    """Half of what arrives within leaves at once: E = Φ / (A (1 − ρ/2)). A ray from outside meets the outer side of the shade,
    or passes and meets the inner side of its far wall."""
    within = WITHIN / (AREA * (1 - 0.5 * REFLECTED))
    expected = (0.5 * PASSED + 0.5 * 0.5 * REFLECTED) * within / math.pi
    half_open = replace(SHADE, opacity=grey(0.5))
    assert seen(half_open, LAMPS["point"], HALF_OPEN[method]) == pytest.approx(expected, rel=0.035)
