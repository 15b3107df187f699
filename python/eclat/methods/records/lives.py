# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The life spans of records over time [Gautron07].

A record is gathered at some times, its keys, and its light between two keys is interpolated. A life, the time between two
keys, ends as soon as the two gathers predict too large a change. All choices are symmetric in time: an animation that
is played backwards has the same keys.

Symbol   name here    meaning                                                                      unit
  S      count        number of times                                                              1
  a, b   first, last  the times at the ends of a life, as indices                                  1
  T      longest      upper bound of b − a                                                         1
  φ      phases       distance of the first keys from the middle, in units of T / 2, for each record   1
  L_i    —            radiance that cell i of a gather saw                                         W·m⁻²·sr⁻¹
  c      change       Σ |L_i(b) − L_i(a)| / Σ L_i, the change that the two gathers predict        1
  α      tolerance    the largest change during a life                                             1

Where every L_i rises or falls monotonically during a life, the interpolated light lies between those at its ends, and
its relative error is at most c ≤ α. A life that is halved need not be halved again if the light in its middle lies on the line
between its ends, so that light which changes evenly, and light to which the contributions of many cells change by turns, takes
few keys.

References   [Gautron07] lives from predicted changes, temporal gradients
Departures   The paper predicts the change during the next frame and extrapolates it. The whole animation is known here:
             both ends of a life are gathered, with the same random numbers, and a life whose ends differ is
             halved. The paper takes τ = E(b) / E(a), in which the loss of light on one side hides a gain on the other; the sum of
             absolute changes does not. What no ray sees at either end is bounded by T alone, as in the paper; but a life during
             which a lamp or an object comes back to where it was is halved, because its ends cannot tell.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.int64]
Changes = Callable[[Indices, Indices, Indices], NDArray[np.float64]]
"""A function from records, and the first and last times of one life of each, to the change during it."""
Bends = Callable[[Indices, Indices, Indices, Indices], NDArray[np.float64]]
"""A function from records and the first times, middles and last times of one life of each, to the relative distance of the
light in the middle from the line between both ends."""
Returns = Callable[[Indices, Indices], NDArray[np.bool_]]
"""A function from the first and last times of lives to whether anything that moves or shines comes back meanwhile, so that both
ends look alike although there was a change between them."""

STILL = 0.05
"""The share of its size by which an object may wobble, or of its range by which a lamp may flicker, without coming back."""
STRAIGHT = 0.5
"""The largest bend of a life that is not halved further, in units of the tolerance: the error of its halves, if the light
follows a parabola, is a quarter of the bend."""
SHORT = 0.5
"""The longest life that is tested for being straight, in units of the longest life. In longer ones, what comes and goes could
be missed."""
STEEPEST = 4.0
"""The largest change of such a life, in units of the tolerance. Light that follows a sine through its turning point is on
the line in the middle, but lies off it by a tenth of its change in the middles of both halves."""


