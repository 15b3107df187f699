# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Materials and lamps as other programs write them: radiance in closed form, by every method that can tell it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from support.quick_methods import GLOBAL, QUICK

CAMERA = {
    "type": "perspective",
    "fov": 40,
    "to_world": np.array([(-1.0, 0, 0, 0), (0, 1, 0, 0), (0, 0, -1, 3), (0, 0, 0, 1)]),
}
SKY = {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}


def mean_radiance(scene: eclat.Scene, method: str, crop: tuple[int, int, int, int] | None = None) -> np.ndarray:
    picture = eclat.render(scene, QUICK[method], samples=64, size=(16, 16), max_depth=-1).pixels
    x0, y0, x1, y1 = crop or (0, 0, 16, 16)
    return picture[y0:y1, x0:x1].reshape(-1, 3).mean(axis=0)


@pytest.mark.parametrize("method", GLOBAL)
@pytest.mark.parametrize("shape", ["sphere", "cube", "ply"])
def test_a_lamp_without_a_bsdf_reflects_nothing(shape: str, method: str, tmp_path: Path) -> None:
    # Inside a body that shines with radiance 1 and absorbs all that arrives, every ray finds 1; with an albedo ρ it would
    # find 1 / (1 − ρ).
    lamp: dict[str, Any] = {"type": shape, "flip_normals": True, "emitter": {"type": "area", "radiance": 1.0}}
    if shape == "sphere":
        lamp["radius"] = 10.0
    elif shape == "cube":
        lamp["to_world"] = np.diag([10.0, 10.0, 10.0, 1.0])
    else:
        corners = 10 * np.array([(1, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1)])
        faces = [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]
        body = (
            "\n".join(" ".join(map(str, c)) for c in corners) + "\n" + "\n".join(f"3 {a} {c} {b}" for a, b, c in faces)
        )
        head = (
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        )
        (tmp_path / "body.ply").write_text(head + body + "\n")
        lamp |= {"filename": str(tmp_path / "body.ply")}
        lamp["to_world"] = np.diag([3.0, 3.0, 3.0, 1.0])
    scene = eclat.load_dict({"type": "scene", "camera": CAMERA, "lamp": lamp})
    np.testing.assert_allclose(mean_radiance(scene, method), 1, rtol=1e-3)


BACKS: dict[str, dict[str, Any]] = {
    "diffuse": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.9, 0.1, 0.1]}},
    "phong": {"type": "phong", "diffuse_reflectance": {"type": "rgb", "value": [0.9, 0.1, 0.1]}, "specular_reflectance": 0.0},
    "blend": {
        "type": "blendbsdf", "weight": 0.5,
        "a": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.9, 0.2, 0.0]}},
        "b": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.9, 0.0, 0.2]}},
    },
}  # fmt: skip


@pytest.mark.parametrize("method", list(QUICK))
@pytest.mark.parametrize("kind", list(BACKS))
def test_the_second_bsdf_of_twosided_is_seen_from_behind(kind: str, method: str) -> None:
    front = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}}
    turned = np.diag([-3.0, 3.0, -3.0, 1.0])
    wall = {"type": "rectangle", "to_world": turned, "bsdf": {"type": "twosided", "front": front, "back": BACKS[kind]}}
    scene = eclat.load_dict({"type": "scene", "camera": CAMERA, "sky": SKY, "wall": wall})
    np.testing.assert_allclose(mean_radiance(scene, method), (0.9, 0.1, 0.1), atol=0.01)


@pytest.mark.parametrize("method", list(QUICK))
@pytest.mark.parametrize("glossy", ["conductor", "plastic", "ward", "principled"])
def test_a_glossy_second_bsdf_of_twosided_looks_as_it_does_alone(glossy: str, method: str) -> None:
    front = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}}
    bsdf: dict[str, Any] = {"type": glossy}
    turned, seen = np.diag([-3.0, 3.0, -3.0, 1.0]), np.diag([3.0, 3.0, 3.0, 1.0])
    both = {"type": "rectangle", "to_world": turned, "bsdf": {"type": "twosided", "front": front, "back": bsdf}}
    alone = {"type": "rectangle", "to_world": seen, "bsdf": bsdf}
    light = {"type": "scene", "camera": CAMERA, "sky": SKY}
    found, wanted = (mean_radiance(eclat.load_dict({**light, "wall": wall}), method) for wall in (both, alone))
    assert wanted.min() > 0.05
    np.testing.assert_allclose(found, wanted, rtol=0.02)


def diffuse(albedo: float) -> dict[str, Any]:
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo}}}


