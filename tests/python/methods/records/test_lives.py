# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Lives of records: bounded changes, symmetry in time, jitter, and no gathers while nothing happens."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from eclat.methods.records.lives import (
    SHORT,
    STRAIGHT,
    around,
    coming_back,
    first_keys,
    lives_of,
    plan_lives,
    without_gaps,
)

PHASES = np.random.default_rng(1).random(40)


def planned(
    light: np.ndarray, longest: int, tolerance: float, course: Any = None, used: np.ndarray | None = None
) -> np.ndarray:
    """Plan the lives of records whose light (N, S) over time is known; unless `used` says otherwise, they are always used."""
    count = light.shape[1]
    returns = coming_back(np.arange(count)[:, None] if course is None else course)

    def changes(which: Any, first: Any, last: Any) -> Any:
        return np.abs(light[which, last] - light[which, first]) / np.maximum(light[which, last], light[which, first])

    def bends(which: Any, first: Any, middle: Any, last: Any) -> Any:
        share = (middle - first) / (last - first)
        line = light[which, first] * (1 - share) + light[which, last] * share
        return np.abs(light[which, middle] - line) / light[which, middle]

    used = np.ones(light.shape, np.bool_) if used is None else used
    return plan_lives(np.arange(count), longest, PHASES[: len(light)], tolerance, changes, bends, returns, used)


def interpolated(light: np.ndarray, keyed: np.ndarray) -> np.ndarray:
    out = np.empty_like(light)
    rows = np.arange(len(light))
    for time in range(light.shape[1]):
        before, after = around(keyed, time)
        share = (time - before) / np.maximum(after - before, 1)
        out[:, time] = light[rows, before] * (1 - share) + light[rows, after] * share
    return out


@pytest.mark.parametrize("count", [1, 2, 3, 24, 61])
@pytest.mark.parametrize("longest", [1, 5, 24])
def test_time_reversed_has_the_same_lives(count: int, longest: int) -> None:
    light = 1 + np.random.default_rng(2).random((40, count)).cumsum(axis=1)
    forward = planned(light, longest, 0.3)
    backward = planned(light[:, ::-1].copy(), longest, 0.3)
    np.testing.assert_array_equal(forward, backward[:, ::-1])
    records, first, last = lives_of(forward)
    assert (last - first <= longest).all()
    assert set(records) == set(range(40))


@pytest.mark.parametrize("rate", [0.001, 0.02, 0.1, 0.5])
def test_the_error_between_keys_is_below_the_tolerance_and_faster_changes_take_more_keys(rate: float) -> None:
    light = np.exp(rate * np.arange(60) * np.ones((10, 1)))
    keyed = planned(light, 24, 0.2)
    error = np.abs(interpolated(light, keyed) / light - 1).max()
    # Lives within the tolerance are bounded by it; the halves of straight ones by a quarter of their bend.
    assert error < 0.2 * max(1, STRAIGHT / 4)
    slower = planned(np.exp(rate / 2 * np.arange(60) * np.ones((10, 1))), 24, 0.2)
    assert slower.sum() <= keyed.sum()
    assert keyed.sum(axis=1).max() == 60 if rate == 0.5 else keyed.sum(axis=1).max() < 60


def test_light_that_changes_along_a_line_takes_few_keys() -> None:
    line = 40 + np.arange(61.0) * np.ones((10, 1))
    keyed = planned(line, 24, 0.05)
    # Every second life at most is shorter than half of the longest that is tested for being straight.
    assert keyed.sum(axis=1).max() <= 2 * 61 / (SHORT * 24 / 2)
    np.testing.assert_allclose(interpolated(line, keyed), line, rtol=1e-12)


@pytest.mark.parametrize("period", [4, 8, 12, 24])
def test_what_comes_back_within_a_life_is_not_missed(period: int) -> None:
    wave = np.sin(2 * np.pi * np.arange(97) / period)
    light = 2 + wave * np.ones((20, 1))
    keyed = planned(light, 24, 0.1, wave[:, None])
    assert np.abs(interpolated(light, keyed) / light - 1).max() < 0.15
    # Without knowing the course, both ends of lives of whole periods look alike.
    blind = planned(light, 24, 0.1)
    assert np.abs(interpolated(light, blind) / light - 1).max() > 0.3


def test_nothing_is_asked_while_the_scene_stays_as_it_is() -> None:
    light = np.ones((10, 30))
    asked = []

    def changes(which: Any, first: Any, last: Any) -> Any:
        asked.extend(zip(first.tolist(), last.tolist(), strict=True))
        return np.ones(len(which))

    worlds = np.repeat([0, 1], [20, 10])
    keyed = plan_lives(
        worlds, 8, PHASES[:10], 0.1, changes, lambda *_: np.ones(len(_[0])), coming_back(worlds[:, None]),
        np.ones(light.shape, np.bool_),
    )  # fmt: skip
    assert asked
    assert all(first < 20 <= last for first, last in asked)
    # The moment of the change is found.
    assert keyed[:, 19].all()
    assert keyed[:, 20].all()
    assert (interpolated(np.where(worlds == 0, 1.0, 2.0) * light, keyed) == np.where(worlds == 0, 1.0, 2.0)).all()


def test_records_have_keys_while_they_are_used_alone() -> None:
    rng = np.random.default_rng(4)
    light = np.exp(0.5 * rng.random((40, 61)).cumsum(axis=1))
    used = without_gaps(rng.random((40, 61)) < 0.1, 3)
    used[0] = False
    keyed = planned(light, 24, 0.1, used=used)
    assert not keyed[~used].any()
    # Light that changes so fast needs keys at nearly all times at which it is used, and none is left out at the ends.
    assert keyed.sum() > 0.95 * used.sum()
    before, after = np.pad(used, ((0, 0), (1, 0)))[:, :-1], np.pad(used, ((0, 0), (0, 1)))[:, 1:]
    assert keyed[used & ~(before & after)].all()
    backward = planned(light[:, ::-1].copy(), 24, 0.1, used=used[:, ::-1])
    np.testing.assert_array_equal(keyed, backward[:, ::-1])


def test_short_gaps_are_closed_and_nothing_else() -> None:
    used = np.array([[0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0]], np.bool_)
    np.testing.assert_array_equal(without_gaps(used, 1), used)
    np.testing.assert_array_equal(without_gaps(used, 2), [[0, 1, 1, 1, 1, 0, 0, 0, 1, 0, 0]])
    np.testing.assert_array_equal(without_gaps(used, 3), [[0, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0]])
    assert not without_gaps(np.zeros((2, 5), np.bool_), 100).any()


def test_lives_of_different_records_do_not_end_together() -> None:
    phases = np.random.default_rng(3).random(2000)
    keyed = first_keys(121, 24, phases)
    inner = keyed[:, 1:-1].mean(axis=0)
    assert inner.max() < 4 / 24
    assert (np.diff(lives_of(keyed)[1:], axis=0) <= 24).all()
