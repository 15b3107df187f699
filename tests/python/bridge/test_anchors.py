# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Points that follow the surfaces that they are on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eclat.bridge.anchors import anchors_of
from eclat.scene import Material, Mesh, Scene, grey

CORNERS = np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])
FLOOR = Mesh(CORNERS, np.array([[0, 2, 1], [0, 3, 2]]), Material("diffuse", {"reflectance": grey(0.5)}), name="floor")
SPOTS = np.array([[0.3, 0.0, -0.2], [-0.5, 0, 0.6], [0.9, 0, 0.9], [0.0, 0.5, 0.0]])
UP = np.tile([0.0, 1.0, 0.0], (4, 1))
LENGTHS = np.full(4, 0.05)


def turned(mesh: Mesh, angle: float, shift: tuple[float, float, float]) -> Mesh:
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return replace(mesh, positions=mesh.positions @ turn.T + np.array(shift))


def test_points_stay_where_nothing_moves_and_follow_what_does() -> None:
    scene = Scene((FLOOR,))
    for normals in (UP, -UP):
        anchors = anchors_of(scene, SPOTS, normals, LENGTHS)
        # The last point is in the air.
        assert anchors.meshes.tolist() == [0, 0, 0, -1]
        here = anchors.posed(scene)
        np.testing.assert_allclose(here.positions, SPOTS, atol=1e-7)
        np.testing.assert_allclose(here.normals, normals, atol=1e-12)
        moved = anchors.posed(Scene((turned(FLOOR, 0.5, (1, 2, 3)),)))
        turn = np.array([[np.cos(0.5), -np.sin(0.5), 0], [np.sin(0.5), np.cos(0.5), 0], [0, 0, 1]])
        np.testing.assert_allclose(moved.positions[:3], SPOTS[:3] @ turn.T + [1, 2, 3], atol=1e-7)
        np.testing.assert_allclose(moved.normals[:3], normals[:3] @ turn.T, atol=1e-7)
        np.testing.assert_allclose(moved.positions[3], SPOTS[3])
        # Frames turn with the surface.
        np.testing.assert_allclose(moved.frames[:3], turn @ here.frames[:3], atol=1e-7)
        np.testing.assert_allclose(moved.frames @ moved.frames.swapaxes(1, 2), np.tile(np.eye(3), (4, 1, 1)), atol=1e-7)


def test_a_surface_without_extent_has_no_points() -> None:
    anchors = anchors_of(Scene((FLOOR,)), SPOTS, UP, LENGTHS)
    gone = anchors.posed(Scene((replace(FLOOR, triangles=FLOOR.triangles[:0]),)))
    assert gone.valid.tolist() == [False, False, False, True]


def test_shading_normals_are_those_of_the_side_that_the_point_is_on() -> None:
    bent = np.array([[-0.6, 0.8, 0], [0.6, 0.8, 0], [0.6, 0.8, 0], [-0.6, 0.8, 0]])
    scene = Scene((replace(FLOOR, normals=bent),))
    for side in (1.0, -1.0):
        posed = anchors_of(scene, SPOTS, side * UP, LENGTHS).posed(scene)
        assert (np.einsum("ni,ni->n", posed.shading_normals, posed.normals) > 0).all()
        np.testing.assert_allclose(np.linalg.norm(posed.shading_normals, axis=1), 1)
        assert side * posed.shading_normals[2, 0] > 0.4


def test_points_of_two_scenes_can_be_joined_and_taken() -> None:
    anchors = anchors_of(Scene((FLOOR,)), SPOTS, UP, LENGTHS)
    both = anchors.joined(anchors.taken(np.array([1, 3])))
    assert len(both) == 6
    np.testing.assert_array_equal(
        both.posed(Scene((FLOOR,))).positions[4:], anchors.posed(Scene((FLOOR,))).positions[[1, 3]]
    )