HALF_OPEN = {"type": "mask", "opacity": 0.4, "bsdf": diffuse(0.9)}
BOARD = {"type": "checkerboard", "color0": 0.0, "color1": 1.0, "to_uv": np.diag([8.0, 8.0, 1.0, 1.0])}
OPEN: dict[str, tuple[dict[str, Any], float]] = {
    # Under a sky of 1 a mask of opacity o and albedo ρ has the radiance o ρ + 1 − o, and a blend the mean of its parts.
    "a mask in a blend": (
        {"type": "blendbsdf", "weight": 0.3, "a": HALF_OPEN, "b": diffuse(0.2)},
        0.7 * (0.4 * 0.9 + 0.6) + 0.3 * 0.2,
    ),
    "null in a blend": (
        {"type": "blendbsdf", "weight": 0.3, "a": {"type": "null"}, "b": diffuse(0.2)},
        0.7 + 0.3 * 0.2,
    ),
    "a board of holes": ({"type": "blendbsdf", "weight": BOARD, "a": diffuse(0.2), "b": {"type": "null"}}, 0.6),
    "a mask of a blend of masks": (
        {"type": "mask", "opacity": 0.5, "bsdf": {"type": "blendbsdf", "weight": 0.3, "a": HALF_OPEN, "b": HALF_OPEN}},
        0.5 * (0.4 * 0.9 + 0.6) + 0.5,
    ),
}


@pytest.mark.parametrize("method", list(QUICK))
@pytest.mark.parametrize("kind", list(OPEN))
def test_the_sky_is_seen_through_what_a_part_of_a_blend_leaves_open(kind: str, method: str) -> None:
    bsdf, wanted = OPEN[kind]
    wall = {"type": "rectangle", "to_world": np.diag([3.0, 3.0, 3.0, 1.0]), "bsdf": bsdf}
    scene = eclat.load_dict({"type": "scene", "camera": CAMERA, "sky": SKY, "wall": wall})
    np.testing.assert_allclose(mean_radiance(scene, method), wanted, atol=0.02)


@pytest.mark.parametrize("method", list(QUICK))
def test_a_mask_does_not_thin_what_a_lamp_emits(method: str) -> None:
    # As Mitsuba has it: the whole emission, what the opaque part reflects of a sky of 1, and the sky behind the rest.
    lamp = {"type": "area", "radiance": {"type": "rgb", "value": 0.7}}
    wall = {"type": "rectangle", "to_world": np.diag([3.0, 3.0, 3.0, 1.0]), "bsdf": HALF_OPEN, "emitter": lamp}
    scene = eclat.load_dict({"type": "scene", "camera": CAMERA, "sky": SKY, "wall": wall})
    np.testing.assert_allclose(mean_radiance(scene, method), 0.7 + 0.4 * 0.9 + 0.6, atol=0.03)


@pytest.mark.parametrize("method", list(QUICK))
def test_half_of_the_light_goes_through_principledthin_with_a_diff_trans_of_1(method: str) -> None:
    # White and thin, under a sky of 1 on one side only: half of the diffuse light goes through. The rest of this bsdf, a
    # gloss of at most a twentieth, is reflected.
    sheet = {"type": "rectangle", "to_world": np.diag([3.0, 3.0, 3.0, 1.0])}
    thin = {"type": "principledthin", "base_color": {"type": "rgb", "value": 1.0}, "roughness": 1.0, "diff_trans": 1.0}
    behind = {
        "type": "rectangle",
        "to_world": np.diag([30.0, 30.0, 1.0, 1.0]),
        "emitter": {"type": "area", "radiance": 1.0},
    }
    behind["to_world"][2, 3] = -0.5
    scene = eclat.load_dict({"type": "scene", "camera": CAMERA, "sheet": sheet | {"bsdf": thin}, "lamp": behind})
    assert 0.45 < mean_radiance(scene, method)[1] < 0.5


BOX = """mtllib o.mtl
usemtl m
v -.5 -.5 -.5\nv .5 -.5 -.5\nv .5 .5 -.5\nv -.5 .5 -.5\nv -.5 -.5 .5\nv .5 -.5 .5\nv .5 .5 .5\nv -.5 .5 .5
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
"""


@pytest.mark.parametrize("method", ["path", "irradiance-cache"])
@pytest.mark.parametrize("illum", [4, 6, 7, 9])
@pytest.mark.parametrize("rest", ["Ni 1.00\n", "Ni 1.00\nd 1\n", "Ni 1\nTr 0\nTf 1 1 1\n"])
def test_a_box_whose_material_does_not_indicate_glass_is_opaque(
    tmp_path: Path, illum: int, rest: str, method: str
) -> None:
    (tmp_path / "o.mtl").write_text(f"newmtl m\nillum {illum}\nKd 0.5 0.5 0.5\nKa 0 0 0\n{rest}")
    (tmp_path / "o.obj").write_text(BOX)
    lit = eclat.load_dict(
        {"type": "scene", "camera": CAMERA, "sky": SKY, "box": {"type": "obj", "filename": str(tmp_path / "o.obj")}}
    )
    # A convex body under a sky of radiance 1: E = π.
    np.testing.assert_allclose(mean_radiance(lit, method, (7, 7, 9, 9)), 0.5, atol=0.01)
