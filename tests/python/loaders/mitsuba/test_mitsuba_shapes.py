# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Shapes of Mitsuba scenes: the same surface, texture coordinates and sides as in Mitsuba 3."""

from __future__ import annotations

import json
import math
import warnings
from base64 import b64encode
from dataclasses import dataclass

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.loaders.mitsuba import load_dict
from eclat.loaders.mitsuba.primitives import SEGMENTS
from eclat.scene import Mesh

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0.25 0.75\nf 1/1/1 2/1/1 3/1/1\n"
GLOW = {"type": "area", "radiance": {"type": "rgb", "value": [1.0, 2.0, 3.0]}}
KINDS = ("rectangle", "cube", "sphere", "disk", "cylinder")


@dataclass
class Hit:
    position: np.ndarray
    normal: np.ndarray
    geometric: np.ndarray
    uv: np.ndarray


def mesh_of(shape: dict, **others: object) -> Mesh:
    (mesh,) = load_dict({"type": "scene", "shape": shape, **others}).meshes
    return mesh


def first_hit(mesh: Mesh, origin: np.ndarray, direction: np.ndarray) -> Hit | None:
    """The nearest hit, by brute force over the triangles."""
    corners = np.asarray(mesh.positions)[mesh.triangles]
    e1, e2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = np.cross(direction, e2)
    det = np.einsum("ij,ij->i", e1, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = origin - corners[:, 0]
        u = np.einsum("ij,ij->i", s, p) / det
        q = np.cross(s, e1)
        v = q @ direction / det
        t = np.einsum("ij,ij->i", e2, q) / det
        valid = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 1e-6)
    if not valid.any():
        return None
    index = int(np.argmin(np.where(valid, t, np.inf)))
    weights = np.array([1 - u[index] - v[index], u[index], v[index]])
    vertices = mesh.triangles[index]
    normal = weights @ np.asarray(mesh.normals)[vertices]
    geometric = np.cross(e1[index], e2[index])
    return Hit(
        origin + t[index] * direction,
        normal / np.linalg.norm(normal),
        geometric / np.linalg.norm(geometric),
        weights @ np.asarray(mesh.uvs)[vertices],
    )


def area(mesh: Mesh) -> float:
    corners = np.asarray(mesh.positions)[mesh.triangles]
    return float(
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    )


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("flip", [False, True])
def test_primitives_have_mitsubas_surface_sides_and_texture_coordinates(kind: str, flip: bool) -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    to_world = mi.ScalarTransform4f().translate([0.3, -0.2, 0.1]).rotate([1 / 3, 2 / 3, 2 / 3], 40).scale(1.5)
    shape = {"type": kind, "to_world": to_world, "flip_normals": flip}
    theirs, ours = mi.load_dict({"type": "scene", "shape": shape}), mesh_of(shape)
    random = np.random.default_rng(1)
    hits = 0
    for _ in range(60):
        origin = random.normal(size=3)
        origin *= 8 / np.linalg.norm(origin)
        direction = random.normal(scale=0.6, size=3) - origin
        direction /= np.linalg.norm(direction)
        expected = theirs.ray_intersect(mi.Ray3f(origin, direction))
        got = first_hit(ours, origin, direction)
        if not expected.is_valid() or got is None:
            continue
        hits += 1
        # A facet departs from the true surface along the ray by its chord error over the cosine.
        slack = 2e-3 / max(abs(float(got.normal @ direction)), 0.05)
        assert np.allclose(got.position, expected.p, atol=slack)
        assert np.allclose(got.normal, expected.sh_frame.n, atol=max(2 * slack, 1e-4))
        assert got.geometric @ got.normal > 0.99
        difference = np.abs(got.uv - np.asarray(expected.uv))
        difference[0] = min(difference[0], 1 - difference[0])
        if kind != "disk":  # its v is an angle, constant over a facet's centre
            assert difference.max() < max(slack, 1e-4)
        elif got.uv[0] > 0.3:
            assert difference.max() < 0.02
    assert hits > 20


def test_tessellation_keeps_the_area_and_a_thousandth_of_the_radius() -> None:
    sphere = mesh_of({"type": "sphere", "radius": 2.0, "center": [1, 2, 3]})
    assert area(sphere) == pytest.approx(4 * math.pi * 4, rel=1e-12)
    corners = np.asarray(sphere.positions)[sphere.triangles] - (1, 2, 3)
    probes = np.concatenate([corners.reshape(-1, 3), corners.mean(axis=1), (corners[:, 0] + corners[:, 1]) / 2])
    assert np.abs(np.linalg.norm(probes, axis=1) / 2 - 1).max() < 1e-3
    assert area(mesh_of({"type": "disk"})) == pytest.approx(math.pi, rel=1e-12)
    cylinder = mesh_of({"type": "cylinder", "p0": [0, 0, 1], "p1": [0, 2, 1], "radius": 0.5})
    assert area(cylinder) == pytest.approx(2 * math.pi * 0.5 * 2, rel=1e-12)
    assert len(sphere.triangles) == SEGMENTS * (SEGMENTS - 2)


