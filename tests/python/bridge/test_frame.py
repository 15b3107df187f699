# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Where the core's frame has its origin, whatever lies astray, and what is said about what rounds coarsely in it."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

from eclat.bridge.frame import center_of, warn_of_rounding
from eclat.errors import EclatWarning
from eclat.scene import Material, Mesh, Scene
from eclat.scenes import build
from support.similarity import Similarity

UTM = np.array([500_000.0, 4_649_776.0, 120.0])


def room(at: np.ndarray) -> Scene:
    return Similarity(shift=at).scene(build("cornell-box"))


def triangle(at: np.ndarray, size: float = 1.0, name: str = "stray") -> Mesh:
    corners = at + size * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    return Mesh(corners, np.array([[0, 1, 2]], np.uint32), Material(), name=name)


def with_mesh(scene: Scene, mesh: Mesh) -> Scene:
    return replace(scene, meshes=(*scene.meshes, mesh))


def test_a_stray_part_does_not_move_the_frame_out_of_the_room() -> None:
    scene = with_mesh(room(UTM), triangle(np.zeros(3)))
    corners = np.concatenate([np.asarray(m.positions) for m in scene.meshes[:-1]])
    center = center_of(scene)
    assert (center >= corners.min(axis=0)).all() and (center <= corners.max(axis=0)).all()


def test_a_huge_ground_does_not_change_the_frame() -> None:
    ground = triangle(np.array([-5e4, -1.0, -5e4]), size=2e5, name="ground")
    center = center_of(with_mesh(room(np.array([3000.0, 0, 2000.0])), ground))
    np.testing.assert_allclose(center, [3000, 0, 2000], atol=2)


def test_a_scene_near_the_origin_is_not_shifted_for_a_stray_part() -> None:
    assert not center_of(with_mesh(room(np.array([1.0, 2, 3])), triangle(np.array([1e6, 0, 0])))).any()


def test_rooms_a_kilometre_apart_need_no_shift_and_no_warning() -> None:
    here, there = room(np.zeros(3)), room(np.array([1000.0, 0, 0]))
    scene = replace(here, meshes=(*here.meshes, *there.meshes))
    assert not center_of(scene).any()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_rounding(scene, center_of(scene))


def test_meshes_that_are_rounded_coarsely_are_named() -> None:
    scene = with_mesh(room(UTM), triangle(np.zeros(3)))
    expected = r"mesh \d+ 'stray': 1 of 1 triangles .* multiples of 0.5 m; the first is at \(0.333333, 0.333333, 0\)"
    with pytest.warns(EclatWarning, match=expected):
        warn_of_rounding(scene, center_of(scene))


def test_triangles_that_are_large_but_far_away_are_not_warned_about() -> None:
    scene = with_mesh(room(UTM), triangle(np.zeros(3), size=1000.0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_rounding(scene, center_of(scene))


@pytest.mark.parametrize(
    "mesh", [triangle(np.zeros(3), size=0.0), Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.uint32), Material())]
)
def test_scenes_of_nothing_have_a_frame(mesh: Mesh) -> None:
    scene = Scene(meshes=(mesh,))
    assert not center_of(scene).any()
    warn_of_rounding(scene, np.zeros(3))
