# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Built-in scenes: the Cornell boxes number for number, the others closed, sound and fit to be looked at."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat.scene import MATERIAL_KINDS, Mesh, Scene
from eclat.scenes import NAMES, build
from support.solids import corners_of, open_edges, signed_volume, thinnest, winding_number

built = cache(build)

SQUARE = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], dtype=float)
CUBE = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
CLOSED = ("furnace", "two-rooms", "door-ajar", "atrium")


def same_points(got: np.ndarray, expected: np.ndarray) -> bool:
    near = np.abs(got[:, None] - expected[None]).max(axis=2) < 1e-7
    return bool(near.any(axis=0).all() and near.any(axis=1).all())


def matrix_of(element: ET.Element) -> np.ndarray:
    return np.array([float(x) for x in element.find("transform/matrix").get("value").split()]).reshape(4, 4)  # type: ignore[union-attr]


def check_shape(mesh: Mesh, kind: str, matrix: np.ndarray) -> None:
    points = SQUARE if kind == "rectangle" else CUBE
    assert same_points(np.asarray(mesh.positions), points @ matrix[:3, :3].T + matrix[:3, 3]), mesh.name
    a, b, c = np.moveaxis(corners_of([mesh]), 1, 0)
    normals = np.cross(b - a, c - a)
    outwards = np.tile(matrix[:3, 2], (len(a), 1)) if kind == "rectangle" else (a + b + c) / 3 - matrix[:3, 3]
    assert (np.einsum("ij,ij->i", normals, outwards) > 0).all(), f"{mesh.name} faces the wrong way"
    area = np.linalg.norm(normals, axis=1).sum() / 2
    sides = np.linalg.norm(matrix[:3, :3], axis=0) * 2
    whole = sides[0] * sides[1] if kind == "rectangle" else 2 * (sides * np.roll(sides, 1)).sum()
    assert area == pytest.approx(whole, rel=1e-6)
    assert mesh.material.two_sided is False


@pytest.mark.parametrize(("name", "file"), [("cornell-box", "cbox-diffuse.xml"), ("glossy-box", "cbox-glossy.xml")])
def test_boxes_are_the_target_files_number_for_number(name: str, file: str, scenes: Path) -> None:
    root = ET.parse(scenes / "targets" / file).getroot()
    colours = {b.get("id"): [float(x) for x in b.find("rgb").get("value").split(",")] for b in root.iter("bsdf")}  # type: ignore[union-attr]
    scene = built(name)
    shapes = list(root.iter("shape"))
    assert [m.name for m in scene.meshes] == [s.get("id") for s in shapes]
    for shape, mesh in zip(shapes, scene.meshes, strict=True):
        check_shape(mesh, str(shape.get("type")), matrix_of(shape))
        bsdf = shape.find("ref").get("id")  # type: ignore[union-attr]
        if bsdf == "gloss":
            assert mesh.material.kind == "conductor"
            constants = {key: value.constant for key, value in mesh.material.parameters.items()}
            assert constants["alpha_u"][0] == 0.2
            assert (constants["eta"], constants["k"]) == ((0, 0, 0), (1, 1, 1))
            assert constants["specular_reflectance"] == pytest.approx(colours["gloss"])
        else:
            assert mesh.material.kind == "diffuse"
            assert mesh.material.parameters["reflectance"].constant == pytest.approx(colours[bsdf])
        radiance = shape.find("emitter/rgb")
        emission = mesh.material.emission
        assert (radiance is None) == (emission is None)
        if radiance is not None and emission is not None:
            assert emission.constant == pytest.approx([float(x) for x in str(radiance.get("value")).split(",")])
    sensor = root.find("sensor")
    assert sensor is not None
    check_camera(scene, matrix_of(sensor), float(sensor.find("float[@name='fov']").get("value")))  # type: ignore[union-attr]


