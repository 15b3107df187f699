# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Values between keys: numbers computed by hand from the formulas of the glTF specification."""

from __future__ import annotations

import math

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat.motion.tracks import Track, quaternion_of, rotation_matrix, slerp, smooth_track


def turn(degrees: float, axis: int = 1) -> np.ndarray:
    """The quaternion of a turn around an axis."""
    half = math.radians(degrees) / 2
    quaternion = np.zeros(4)
    quaternion[axis], quaternion[3] = math.sin(half), math.cos(half)
    return quaternion


def test_linear_and_step() -> None:
    times, values = np.array([1.0, 2.0, 4.0]), np.array([[0.0], [10.0], [20.0]])
    linear, step = Track(times, values), Track(times, values, "step")
    assert [linear.at(t)[0] for t in (0, 1, 1.25, 2, 3, 4, 9)] == [0, 0, 2.5, 10, 15, 20, 20]
    assert [step.at(t)[0] for t in (0, 1, 1.999, 2, 3.9, 4, 9)] == [0, 0, 0, 10, 10, 20, 20]


def test_cubic_by_hand() -> None:
    """Between v 1 and 3 with the out-tangent 2 and the in-tangent −1 per second over 4 seconds, at a quarter:

    (2/64 − 3/16 + 1)·1 + 4·(1/64 − 2/16 + 1/4)·2 + (−2/64 + 3/16)·3 + 4·(1/64 − 1/16)·(−1) = 2.625.
    """
    keys = np.array([[[7.0], [1.0], [2.0]], [[-1.0], [3.0], [9.0]]])
    track = Track(np.array([0.0, 4.0]), keys, "cubic")
    assert track.at(1.0)[0] == pytest.approx(0.84375 + 1.125 + 0.46875 + 0.1875, abs=1e-12)
    assert track.at(-1.0)[0] == 1
    assert track.at(5.0)[0] == 3


def test_a_cubic_rotation_is_a_unit_quaternion() -> None:
    zero = np.zeros(4)
    track = Track(
        np.array([0.0, 1.0]), np.array([[zero, turn(0), zero], [zero, turn(90), zero]]), "cubic", rotation=True
    )
    np.testing.assert_allclose(track.at(0.5), turn(45), atol=1e-12)
    assert np.linalg.norm(track.at(0.3)) == pytest.approx(1)


@pytest.mark.parametrize("sign", [1, -1])
def test_rotations_take_the_shorter_arc_at_constant_speed(sign: int) -> None:
    """q and −q are the same rotation, so that the sign of a key must not matter."""
    track = Track(np.array([0.0, 1.0]), np.array([turn(0), sign * turn(120)]), rotation=True)
    for share in (0.1, 0.25, 0.5, 0.9):
        np.testing.assert_allclose(
            rotation_matrix(track.at(share)), rotation_matrix(turn(120 * share)), atol=1e-12, err_msg=str(share)
        )


def test_rotations_that_hardly_differ() -> None:
    np.testing.assert_allclose(slerp(turn(10), turn(10), 0.5), turn(10), atol=1e-15)
    np.testing.assert_allclose(slerp(turn(10), turn(10.001), 0.5), turn(10.0005), atol=1e-12)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 179.0, 180.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_rotation_as_a_quaternion_and_back(degrees: float, axis: int) -> None:
    matrix = rotation_matrix(turn(degrees, axis))
    np.testing.assert_allclose(rotation_matrix(quaternion_of(matrix)), matrix, atol=1e-12)


def test_a_smooth_track_meets_a_parabola() -> None:
    """The tangents are those of the parabola through three keys, and a cubic through them is the parabola itself."""
    times = np.array([0.0, 1.0, 3.0, 4.0])
    track = smooth_track(times, (times**2)[:, None])
    assert track.at(2.0)[0] == pytest.approx(4.0, abs=1e-12)


@pytest.mark.parametrize(
    ("times", "values", "words"),
    [
        ([], np.zeros((0, 1)), "at least one key"),
        ([0, 1], [[1.0]], "expected 2 values"),
        ([0, math.nan], [[1.0], [2.0]], "finite times"),
        ([0, 1], [[1.0], [math.inf]], "finite values"),
        ([0, 2, 1], [[1.0], [2.0], [3.0]], "times that increase, got 2 s at key 1 and 1 s"),
        ([0, 0], [[1.0], [2.0]], "times that increase"),
    ],
)
def test_bad_keys_are_named(times: list[float], values: list[list[float]], words: str) -> None:
    with pytest.raises(EclatError, match=words):
        Track(np.array(times, float), np.array(values))


def test_a_quaternion_of_zero_is_refused() -> None:
    with pytest.raises(EclatError, match="quaternions"):
        Track(np.array([0.0]), np.zeros((1, 4)), rotation=True)


def test_what_moves() -> None:
    times = np.array([0.0, 1.0])
    assert not Track(times, np.array([[3.0], [3.0]])).moves
    assert Track(times, np.array([[3.0], [4.0]])).moves
    flat = np.array([[[0.0], [3.0], [0.0]], [[0.0], [3.0], [0.0]]])
    assert not Track(times, flat, "cubic").moves
    flat[0, 2] = 1
    assert Track(times, flat, "cubic").moves
