# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Where Mitsuba 3 answers otherwise, closed forms judge: lamps with smooth normals, masks, and `principled`.

Mitsuba 3.9 ends the emission of a lamp at the horizon of its shading normals, counts the opacity of a mask twice where it is
lit by a lamp sample (0.49 of the light at an opacity of 0.7), and its `principled` makes energy: a white one of roughness 1
shines with 1.30 in a furnace of 1 at a steep view.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, DirectionalLight, Environment, Material, Mesh, Scene, grey, look_at
from support.quick_methods import QUICK

SQUARE = np.array([(-1.0, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
UP = np.array([(0, 1, 2), (0, 2, 3)])
SUN = DirectionalLight((0, 0, -1), (math.pi,) * 3)
SKY = Environment(np.ones((1, 1, 3), np.float32))


def camera(height: float) -> Camera:
    return Camera(look_at((0, 0, height), (0, 0, 0), (0, 1, 0)), 10)


def mean(scene: Scene, method: str) -> float:
    return float(eclat.render(scene, QUICK[method], samples=256, size=(8, 8), max_depth=-1).pixels.mean())


@pytest.mark.parametrize("method", QUICK)
def test_a_lamp_with_smooth_normals_shines_to_all_of_its_geometric_side(method: str) -> None:
    # Normals lean by 80° to one side. What leaves the lamp is L in each direction above its plane, so the eye sees L at any
    # angle, and a point 1 m before the middle of the square gets L π F with the form factor of a square.
    leaning = np.tile([math.sin(math.radians(80)), 0, -math.cos(math.radians(80))], (4, 1))
    glow = Material("diffuse", {"reflectance": grey(0)}, two_sided=False, emission=grey(2))
    lamp = Mesh(SQUARE + np.array([0, 0, 1]), UP[:, ::-1], glow, normals=leaning)
    floor = Mesh(SQUARE, UP, Material("diffuse", {"reflectance": grey(0)}, two_sided=False))
    for x in (-0.8, 0.0, 0.8):
        seen = Camera(look_at((x, 0, 0.1), (0, 0, 1), (0, 1, 0)), 5)
        assert mean(Scene((lamp, floor), cameras=(seen,)), method) == pytest.approx(2, rel=1e-4)
    form_factor = 4 * math.atan(1 / math.sqrt(2)) / math.sqrt(2) / math.pi
    found = eclat.irradiance(Scene((lamp, floor)), [(0, 0, 0)], [(0, 0, 1)], QUICK[method])
    np.testing.assert_allclose(found[0], 2 * math.pi * form_factor, rtol=0.02)


@pytest.mark.parametrize("method", QUICK)
def test_a_mask_reflects_its_opacity_once_and_lets_the_rest_through(method: str) -> None:
    blind = Mesh(SQUARE, UP, Material("diffuse", {"reflectance": grey(0.9)}, opacity=grey(0.7)))
    assert mean(Scene((blind,), (SUN,), cameras=(camera(5),)), method) == pytest.approx(0.7 * 0.9, rel=0.03)
    assert mean(Scene((blind,), (), SKY, cameras=(camera(5),)), method) == pytest.approx(0.7 * 0.9 + 0.3, rel=0.03)
    above = Mesh(SQUARE + np.array([0, 0, 1]), UP, blind.material)
    floor = Mesh(SQUARE / 100, UP, Material("diffuse", {"reflectance": grey(0)}))
    points, up = [(0, 0, 0), (0.1, 0.2, 0)], [(0, 0, 1), (0, 0, 1)]
    lit = eclat.irradiance(Scene((above, floor), (SUN,)), points, up, QUICK[method], samples=16)
    assert lit == pytest.approx(0.3 * math.pi, rel=0.01)  # at each of them, not at 0.3 of all


def principled(metallic: float, roughness: float) -> Scene:
    bsdf: dict[str, Any] = {"type": "principled", "metallic": metallic, "roughness": roughness}
    bsdf["base_color"] = {"type": "rgb", "value": [1.0, 1.0, 1.0]}
    sheet = {"type": "rectangle", "bsdf": bsdf}
    view = {"type": "perspective", "fov": 5, "to_world": look_at((0, 4, 1), (0, 0, 0)) @ np.diag([-1, 1, -1, 1])}
    return eclat.load_dict(
        {"type": "scene", "sensor": view, "sheet": sheet, "sky": {"type": "constant", "radiance": 1.0}}
    )


@pytest.mark.parametrize("roughness", [0.2, 0.5, 1.0])
def test_white_principled_makes_no_energy_and_mixes_in_proportion(roughness: float) -> None:
    # In a furnace a white coat over white paint reflects all, 1; metal at most that; `metallic` mixes the two.
    paint, metal, mixed = (mean(principled(m, roughness), "path") for m in (0.0, 1.0, 0.745))
    assert paint == pytest.approx(1, abs=0.01)
    assert metal <= 1.001
    assert mixed == pytest.approx(0.255 * paint + 0.745 * metal, abs=0.01)