def first_keys(count: int, longest: int, phases: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return the keys (N, S) with which all records begin: the first and the last time, and times between them that are
    `longest` apart and lie symmetrically around the middle. The phases, 0..1, shift them, so that lives of different records
    do not end together.
    """
    keyed = np.zeros((len(phases), count), np.bool_)
    keyed[:, [0, -1]] = True
    rows = np.arange(len(phases))
    start = np.floor((count - 1) / 2 + 0.5 * longest * phases).astype(np.int64)
    for step in range(0, count, longest):
        at = start + step
        inside = at < count
        keyed[rows[inside], at[inside]] = True
        keyed[rows[inside], count - 1 - at[inside]] = True
    return keyed


def plan_lives(
    worlds: Indices,
    longest: int,
    phases: NDArray[np.float64],
    tolerance: float,
    changes: Changes,
    bends: Bends,
    returns: Returns,
    used: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Choose the keys of records.

    Parameters
    ----------
    worlds : (S,) for each time, the number of the state that the scene is in; times with the same number look the same.
    longest : the longest life, in steps of time.
    phases : (N,) of the records, 0..1.
    tolerance : the largest change during a life.
    changes, bends : gather what they need and return the changes and the bends. They are called with all lives of one round
        at once.
    returns : tells in which lives anything comes back. These are halved whatever their ends say.
    used : (N, S) the times at which each record is used.

    Returns
    -------
    (N, S) whether each time is a key of each record. The first and the last time of each run of times at which a record is
    used always are, and times at which it is not used never.
    """
    count = len(worlds)
    keyed = (first_keys(count, longest, phases) & used) | ends_of_runs(used)
    records, first, last = lives_of(keyed)
    within = used[records, np.minimum(first + 1, last)]
    records, first, last = records[within], first[within], last[within]
    different = np.concatenate([[0], np.cumsum(worlds[1:] != worlds[:-1])])
    while len(records):
        # Nothing happens while the scene stays as it is.
        eventful = different[last] > different[first]
        records, first, last = records[eventful], first[eventful], last[eventful]
        if not len(records):
            break
        back = returns(first, last)
        change = changes(records, first, last)
        split = ((change > tolerance) | back) & (last - first > 1)
        records, first, last = records[split], first[split], last[split]
        back, change = back[split], change[split]
        low, high = _middles(first, last, count)
        keyed[records, low] = keyed[records, high] = True
        wide = np.ones(len(records), np.bool_)
        short = np.nonzero((last - first <= SHORT * longest) & (change <= STEEPEST * tolerance))[0]
        if len(short):
            ends = records[short], first[short], last[short]
            bend = np.maximum(*(bends(ends[0], ends[1], middle[short], ends[2]) for middle in (low, high)))
            unseen = back[short] | returns(ends[1], low[short]) | returns(high[short], ends[2])
            wide[short] = (bend > STRAIGHT * tolerance) | unseen
        records, first, last = records[wide], first[wide], last[wide]
        low, high = low[wide], high[wide]
        apart = low < high
        records, first, last = (
            np.concatenate([records, records, records[apart]]),
            np.concatenate([first, high, low[apart]]),
            np.concatenate([low, last, high[apart]]),
        )
    return keyed


def ends_of_runs(used: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the first and the last time (N, S) of each run of times at which records are used."""
    beside = np.pad(used, ((0, 0), (1, 1)))
    return used & ~(beside[:, :-2] & beside[:, 2:])


def without_gaps(used: NDArray[np.bool_], longest: int) -> NDArray[np.bool_]:
    """Return the times (N, S) at which records are used, with the gaps between them that are no longer than `longest`."""
    count = used.shape[1]
    times = np.arange(count)
    last = np.maximum.accumulate(np.where(used, times, -count - longest), axis=1)
    following = np.minimum.accumulate(np.where(used, times, 2 * count + longest)[:, ::-1], axis=1)[:, ::-1]
    return np.asarray(following - last - 1 <= longest) | used


def coming_back(course: NDArray[np.float64]) -> Returns:
    """Make the function that tells in which lives any of the numbers (S, K), which follow what moves and shines, leaves the
    range between its values at both ends by more than half of their difference. They are in units of the size of an object or of
    the range of a brightness.
    """
    known: dict[tuple[int, int], bool] = {}

    def comes_back(first: int, last: int) -> bool:
        low, high = np.sort(course[[first, last]], axis=0)
        during = course[first : last + 1]
        beyond = np.maximum(during.max(axis=0) - high, low - during.min(axis=0))
        return bool((beyond > np.maximum((high - low) / 2, STILL)).any())

    def returns(first: Indices, last: Indices) -> NDArray[np.bool_]:
        lives = list(zip(first.tolist(), last.tolist(), strict=True))
        for life in set(lives):
            if life not in known:
                known[life] = comes_back(*life)
        return np.array([known[life] for life in lives], np.bool_)

    return returns


def lives_of(keyed: NDArray[np.bool_]) -> tuple[Indices, Indices, Indices]:
    """Return the records, first and last times of all lives between keys (N, S). The only key of a single time is a life
    of no length.
    """
    if keyed.shape[1] == 1:
        records = np.arange(len(keyed))
        return records, np.zeros_like(records), np.zeros_like(records)
    records, times = np.nonzero(keyed)
    same = records[1:] == records[:-1]
    return records[1:][same], times[:-1][same], times[1:][same]


def alive(keyed: NDArray[np.bool_], time: int) -> Indices:
    """Return the numbers of the records that have keys both not after and not before a time."""
    return np.nonzero(keyed[:, : time + 1].any(axis=1) & keyed[:, time:].any(axis=1))[0]


def around(keyed: NDArray[np.bool_], time: int) -> tuple[Indices, Indices]:
    """Return the last key (N,) of each record that is not after a time, and the first one that is not before it. All records
    must be alive then.
    """
    count = keyed.shape[1]
    before = time - np.argmax(keyed[:, time::-1], axis=1)
    after = time + np.argmax(keyed[:, time:], axis=1)
    assert ((before >= 0) & (after < count)).all()
    return before, after


def _middles(first: Indices, last: Indices, count: int) -> tuple[Indices, Indices]:
    """Return the time in the middle of each life, twice; where it falls between two times, that which is nearer to the
    middle of the animation, or both if they are equally near.
    """
    total = first + last
    low = np.where(total < count - 1, (total + 1) // 2, total // 2)
    high = np.where(total <= count - 1, (total + 1) // 2, total // 2)
    return low, high
