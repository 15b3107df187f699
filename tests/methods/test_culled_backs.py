# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Single-sided materials of glTF: nobody sees their backs, and what is seen is what lights, by every method."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.gltf_export import encode_glb
from eclat.scene import Camera, DirectionalLight, Environment, Material, Mesh, PointLight, Scene, grey, look_at, rgb
from support.gltf_files import GltfFile
from support.quick_methods import QUICK

METHODS = QUICK | {"radiosity, patches": eclat.Radiosity(patches=300, gather=0)}

SQUARE = np.array([(-1.0, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
HALVES = np.array([(0, 1, 2), (0, 2, 3)])


def paint(reflectance: float, *, culled: bool = True) -> Material:
    return Material("diffuse", {"reflectance": grey(reflectance)}, two_sided=False, back_culled=culled)


def square(material: Material, height: float = 0, size: float = 1, *, down: bool = False) -> Mesh:
    """In the plane z = height, its front upwards."""
    turned = HALVES[:, ::-1] if down else HALVES
    return Mesh(SQUARE * size + np.array([0, 0, height]), turned, material)


def camera_above(height: float) -> Camera:
    return Camera(look_at((0, 0, height), (0, 0, 0), (0, 1, 0)), 10)


def sky(radiance: float) -> Environment:
    return Environment(np.full((1, 1, 3), radiance, np.float32))


def mean(scene: Scene, method: str) -> np.ndarray:
    picture = eclat.render(scene, METHODS[method], samples=32, size=(8, 8), max_depth=-1).pixels
    return picture.reshape(-1, 3).mean(axis=0)


GLOW = Material("diffuse", {"reflectance": grey(0)}, two_sided=False, emission=rgb(1, 0, 0))


@pytest.mark.parametrize("method", METHODS)
def test_a_wall_is_seen_through_the_back_of_a_sheet(method: str) -> None:
    sheet = square(paint(0.5), down=True)
    scene = Scene((sheet, square(GLOW, -1, 4)), cameras=(camera_above(5),))
    np.testing.assert_allclose(mean(scene, method), (1, 0, 0), atol=1e-6)
    black = replace(sheet, material=paint(0.5, culled=False))
    np.testing.assert_allclose(mean(replace(scene, meshes=(black, *scene.meshes[1:])), method), 0, atol=1e-6)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("front_first", [True, False])
def test_two_sheets_back_to_back_are_a_wall(method: str, front_first: bool) -> None:
    # Lit by π lux, each side reflects ρ, whichever comes first in the file; nothing shines through.
    sheets = (square(paint(0.5)), square(paint(0.3), down=True))
    sun = DirectionalLight((0, 0, -1), (np.pi,) * 3)
    scene = Scene(sheets if front_first else sheets[::-1], (sun,), cameras=(camera_above(5),))
    np.testing.assert_allclose(mean(scene, method), 0.5, rtol=0.02)
    below = replace(scene, lights=(DirectionalLight((0, 0, 1), (np.pi,) * 3),))
    from_below = Camera(look_at((0, 0, -5), (0, 0, 0), (0, 1, 0)), 10)
    np.testing.assert_allclose(mean(replace(below, cameras=(from_below,)), method), 0.3, rtol=0.02)
    np.testing.assert_allclose(mean(below, method), 0, atol=1e-6)


@pytest.mark.parametrize("method", [name for name in METHODS if name != "direct"])
def test_a_closed_room_seen_from_outside_gets_no_daylight_inside(method: str) -> None:
    # The inside is a furnace, L = L_e / (1 − ρ), whatever shines outside.
    wall = Material("diffuse", {"reflectance": grey(0.5)}, two_sided=False, back_culled=True, emission=grey(1))
    corners = np.array([(x, y, z) for x in (-1.0, 1) for y in (-1.0, 1) for z in (-1.0, 1)])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in faces for t in ((a, c, b), (a, d, c))])
    inwards = Mesh(corners, triangles[:, ::-1] if _volume(corners, triangles) > 0 else triangles, wall)
    sun = DirectionalLight((0, 0, -1), (5.0,) * 3)
    scene = Scene((inwards,), (sun,), sky(3), cameras=(camera_above(5),))
    np.testing.assert_allclose(mean(scene, method), 2, rtol=0.03)


def _volume(corners: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (corners[triangles[:, i]] for i in range(3))
    return float((np.cross(a, b) * c).sum())


@pytest.mark.parametrize("method", METHODS)
def test_irradiance_is_of_what_points_see(method: str) -> None:
    # Above a point hangs a wide sheet, and above that a sky of 1: through its back the point sees the sky, E = π; where its
    # front looks at the point, it sees a dark sheet.
    for down, wanted in ((False, np.pi), (True, 0.0)):
        scene = Scene((square(paint(0), 1, 1000, down=down), square(paint(0), 0, 1)), environment=sky(1))
        found = eclat.irradiance(scene, [(0.2, 0.1, 0)], [(0, 0, 1)], METHODS[method])
        np.testing.assert_allclose(found[0], wanted, rtol=0.03, atol=0.01)


def test_photons_light_what_sees_their_source() -> None:
    """Between a ceiling and a sheet hangs a lamp. The floor below sees both through the sheet's back, or only its front:
    photon maps agree with paths, whichever way the sheet looks."""
    lamp = PointLight((0, 0, 0.75), (1.0,) * 3)
    for down in (False, True):
        sheet = square(paint(0.5), 0.5, 8, down=down)
        scene = Scene((sheet, square(paint(0.8), 1, 8, down=True), square(paint(0.8), 0, 1)), (lamp,))
        truth, found = (
            eclat.irradiance(scene, [(0, 0, 0)], [(0, 0, 1)], METHODS[m], component="indirect")[0, 0]
            for m in ("path", "photon-map")
        )
        assert (truth < 1e-6) == down
        assert found == pytest.approx(truth, rel=0.05, abs=1e-4)


def test_single_sided_gltf_materials_are_culled_from_behind(tmp_path: Path) -> None:
    for double in (False, True):
        file = GltfFile()
        file.mesh_node(file.primitive(material=file.append("materials", {"doubleSided": double})))
        material = eclat.load(file.save(tmp_path)).meshes[0].material
        assert (material.two_sided, material.back_culled) == (double, not double)


@pytest.mark.parametrize("culled", [True, False])
def test_a_black_back_stays_black_when_a_scene_is_written_and_read(culled: bool, tmp_path: Path) -> None:
    (tmp_path / "scene.glb").write_bytes(encode_glb(Scene((square(paint(0.5, culled=culled)),))))
    material = eclat.load(tmp_path / "scene.glb").meshes[0].material
    assert not material.two_sided and material.back_culled == culled