def test_spheres_texture_seam_and_poles_do_not_smear() -> None:
    sphere = mesh_of({"type": "sphere"})
    uvs = np.asarray(sphere.uvs)[sphere.triangles]
    assert np.ptp(uvs[..., 0], axis=1).max() <= 1 / SEGMENTS + 1e-12


def test_mirrored_shapes_keep_their_outside() -> None:
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    for kind in KINDS:
        mesh = mesh_of({"type": kind, "to_world": mirror})
        corners = np.asarray(mesh.positions)[mesh.triangles]
        geometric = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        sides = np.einsum("ij,ij->i", geometric, np.asarray(mesh.normals)[mesh.triangles[:, 0]])
        assert (sides > 0).all()
        outside = (0, 0, 1) if kind in ("rectangle", "disk") else corners.mean(axis=1) - corners.mean(axis=(0, 1))
        assert (np.asarray(mesh.normals)[mesh.triangles[:, 0]] * outside).sum(axis=1).min() >= -1e-9


def test_face_normals_make_a_primitive_flat() -> None:
    mesh = mesh_of({"type": "sphere", "face_normals": True})
    assert mesh.normals is None


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize("against", [False, True])
def test_vertex_normals_of_a_file_decide_which_side_shines(tmp_path, mirrored: bool, flip: bool, against: bool) -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    path = tmp_path / "triangle.obj"
    path.write_text(TRIANGLE.replace("vn 0 0 1", "vn 0 0 -1") if against else TRIANGLE)
    to_world = mi.ScalarTransform4f().scale([-1 if mirrored else 1, 1, 1])
    shape = {
        "type": "obj",
        "filename": str(path),
        "to_world": to_world,
        "flip_normals": flip,
        "bsdf": {"type": "diffuse"},
        "emitter": GLOW,
    }
    theirs = mi.load_dict({"type": "scene", "shape": shape})
    x = -0.2 if mirrored else 0.2
    seen = theirs.ray_intersect(mi.Ray3f([x, 0.2, 5], [0, 0, -1]))
    shines_up = seen.emitter(theirs).eval(seen)[0] > 0
    hit = first_hit(mesh_of(shape), np.array([x, 0.2, 5.0]), np.array([0, 0, -1.0]))
    assert hit is not None
    assert (hit.geometric[2] > 0) == shines_up
    assert np.allclose(hit.uv, seen.uv)


def test_instances_are_copies_of_their_group(tmp_path) -> None:
    group = {
        "type": "shapegroup",
        "one": {"type": "rectangle"},
        "two": {"type": "cube", "bsdf": {"type": "ref", "id": "red"}},
    }
    scene = load_dict(
        {
            "type": "scene",
            "red": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [1, 0, 0]}},
            "group": group,
            "a": {"type": "instance", "to_world": np.diag([2.0, 2, 2, 1]), "group": {"type": "ref", "id": "group"}},
            "b": {"type": "instance", "group": {"type": "ref", "id": "group"}},
        }
    )
    assert len(scene.meshes) == 4
    assert np.abs(scene.meshes[1].positions).max() == 2
    assert scene.meshes[1].material is scene.meshes[3].material


def test_an_area_light_gives_its_shape_emission_and_shares_materials() -> None:
    white = {"type": "twosided", "inner": {"type": "diffuse"}}
    use = {"type": "rectangle", "bsdf": {"type": "ref", "id": "white"}}
    lamp = use | {"emitter": GLOW}
    scene = load_dict({"type": "scene", "white": white, "a": use, "b": use, "lamp": lamp})
    a, b, light = (mesh.material for mesh in scene.meshes)
    assert a is b and a.name == "white" and a.emission is None
    assert light.emission is not None and light.emission.constant == (1.0, 2.0, 3.0) and light.two_sided


def test_shapes_that_we_do_not_have_are_named_and_left_out() -> None:
    with pytest.raises(EclatError, match=r"spere.*did you mean 'sphere'"):
        load_dict({"type": "scene", "shape_1": {"type": "spere"}})
    with pytest.warns(EclatWarning, match="qwxyz"):  # somebody's plugin
        scene = load_dict({"type": "scene", "shape_1": {"type": "qwxyz"}})
    assert scene.meshes == ()
    with pytest.warns(
        EclatWarning, match="hair.*not supported; the shape is left out"
    ):  # Mitsuba has it: the name is right
        load_dict({"type": "scene", "shape_1": {"type": "hair"}})