def check_camera(scene: Scene, mitsuba: np.ndarray, fov: float) -> None:
    (camera,) = scene.cameras
    # Mitsuba looks along +z with +x to the left.
    np.testing.assert_allclose(camera.to_world, mitsuba @ np.diag([-1, 1, -1, 1]), atol=1e-7)
    assert (camera.fov, camera.fov_axis, camera.size) == (pytest.approx(fov), "smaller", (512, 512))


def test_cornell_box_is_mitsubas() -> None:
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    theirs = mitsuba.cornell_box()
    scene = built("cornell-box")
    for mesh in scene.meshes:
        shape = theirs[mesh.name]
        check_shape(mesh, shape["type"], np.array(shape["to_world"].matrix))
        colour = theirs[shape["bsdf"]["id"]]["reflectance"]["value"]
        assert mesh.material.parameters["reflectance"].constant == pytest.approx(colour)
    assert scene.meshes[0].material.emission.constant == pytest.approx(theirs["light"]["emitter"]["radiance"]["value"])  # type: ignore[union-attr]
    check_camera(scene, np.array(theirs["sensor"]["to_world"].matrix), theirs["sensor"]["fov"])


@pytest.mark.parametrize("name", NAMES)
def test_every_scene_is_sound(name: str) -> None:
    scene = built(name)
    assert scene.name == name and scene.cameras and scene.cameras[0].size
    for mesh in scene.meshes:
        assert mesh.material.kind in MATERIAL_KINDS
        assert set(mesh.material.parameters) <= set(MATERIAL_KINDS[mesh.material.kind])
        assert np.isfinite(mesh.positions).all()
        assert mesh.triangles.min() >= 0 and mesh.triangles.max() < len(mesh.positions)
        assert thinnest(mesh) > 1e-5, f"{mesh.name} has a degenerate triangle"
        if mesh.normals is not None:
            np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-6)
            a, b, c = np.moveaxis(corners_of([mesh]), 1, 0)
            faces = np.cross(b - a, c - a)
            assert (np.einsum("ij,ikj->ik", faces, mesh.normals[mesh.triangles]) > 0).all(), f"{mesh.name}: normals"
        if mesh.uvs is not None:
            assert mesh.uvs.shape == (len(mesh.positions), 2) and np.isfinite(mesh.uvs).all()


@pytest.mark.parametrize("name", CLOSED)
def test_solids_are_watertight(name: str) -> None:
    for mesh in built(name).meshes:
        assert open_edges(mesh) == 0, f"{name}: {mesh.name} has holes"


@pytest.mark.parametrize(("name", "free"), [("furnace", -1), ("two-rooms", -1), ("door-ajar", -1), ("atrium", 0)])
def test_cameras_are_in_the_open(name: str, free: int) -> None:
    """The winding number of all surfaces together: −1 in rooms, which are shells turned in, 0 under the sky."""
    scene = built(name)
    corners = corners_of(scene.meshes)
    for camera in scene.cameras:
        assert winding_number(corners, camera.to_world[:3, 3]) == pytest.approx(free, abs=1e-6)


def test_the_atriums_parts_are_solid() -> None:
    """Points in a column, a vault, the wall and the floor are inside; in the middle of court, walk and gallery not."""
    corners = corners_of(built("atrium").meshes)
    for inside in [(8, 2, 1.6), (9.6, 5.1, 0), (11.2, 4, 3), (0, -0.4, 6), (8, 6, 4.8), (8, 8, 11)]:
        assert winding_number(corners, inside) > 0.9, inside
    for outside in [(0, 4, 6), (9.6, 2, 0.3), (9.6, 7, 0.3), (8, 2, 3.2), (0, 30, 0)]:
        assert winding_number(corners, outside) == pytest.approx(0, abs=1e-6), outside


def test_the_atrium_is_a_real_test() -> None:
    scene = built("atrium")
    assert 30_000 < sum(len(m.triangles) for m in scene.meshes) < 200_000
    assert signed_volume(corners_of(scene.meshes)) > 0
    assert scene.environment is not None and len(scene.lights) == 1
    textures = [m.material.parameters["reflectance"].texture for m in scene.meshes]
    assert sum(t is not None for t in textures) == 2


