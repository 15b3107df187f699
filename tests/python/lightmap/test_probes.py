# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What points see, in scenes where one knows."""

from __future__ import annotations

import numpy as np

import eclat
from eclat.lightmap.probes import certainly_dark, inside_or_behind
from eclat.lightmap.solids import solid_triangles
from eclat.scene import DirectionalLight, Environment, Material, PointLight, Scene, grey
from eclat.scenes.geometry import box, mesh


def on_floor(count: int = 24) -> tuple[np.ndarray, np.ndarray]:
    """Points of the Cornell box's floor, and up."""
    x, z = np.meshgrid(np.linspace(-0.97, 0.97, count), np.linspace(-0.97, 0.97, count))
    return np.column_stack((x.ravel(), np.full(x.size, -1.0), z.ravel())), np.tile([0.0, 1, 0], (x.size, 1))


def in_a_box(scene: Scene, points: np.ndarray, margin: float) -> np.ndarray:
    """Whether points of the floor lie under one of the boxes, grown by `margin`: by the planes of their sides."""
    found = np.zeros(len(points), bool)
    for one in scene.meshes[-2:]:
        corners = np.asarray(one.positions)[one.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        upright = np.abs(normals[:, 1]) < 0.5
        distance = ((points[:, None] - corners[upright, 0]) * normals[upright]).sum(axis=2)
        found |= (distance < margin).all(axis=1)
    return found


def test_texels_under_boxes() -> None:
    scene = eclat.load("cornell-box")
    points, normals = on_floor()
    solid = solid_triangles(scene, scene.meshes)
    buried, behind = inside_or_behind(scene, solid, points, normals)
    inside, near = in_a_box(scene, points, -0.01), in_a_box(scene, points, 0.01)
    assert inside.sum() > 20
    assert buried[inside].all() and not buried[~near].any()
    assert not behind[~near].any(), "one-sided walls are seen from their front here"
    middle = (np.abs(points) < 0.99)[:, [0, 2]].all(axis=1) & ~near
    below, behind = inside_or_behind(scene, solid, points[middle] - np.array([0, 0.1, 0]), normals[middle])
    assert behind.all() and not below.any(), "behind a floor, in no solid"


def test_the_outside_of_a_room_sees_nothing() -> None:
    room = mesh([box((-1, -1, -1), (1, 1, 1)).inside_out()], Material(two_sided=True), "room")
    points, normals = np.array([[0, 1.0, 0], [0.9, 1, 0.9], [0, 1, 0]]), np.array([[0, 1.0, 0], [0, 1, 0], [0, -1, 0]])
    scene = Scene((room,))
    assert certainly_dark(scene, points, normals).tolist() == [True, True, False]
    lamp = Scene((room,), (PointLight((4, 1.5, 0), (1, 1, 1)),))
    assert not certainly_dark(lamp, points, normals).any()
    below = Scene((room,), (PointLight((4, 0.5, 0), (1, 1, 1)), DirectionalLight((0, 1, 0), (1, 1, 1))))
    assert certainly_dark(below, points, normals).tolist() == [True, True, False]
    # A sun just below the horizon whose disc rises above it.
    low = np.array([0.9999, 0.001, 0.0])
    for radius, wanted in ((0.0, True), (0.3, False)):
        sun = Scene((room,), (DirectionalLight(tuple(low), (1, 1, 1), radius),))
        assert certainly_dark(sun, points, normals)[0] == wanted
    sky = Scene((room,), environment=Environment(np.ones((1, 1, 3), np.float32)))
    assert not certainly_dark(sky, points, normals).any()


def test_a_small_lamp_that_rays_miss_is_still_seen() -> None:
    room = mesh([box((-1, -1, -1), (1, 1, 1))], Material(), "room")
    for height, wanted in ((6.0, False), (0.5, True)):
        speck = mesh([box((3, height, 0), (3.001, height + 0.001, 0.001))], Material(emission=grey(9)), "lamp")
        assert certainly_dark(Scene((room, speck)), np.array([[0, 1.0, 0]]), np.array([[0, 1.0, 0]]))[0] == wanted