def test_shapes_that_cannot_be_are_refused() -> None:
    with pytest.raises(EclatError, match=r"dict\['s'\].*radius.*above 0, got -1"):
        load_dict({"type": "scene", "s": {"type": "sphere", "radius": -1}})
    with pytest.raises(EclatError, match="expected one nested shapegroup, got"):
        load_dict({"type": "scene", "s": {"type": "instance"}})
    with pytest.warns(EclatWarning, match="p0 and p1 are the same point"):
        load_dict({"type": "scene", "s": {"type": "cylinder", "p1": [0, 0, 0]}})
    with pytest.warns(EclatWarning, match="the shape becomes flat"):
        load_dict({"type": "scene", "s": {"type": "cube", "to_world": np.diag([1.0, 1, 0, 1])}})
    with pytest.raises(
        EclatError, match=r"dict\['s'\].*filename: expected a mesh file, but .*missing\.obj does not exist"
    ):
        load_dict({"type": "scene", "s": {"type": "obj", "filename": "missing.obj", "bsdf": {"type": "diffuse"}}})
    far = np.diag([1e25, 1e25, 1e25, 1.0])
    with pytest.raises(EclatError, match=r"dict\['s'\].*expected coordinates whose absolute value is at most 1e\+18"):
        load_dict({"type": "scene", "s": {"type": "cube", "to_world": far}})


def test_normals_stay_unit_where_a_transform_leaves_no_area() -> None:
    with pytest.warns(EclatWarning, match="the shape becomes flat"):
        scene = load_dict({"type": "scene", "s": {"type": "cube", "to_world": np.diag([1.0, 0, 0, 1])}})
    normals = scene.meshes[0].normals
    assert normals is not None
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)


def test_the_shortest_cylinders_have_an_axis() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = load_dict({"type": "scene", "s": {"type": "cylinder", "p1": [0, 0, 1e-200]}})
    assert len(scene.meshes) == 1


def test_a_million_copies_are_refused_before_they_fill_the_memory() -> None:
    group = {"type": "shapegroup", "ball": {"type": "sphere"}}
    copy = {"type": "instance", "group": {"type": "ref", "id": "group"}}
    copies = {f"copy_{i}": copy for i in range(20)}
    with (
        pytest.MonkeyPatch.context() as patch,
        pytest.raises(EclatError, match=r"copy_\d+.*at most 4 MiB of geometry"),
    ):
        patch.setattr("eclat.loaders.budget.ALLOWANCE", 1 << 22)
        eclat.load_dict({"type": "scene", "group": group, **copies})


def test_gltf_is_a_shape_with_its_own_materials(tmp_path) -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4")
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"name": "paint", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}],
        "buffers": [
            {"byteLength": 36, "uri": "data:application/octet-stream;base64," + b64encode(points.tobytes()).decode()}
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}
        ],
    }
    (tmp_path / "one.gltf").write_text(json.dumps(document))
    shape = {"type": "gltf", "filename": "one.gltf", "to_world": np.diag([2.0, 2, 2, 1])}
    (mesh,) = load_dict({"type": "scene", "shape": shape}, tmp_path).meshes
    assert mesh.material.kind == "metallic_roughness" and np.asarray(mesh.positions).max() == 2
    (mesh,) = load_dict({"type": "scene", "shape": shape | {"paint": {"type": "plastic"}}}, tmp_path).meshes
    assert mesh.material.kind == "plastic"


@pytest.mark.parametrize("kind", ["rectangle", "disk"])
def test_a_flat_shape_without_an_area_is_named(kind: str) -> None:
    flat = {"type": kind, "to_world": np.diag([0.0, 1.0, 1.0, 1.0])}
    with pytest.warns(EclatWarning, match="the matrix leaves no area of the shape"):
        load_dict({"type": "scene", "flat": flat, "other": {"type": "rectangle"}})


@pytest.mark.parametrize(
    "bsdf", [{"type": "null"}, {"type": "mask", "opacity": 0.0, "inner": {"type": "diffuse", "reflectance": 0.5}}]
)
def test_a_lamp_that_lets_all_light_through_becomes_black(bsdf: dict) -> None:
    shape = {"type": "rectangle", "bsdf": bsdf, "emitter": {"type": "area", "radiance": 3.0}}
    with pytest.warns(EclatWarning, match="the surface becomes opaque and black"):
        (mesh,) = load_dict({"type": "scene", "lamp": shape}).meshes
    material = mesh.material
    assert material.parameters["reflectance"].constant == (0, 0, 0)
    assert (material.opacity.constant, material.emission.constant) == ((1, 1, 1), (3, 3, 3))