@pytest.mark.parametrize(("shape", "area"), [("box", 24.0), ("sphere", 4 * np.pi)])
def test_furnace_is_a_closed_shell_that_faces_in(shape: str, area: float) -> None:
    scene = build("furnace", rho=0.25, emission=3, shape=shape)
    (mesh,) = scene.meshes
    corners = corners_of(scene.meshes)
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert open_edges(mesh) == 0
    assert winding_number(corners, (0.1, 0.2, 0.3)) == pytest.approx(-1)
    assert np.linalg.norm(faces, axis=1).sum() / 2 == pytest.approx(area, rel=0.05)
    assert mesh.material.parameters["reflectance"].constant == (0.25,) * 3
    assert mesh.material.emission is not None and mesh.material.emission.constant == (3.0,) * 3


@pytest.mark.parametrize("thickness", [1e-3, 0.01, 0.3])
def test_the_wall_between_two_rooms_has_no_way_around(thickness: float) -> None:
    scene = build("two-rooms", wall_thickness=thickness)
    wall, shell = (next(m for m in scene.meshes if m.name == n) for n in ("wall", "shell"))
    assert np.ptp(wall.positions[:, 0]) == pytest.approx(thickness)
    for axis in (1, 2):
        assert wall.positions[:, axis].min() < shell.positions[:, axis].min()
        assert wall.positions[:, axis].max() > shell.positions[:, axis].max()
    (lamp,) = (m for m in scene.meshes if m.material.emission is not None)
    assert lamp.positions[:, 0].max() < wall.positions[:, 0].min()
    assert [np.sign(c.to_world[0, 3]) for c in scene.cameras] == [-1, 1]


@pytest.mark.parametrize("opening", [1, 32, 120])
def test_the_door_opens_as_far_as_asked(opening: float) -> None:
    leaf = next(m for m in build("door-ajar", opening=opening).meshes if m.name == "door-leaf")
    hinge = np.array([6.02, 3.794])
    reach = leaf.positions[np.argmax(np.linalg.norm(leaf.positions[:, [0, 2]] - hinge, axis=1))][[0, 2]] - hinge
    assert abs(np.degrees(np.arctan2(-reach[0], -reach[1])) - opening) < 2
    assert open_edges(leaf) == 0


def test_polish_changes_materials_only() -> None:
    plain, polished = built("door-ajar"), build("door-ajar", polished=True)
    assert {m.material.kind for m in plain.meshes} == {"diffuse"}
    assert {m.material.kind for m in polished.meshes} == {"diffuse", "conductor", "plastic", "dielectric"}
    for a, b in zip(plain.meshes, polished.meshes, strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)


def test_scenes_are_the_same_every_time() -> None:
    for a, b in zip(build("atrium").meshes, built("atrium").meshes, strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)
        np.testing.assert_array_equal(a.triangles, b.triangles)


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        ("atriun", {}, "did you mean 'atrium'"),
        ("cornell-box", {"size": 3}, "no parameters"),
        ("furnace", {"rh": 0.3}, "did you mean 'rho'"),
        ("furnace", {"rho": 1.0}, "rho"),
        ("furnace", {"emission": float("nan")}, "emission"),
        ("furnace", {"shape": "cone"}, "shape"),
        ("two-rooms", {"wall_thickness": 0}, "wall_thickness"),
        ("door-ajar", {"opening": float("nan")}, "opening"),
        ("glossy-box", {"alpha": -1}, "alpha"),
        ("atrium", {"sun_elevation": 0}, "sun_elevation"),
        ("atrium", {"turbidity": float("inf")}, "turbidity"),
    ],
)
def test_bad_requests_are_named(name: str, parameters: dict[str, object], message: str) -> None:
    with pytest.raises(EclatError, match=message):
        build(name, **parameters)
