# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Which records of an animation are worth their gathers: those that a camera sees, directly or in mirrors, and far records on
surfaces that do not turn like wheels."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import eclat
from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.methods.records import use
from eclat.methods.records.laws import core_options
from eclat.methods.records.lives import alive
from eclat.methods.records.moving import MovingSolution, solve_over_time
from eclat.methods.records.radiance_rows import RECORD
from eclat.methods.records.tracks import COLUMNS
from eclat.methods.work import Work
from eclat.scene import Camera, Material, Mesh, Scene, grey
from support.over_time import BALL, rolling, times_of

METHOD = eclat.IrradianceCache(max_error=0.1, least_pixels=1, far_records=100, far_rows=3, rows=8)
COUNT = 31


@pytest.fixture(scope="module")
def ball() -> MovingSolution:
    """The ball turns by 2.1 times on its way, and by 25° from each time to the next, so that gaps in use are short."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(use, "LONGEST_GAP", 1)
        return solve_over_time(METHOD, times_of(rolling(COUNT), COUNT), Work(threads=2))


def test_records_on_the_far_side_of_a_ball_have_no_keys(ball: MovingSolution) -> None:
    on_ball = ball.near.moving
    assert on_ball.sum() > 10
    towards = []
    for time in range(COUNT):
        posed = ball.near.anchors.taken(on_ball).posed(ball.times.scene(time))
        view = np.asarray(ball.times.cameras[time].to_world)[:3, 3] - posed.positions
        towards.append(np.einsum("ni,ni->n", view, posed.normals) / np.linalg.norm(view, axis=1))
    seen = np.array(towards).T > 0
    keyed = ball.near.keyed[on_ball]
    living = np.zeros(keyed.shape, np.bool_)
    for time in range(COUNT):
        living[alive(keyed, time), time] = True
    born = ball.near.born[on_ball]
    wide = born[:, COLUMNS["radii"]] > 1.5 * born[:, COLUMNS["least_radii"]]
    # Records as small as pixels are passed over now and then, and the ball begins and ends half out of the picture.
    middle = np.abs(np.arange(COUNT) - COUNT // 2) < COUNT // 4
    assert living[wide & middle & (np.array(towards).T > 0.5)].mean() > 0.8
    # A record is read a little beyond the rim of the ball, in the times beside those, and in short gaps.
    reach = 3
    near_to_seen = np.array([np.convolve(row, np.ones(2 * reach + 1), "same") > 0 for row in seen])
    assert not keyed[~near_to_seen].any()
    assert (~near_to_seen).sum() > 20


def test_records_of_a_camera_at_rest_are_kept_where_nothing_moves(ball: MovingSolution) -> None:
    assert ball.near.keyed[~ball.near.moving][:, [0, -1]].all()
    assert ball.far.keyed[:, [0, -1]].all()


def test_wheels_have_no_far_records_and_slower_surfaces_have_some(ball: MovingSolution) -> None:
    # On the ball there are some where its axis ends, but nowhere else.
    posed = ball.far.anchors.taken(ball.far.moving).posed(ball.times.scene(0))
    assert (np.abs(posed.normals[:, 2]) > 0.95).all()
    slower = solve_over_time(METHOD, times_of(rolling(20 * COUNT), 3), Work(threads=2))
    assert slower.far.anchors.meshes[slower.far.moving].tolist().count(BALL) > 3


def test_records_seen_in_a_mirror_are_in_use() -> None:
    """A camera looks up at a mirror above a floor, of which it sees nothing but its image."""

    def square(side: float, height: float, name: str, material: Material) -> Mesh:
        corners = side * np.array([[-1.0, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]]) + [0, height, 0]
        return Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), material, name=name)

    white, mirror = (
        Material("diffuse", {"reflectance": grey(0.5)}),
        Material("conductor", {"specular_reflectance": grey(1), "eta": grey(0), "k": grey(1), "alpha_u": grey(0)}),
    )
    floor = square(4, 0, "floor", white)
    lamp = eclat.load("furnace").lights
    camera = Camera(np.array([[1.0, 0, 0, 0], [0, 0, -1, 1], [0, 1, 0, 0], [0, 0, 0, 1]]), fov=60.0)
    for material, expected in ((mirror, True), (white, False)):
        scene = Scene((floor, square(4, 2, "ceiling", material)), lights=lamp, cameras=(camera,))
        prepared = compiled(scene)
        rows = np.zeros((1, RECORD), np.float32)
        rows[0, COLUMNS["positions"]] = prepared.to_core(np.array([[0.0, 0, 0]]))
        rows[0, COLUMNS["normals"]] = [0, 1, 0]
        for name, value in {
            "radii": 0.5,
            "distances": 0.5,
            "elongations": 1,
            "clearances": 10,
            "largest_radii": 1,
        }.items():
            rows[0, COLUMNS[name]] = value
        given: Any = (core_options(METHOD), _core.Progress())
        used = _core.records_in_use(prepared.core, prepared.camera(camera, (32, 32)), rows, *given)
        assert used.tolist() == [float(expected)]
