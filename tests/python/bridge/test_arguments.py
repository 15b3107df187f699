# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Arguments of the verbs: what is accepted, what it becomes, what is said about the rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from eclat.bridge import arguments
from eclat.errors import EclatError
from eclat.scene import Camera, Scene


def test_sizes_come_from_the_camera_unless_asked_for() -> None:
    camera = Camera(np.eye(4), size=(30, 20))
    assert arguments.picture_size(camera, None) == (30, 20)
    assert arguments.picture_size(camera, (5, 6)) == (5, 6)
    assert arguments.picture_size(Camera(np.eye(4)), None) == arguments.DEFAULT_SIZE


def test_a_camera_may_be_an_object_or_an_index() -> None:
    first, other = Camera(np.eye(4)), Camera(np.eye(4))
    scene = Scene(cameras=(first,), name="hall")
    assert arguments.chosen_camera(scene, 0) is first
    assert arguments.chosen_camera(scene, other) is other
    for number in (-1, 1):
        with pytest.raises(EclatError, match=f"below 1, the number of cameras of hall, got {number}"):
            arguments.chosen_camera(scene, number)


def test_normals_become_unit_and_single_points_rows() -> None:
    points, normals = arguments.points_with_normals(np.array([1.0, 2, 3]), np.array([0.0, 3, 4]))
    np.testing.assert_array_equal(points, [[1, 2, 3]])
    np.testing.assert_allclose(normals, [[0, 0.6, 0.8]])
    empty, _ = arguments.points_with_normals(np.zeros((0, 3)), np.zeros((0, 3)))
    assert empty.shape == (0, 3)


@pytest.mark.parametrize(
    ("points", "normals", "message"),
    [
        ([[0, 0, 0]], [[0, 0, 1], [0, 0, 1]], r"must both be \(N, 3\), got \(1, 3\) and \(2, 3\)"),
        ([[0, 0]], [[0, 1]], r"must both be \(N, 3\)"),
        (
            [[0, 0, 0], [0, np.nan, 0]],
            [[0, 0, 1]] * 2,
            r"got the point \[0.0, nan, 0.0\] with the normal \[0.0, 0.0, 1.0\] at index 1",
        ),
        ([[0, 0, 0]], [[0, 0, 0]], "normals must not be zero"),
        ([[0, 0, 0]], [[0, np.inf, 0]], "must be finite"),
    ],
)
def test_bad_points(points: Any, normals: Any, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        arguments.points_with_normals(np.array(points), np.array(normals))


def test_limits_of_numbers() -> None:
    assert arguments.checked_seed(2**32 - 1) == 2**32 - 1
    assert (arguments.thread_count(None), arguments.thread_count(3)) == (0, 3)
    assert (arguments.checked_max_depth(-1), arguments.checked_max_depth(1)) == (-1, 1)
    assert arguments.checked_time(None) is None
    for check, bad in (
        (arguments.checked_seed, 2**32),
        (arguments.thread_count, 1025),
        (arguments.checked_samples, 2**24 + 1),
        (arguments.checked_max_depth, -2),
        (arguments.checked_time, float("inf")),
    ):
        with pytest.raises(EclatError, match="must be"):
            check(bad)  # type: ignore[operator]
