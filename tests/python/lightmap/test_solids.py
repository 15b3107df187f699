# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What is a solid: closed, facing outwards, and nobody inside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eclat.lightmap.solids import solid_triangles
from eclat.scene import Camera, Material, Mesh, PointLight, Scene, look_at
from eclat.scenes.geometry import Solid, box, icosphere, mesh

ONE, TWO = Material(two_sided=False), Material(two_sided=True)
CUBE = box((-1, -1, -1), (1, 1, 1))


def without_bottom(solid: Solid) -> Solid:
    low = (np.asarray(solid.positions)[solid.triangles][:, :, 1] < -0.99).all(axis=1)
    return Solid(solid.positions, solid.triangles[~low])


def without_a_triangle(solid: Solid) -> Solid:
    return Solid(solid.positions, solid.triangles[1:])


@pytest.mark.parametrize(
    ("solid", "one_sided", "two_sided"),
    [
        (CUBE, True, True),
        (icosphere(1), True, True),
        (CUBE.inside_out(), False, False),
        (without_bottom(CUBE), True, False),
        (without_bottom(CUBE).inside_out(), False, False),
        (without_bottom(icosphere(2)), True, True),  # nothing of it is as low as that: it is whole
        (Solid(CUBE.positions, CUBE.triangles[:2]), False, False),
    ],
    ids=["cube", "sphere", "room", "without bottom", "room without floor", "ball", "panel"],
)
def test_one_piece(solid: Solid, one_sided: bool, two_sided: bool) -> None:
    for material, wanted in ((ONE, one_sided), (TWO, two_sided)):
        one = mesh([solid], material, "it")
        (found,) = solid_triangles(Scene((one,)), (one,))
        assert found.tolist() == [wanted] * len(solid.triangles)


def test_pieces_of_a_mesh_are_told_apart() -> None:
    both = mesh([CUBE, without_bottom(CUBE).moved(x=5)], TWO, "two")
    (found,) = solid_triangles(Scene((both,)), (both,))
    assert found.tolist() == [True] * 12 + [False] * 10


def test_vertices_need_not_be_shared() -> None:
    """Files have a vertex for each face that meets there."""
    loose = Mesh(CUBE.positions[CUBE.triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3), TWO)
    (found,) = solid_triangles(Scene((loose,)), (loose,))
    assert found.all()


def test_duplicate_or_reversed_triangles_do_not_bound_a_solid() -> None:
    for triangles in (
        np.concatenate((CUBE.triangles, CUBE.triangles[:1])),
        np.concatenate((CUBE.triangles[:1, ::-1], CUBE.triangles[1:])),
    ):
        one = Mesh(CUBE.positions, triangles, ONE)
        (found,) = solid_triangles(Scene((one,)), (one,))
        assert not found.any()


def test_two_sided_boxes_with_someone_inside_are_rooms() -> None:
    room = mesh([CUBE], TWO, "room")
    chair = mesh([CUBE], TWO, "chair")
    chair = replace(chair, positions=0.1 * np.asarray(chair.positions))
    inside, outside = look_at((0.5, 0, 0), (0, 0, 0)), look_at((5, 0, 0), (0, 0, 0))
    for scene, wanted in (
        (Scene((room, chair)), False),
        (Scene((room,), cameras=(Camera(inside),)), False),
        (Scene((room,), cameras=(Camera(outside),)), True),
        (Scene((room,), (PointLight((0, 0.5, 0), (1, 1, 1)),)), False),
    ):
        assert solid_triangles(scene, scene.meshes)[0].all() == wanted
    assert solid_triangles(Scene((replace(room, material=ONE), chair)), (replace(room, material=ONE), chair))[0].all()
