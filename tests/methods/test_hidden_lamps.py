# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Lamps that are hidden from cameras: they light what is below them by the closed form, the camera sees through them,
and mirrors show them."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, Material, Mesh, Scene, grey, look_at, rgb

HALF, HEIGHT, RADIANCE, REFLECTANCE = 0.25, 1.0, 3.0, 0.5

OPTIONS = {"photon-map": {"photons": 5_000, "caustic_photons": 1_000}, "radiosity": {"patches": 500}}


def square(y: float, half: float, up: bool, material: Material, name: str) -> Mesh:
    corners = np.array([[-half, y, -half], [-half, y, half], [half, y, half], [half, y, -half]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    return Mesh(corners, triangles if up else triangles[:, ::-1], material, name=name)


def lit_floor(floor: Material, **lamp: bool) -> Scene:
    """A floor below a lamp that shines up and down, seen from above the lamp."""
    black = {"reflectance": grey(0)}
    glow = Material("diffuse", black, "lamp", emission=rgb(*3 * (RADIANCE,)), emission_two_sided=True, **lamp)
    meshes = (square(0, 4, True, floor, "floor"), square(HEIGHT, HALF, False, glow, "lamp"))
    camera = Camera(look_at((0, 3, 0), (0, 0, 0), up=(0, 0, 1)), fov=4, size=(8, 8))
    return Scene(meshes, (), cameras=(camera,))


def below_the_lamp() -> float:
    """Radiance of the floor below the middle of the lamp, by the form factor of a rectangle."""
    x = HALF / HEIGHT
    root = math.sqrt(1 + x * x)
    return REFLECTANCE * RADIANCE * 4 / math.pi * x / root * math.atan(x / root)


@pytest.mark.parametrize("method", eclat.METHODS)
def test_the_floor_is_seen_through_a_hidden_lamp_that_lights_it(method: str) -> None:
    floor = Material("diffuse", {"reflectance": grey(REFLECTANCE)})
    options = eclat.METHODS[method](**OPTIONS.get(method, {}))
    for hidden, expected in ((True, below_the_lamp()), (False, RADIANCE)):
        scene = lit_floor(floor, hidden_from_camera=hidden)
        image = eclat.render(scene, options, samples=64, denoise=False, seed=2)
        assert image.pixels.mean() == pytest.approx(expected, rel=0.02)
        assert image.layers["depth"].mean() == pytest.approx(3.0 if hidden else 3.0 - HEIGHT, rel=0.01)


def test_a_mirror_shows_the_lamp_that_the_camera_does_not_see() -> None:
    scene = lit_floor(Material("conductor"), hidden_from_camera=True)
    assert eclat.render(scene, "path", samples=8).pixels.mean() == pytest.approx(RADIANCE, rel=1e-3)


def test_irradiance_does_not_depend_on_what_the_camera_sees() -> None:
    scene = lit_floor(Material("diffuse", {"reflectance": grey(REFLECTANCE)}), hidden_from_camera=True)
    shown = replace(scene, meshes=(scene.meshes[0], replace(scene.meshes[1], material=replace(
        scene.meshes[1].material, hidden_from_camera=False))))  # fmt: skip
    points, up = [[0.0, 0.0, 0.0], [0.3, 0.0, 0.2]], [[0.0, 1.0, 0.0]] * 2
    found = [eclat.irradiance(s, points, up, "path", samples=256, seed=4) for s in (scene, shown)]
    assert np.array_equal(*found)
    assert found[0][0, 0] * REFLECTANCE / math.pi == pytest.approx(below_the_lamp(), rel=0.01)


def test_mitsubas_hide_emitters_hides_lamps(tmp_path: Path) -> None:
    text = """<scene version="3.0.0"><integrator type="path"><boolean name="hide_emitters" value="true"/></integrator>
      <shape type="rectangle"><emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>
      <shape type="cube"/></scene>"""
    (tmp_path / "a.xml").write_text(text, encoding="utf-8")
    hidden = eclat.load(tmp_path / "a.xml")
    assert [mesh.material.hidden_from_camera for mesh in hidden.meshes] == [True, False]
    (tmp_path / "a.xml").write_text(text.replace("true", "false"), encoding="utf-8")
    assert not any(mesh.material.hidden_from_camera for mesh in eclat.load(tmp_path / "a.xml").meshes)
