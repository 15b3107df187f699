# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records between their keys, and records that turn with their surfaces."""

from __future__ import annotations

import numpy as np
import pytest

from eclat import _core
from eclat.bridge.anchors import Posed
from eclat.methods.records.tracks import COLUMNS, blended, in_core_space, in_surface_space

FLOATS = _core.SolvedCaches().near.shape[1]


def rows(count: int, seed: int) -> np.ndarray:
    out = np.random.default_rng(seed).random((count, FLOATS)).astype(np.float32)
    out[:, COLUMNS["elongations"]] += 1
    out[:, COLUMNS["enclosed"]] = 0
    return out


def poses(count: int, seed: int) -> Posed:
    frames = np.linalg.qr(np.random.default_rng(seed).normal(size=(count, 3, 3)))[0]
    frames *= np.sign(np.linalg.det(frames))[:, None, None]
    return Posed(np.zeros((count, 3)), frames[:, :, 2], frames[:, :, 2], frames)


def test_a_record_at_a_key_is_what_was_gathered_there() -> None:
    a, b = rows(5, 0), rows(5, 1)
    for share, there in ((np.zeros(5), a), (np.ones(5), b)):
        found = blended(a, b, share)
        for name in ("irradiance", "excess", "rotation_gradients", "distances", "noises"):
            np.testing.assert_allclose(found[:, COLUMNS[name]], there[:, COLUMNS[name]], rtol=1e-6)
        np.testing.assert_allclose(found[:, COLUMNS["elongations"]], there[:, COLUMNS["elongations"]], rtol=1e-5)
    np.testing.assert_array_equal(blended(a, a, np.full(5, 0.3)), a)


def test_between_keys_light_is_on_the_line_and_whatever_was_in_the_way_counts() -> None:
    a, b = rows(5, 0), rows(5, 1)
    b[2, COLUMNS["enclosed"]] = 1
    found = blended(a, b, np.full(5, 0.25))
    light = COLUMNS["irradiance"]
    np.testing.assert_allclose(found[:, light], 0.75 * a[:, light] + 0.25 * b[:, light], rtol=1e-6)
    clear = COLUMNS["clearances"]
    np.testing.assert_array_equal(found[:, clear], np.minimum(a[:, clear], b[:, clear]))
    assert found[:, COLUMNS["enclosed"]].ravel().tolist() == [0, 0, 1, 0, 0]


def test_lengths_that_are_infinite_at_one_key_are_those_of_the_other() -> None:
    a, b = rows(3, 0), rows(3, 1)
    a[0, COLUMNS["distances"]] = np.inf
    a[1, COLUMNS["distances"]] = b[1, COLUMNS["distances"]] = np.inf
    found = blended(a, b, np.full(3, 0.5))[:, COLUMNS["distances"].start]
    assert found[0] == b[0, COLUMNS["distances"].start]
    assert found[1] == np.inf
    assert np.isfinite(found[2])


def test_where_a_surface_has_no_extent_at_one_key_the_other_counts() -> None:
    a, b = rows(3, 0), rows(3, 1)
    gone = a.copy()
    gone[1] = np.nan
    np.testing.assert_array_equal(blended(gone, b, np.full(3, 0.5))[1], b[1])
    np.testing.assert_array_equal(blended(a, gone, np.full(3, 0.5))[1], a[1])
    assert np.isnan(blended(gone, gone, np.full(3, 0.5))[1, COLUMNS["irradiance"]]).all()


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.5, 3.0])
def test_an_ellipse_between_two_of_the_same_shape_lies_between_them(angle: float) -> None:
    a, b = rows(1, 0), rows(1, 0)
    for of, axis in ((a, 0.0), (b, angle)):
        of[0, COLUMNS["elongations"]] = 2
        of[0, COLUMNS["axes"]] = axis
    found = blended(a, b, np.array([0.5]))[0]
    # Axes that differ by half a turn are the same.
    middle = (angle if angle < np.pi / 2 else angle - np.pi) / 2
    assert np.sin(found[COLUMNS["axes"].start] - middle) == pytest.approx(0, abs=1e-6)
    assert 1 <= found[COLUMNS["elongations"].start] <= 2 + 1e-6


def test_gradients_turn_with_moving_surfaces_and_stay_the_same_bits_on_others() -> None:
    moving = np.array([True, False, True])
    before, after = poses(3, 5), poses(3, 6)
    given = rows(3, 2)
    kept = in_surface_space(given, before, moving)
    back = in_core_space(kept, before, moving, given[:, COLUMNS["positions"]])
    there = in_core_space(kept, after, moving, given[:, COLUMNS["positions"]])
    turn = after.frames @ before.frames.swapaxes(1, 2)
    for name in ("rotation_gradients", "translation_gradients"):
        columns = COLUMNS[name]
        np.testing.assert_allclose(back[:, columns], given[:, columns], rtol=1e-5, atol=1e-6)
        np.testing.assert_array_equal(there[1, columns], given[1, columns])
        turned = np.einsum("nij,ncj->nci", turn, given[:, columns].reshape(-1, 3, 3)).reshape(3, 9)
        np.testing.assert_allclose(there[[0, 2]][:, columns], turned[[0, 2]], rtol=1e-5, atol=1e-6)
    # What depends on the direction around the normal is as careful as its least value.
    clear = COLUMNS["clearances"]
    assert (kept[0, clear] == given[0, clear].min()).all()
    np.testing.assert_array_equal(kept[1, clear], given[1, clear])
    assert kept[0, COLUMNS["elongations"].start] == 1
