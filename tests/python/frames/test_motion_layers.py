# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Motion vectors and object ids against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat.frames.motion_layers import Moment, motion_layers, pixel_rays
from eclat.scene import Camera, Mesh, Scene, look_at

SIZE = (40, 20)


def square(z: float, side: float, name: str) -> Mesh:
    half = side / 2
    corners = np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])
    return Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), eclat.load("furnace").meshes[0].material, name=name)


def camera(origin: tuple[float, float, float] = (0.0, 0.0, 5.0), **changes: object) -> Camera:
    """A camera that looks along −z. At the distance 5 its picture is 10 m high, so that a pixel is 0.5 m."""
    placed = Camera(look_at(origin, (origin[0], origin[1], origin[2] - 1)), 90.0)
    return replace(placed, **changes)  # type: ignore[arg-type]


def shifted(mesh: Mesh, x: float, y: float, z: float) -> Mesh:
    return replace(mesh, positions=mesh.positions + np.array([x, y, z]))


WALL, CARD = square(0, 8, "wall"), square(1, 2, "card")


def test_ids_are_those_of_the_first_surfaces() -> None:
    now = Moment(Scene((WALL, CARD)), camera())
    ids = motion_layers(now, now, now, SIZE, 1)["object_id"]
    assert ids[10, 20] == 2  # the card in the middle
    assert ids[10, 13] == 1  # the wall, 3.25 m to the left of the middle
    assert ids[10, 1] == 0  # nothing, 9.25 m to the left
    assert np.isin(ids, (0, 1, 2)).all()


def test_an_object_moves() -> None:
    """The card at the distance 4 moves by 0.8 m to the right and 0.4 m up: a pixel is 0.4 m there."""
    now = Moment(Scene((WALL, CARD)), camera())
    after = Moment(Scene((WALL, shifted(CARD, 0.8, 0.4, 0))), camera())
    before = Moment(Scene((WALL, shifted(CARD, -0.4, 0, 0))), camera())
    layers = motion_layers(now, before, after, SIZE, 1)
    card = layers["object_id"] == 2
    np.testing.assert_allclose(layers["motion_next"][card, :2], np.full((card.sum(), 2), (2, -1)), atol=1e-4)
    np.testing.assert_allclose(layers["motion_previous"][card, :2], np.full((card.sum(), 2), (-1, 0)), atol=1e-4)
    assert not layers["motion_next"][~card].any()
    # What nearly faces the camera comes 1 m nearer.
    nearer = motion_layers(now, now, Moment(Scene((WALL, shifted(CARD, 0, 0, 1))), camera()), SIZE, 1)
    assert nearer["motion_next"][10, 20, 2] == pytest.approx(-1, abs=0.02)


def test_the_camera_moves() -> None:
    """A camera that moves by 0.5 m to the right sees the wall at the distance 5 go a pixel to the left."""
    now = Moment(Scene((WALL,)), camera())
    layers = motion_layers(now, now, Moment(Scene((WALL,)), camera((0.5, 0, 5))), SIZE, 1)
    wall = layers["object_id"] == 1
    np.testing.assert_allclose(layers["motion_next"][wall, :2], np.full((wall.sum(), 2), (-1, 0)), atol=1e-4)
    # What is infinitely far does not move with a shift, but with a turn.
    assert not layers["motion_next"][~wall].any()
    angle = math.radians(2)
    turn = np.array([[math.cos(angle), 0, math.sin(angle), 0], [0, 1, 0, 0], [-math.sin(angle), 0, math.cos(angle), 0]])
    matrix = camera().to_world @ np.vstack([turn, [0, 0, 0, 1]])
    turned = Moment(Scene((WALL,)), replace(camera(), to_world=matrix))
    far = motion_layers(now, now, turned, (41, 21), 1)["motion_next"]
    # Column 1 lies at the tangent −39/20.5 · 20.5/10.5 / 2 … of the picture's half height; computed from its angle:
    column, half = 1, 10.5
    tangent = (column + 0.5 - 20.5) / half
    after = math.tan(math.atan(tangent) + angle) * half
    assert far[10, column, 0] == pytest.approx(after - tangent * half, abs=1e-3)


def test_rays_are_those_of_the_core() -> None:
    """A shifted, orthographic or narrow camera sees the same pixels of a card as the core renders."""
    scene = Scene((CARD,), (), eclat.load("furnace").environment)
    for changes in ({"shift": (0.1, -0.2)}, {"projection": "orthographic", "fov": 6.0}, {"fov": 30.0, "fov_axis": "x"}):
        view = camera(**changes)  # type: ignore[arg-type]
        now = Moment(scene, view)
        ids = motion_layers(now, now, now, SIZE, 1)["object_id"]
        depth = eclat.render(replace(scene, cameras=(view,)), "path", samples=16, size=SIZE, max_depth=1).layers[
            "depth"
        ]
        inside = np.isfinite(depth)
        assert 0 < inside.sum() < inside.size
        # Pixels at the rim are partly covered.
        assert (inside != (ids == 1)).sum() <= 0.15 * inside.size
    origins, directions = pixel_rays(camera(), SIZE)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1)
    assert origins.shape == (800, 3)


def test_what_comes_from_behind_has_no_motion() -> None:
    now = Moment(Scene((CARD,)), camera())
    behind = Moment(Scene((shifted(CARD, 0, 0, 20),)), camera())
    assert not motion_layers(now, behind, behind, SIZE, 1)["motion_next"][10, 20].any()
