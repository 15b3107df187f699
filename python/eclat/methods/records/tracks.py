# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tracks: records that stay at their places on surfaces through all times of an animation, and what they gathered at their
keys.

Records on surfaces that move are kept in the space of the surface: their gradients turn with it, and of records of radiance
(`radiance_rows`) the light as well.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.bridge.anchors import Anchors, Numbers, Posed
from eclat.methods.records.lives import Indices, alive, around
from eclat.methods.records.radiance_rows import Rows, turn_with_surfaces

COLUMNS = {name: slice(first, first + count) for name, first, count in _core.record_layout()}
_GRADIENTS = ("rotation_gradients", "translation_gradients")


@dataclass(frozen=True, eq=False)
class Gathers:
    """What some records gathered at one time: their numbers, sorted, and their rows."""

    records: Indices
    rows: Rows

    def of(self, records: Indices) -> Rows:
        """Return the rows of records, all of which were gathered."""
        found: Rows = self.rows[np.searchsorted(self.records, records)]
        return found

    def lacks(self, records: Indices) -> NDArray[np.bool_]:
        """Return which of some records were not gathered."""
        return ~np.isin(records, self.records)

    def with_more(self, records: Indices, rows: Rows) -> Gathers:
        all_records = np.concatenate([self.records, records])
        order = np.argsort(all_records, kind="stable")
        return Gathers(all_records[order], np.concatenate([self.rows, rows])[order])


@dataclass(eq=False)
class Tracks:
    """Records of one kind.

    `born` (N, floats) are the rows with which they were placed, in the space of their surfaces; `keyed` (N, S) are their
    keys; `gathers` has what they gathered in each state of the scene, by its number.
    """

    anchors: Anchors
    born: Rows
    moving: NDArray[np.bool_]
    keyed: NDArray[np.bool_]
    keys: NDArray[np.uint32]
    """The keys of their random numbers."""
    gathers: dict[int, Gathers] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.born)

    def joined(self, other: Tracks) -> Tracks:
        """Return these tracks and others after them, without gathers of the others."""
        names = ("born", "moving", "keyed", "keys")
        joined = {name: np.concatenate([getattr(self, name), getattr(other, name)]) for name in names}
        return Tracks(self.anchors.joined(other.anchors), gathers=dict(self.gathers), **joined)

    def taken(self, which: NDArray[np.generic]) -> Tracks:
        """Return some of the tracks by their sorted numbers or a mask, with what they gathered."""
        numbers = np.arange(len(self))[which]
        gathers = {}
        for state, found in self.gathers.items():
            kept = np.isin(found.records, numbers)
            gathers[state] = Gathers(np.searchsorted(numbers, found.records[kept]), found.rows[kept])
        return Tracks(
            self.anchors.taken(numbers), self.born[numbers], self.moving[numbers], self.keyed[numbers],
            self.keys[numbers], gathers,
        )  # fmt: skip

    def store(self, world: int, records: Indices, rows: Rows) -> None:
        """Keep what records gathered in a state of the scene."""
        known = self.gathers.get(world)
        empty = Gathers(np.zeros(0, np.int64), np.zeros((0, self.born.shape[1]), np.float32))
        self.gathers[world] = (known or empty).with_more(records, rows)

    def at(self, time: int, worlds: Indices, times: Numbers) -> Rows:
        """Return the rows at a time, interpolated between the keys around it, in the space of their surfaces. The rows of
        records that have no extent at both keys are NaN, as are those before the first and after the last key.
        """
        living = alive(self.keyed, time)
        before, after = around(self.keyed[living], time)
        span = times[after] - times[before]
        with np.errstate(all="ignore"):
            share = np.where(span > 0, (times[time] - times[before]) / span, 0.0)
        rows = np.full_like(self.born, np.nan)
        rows[living] = blended(self._rows_at(living, worlds[before]), self._rows_at(living, worlds[after]), share)
        return rows

    def _rows_at(self, records: Indices, worlds: Indices) -> Rows:
        rows = np.empty_like(self.born[records])
        for world in np.unique(worlds):
            which = np.nonzero(worlds == world)[0]
            rows[which] = self.gathers[int(world)].of(records[which])
        return rows


def blended(first: Rows, second: Rows, share: Numbers) -> Rows:
    """Interpolate between rows of records, with the `share` (N,) of the second.

    The light, its gradients and the lengths that radii follow are interpolated linearly, so that neither light nor weights
    jump at a key. Geometry that was in the way at either end counts. Where only one row is known, it is taken.
    """
    light = COLUMNS["irradiance"]
    first = np.where(np.isfinite(first[:, light]).all(axis=1, keepdims=True), first, second)
    second = np.where(np.isfinite(second[:, light]).all(axis=1, keepdims=True), second, first)
    least = np.minimum(first, second)
    with np.errstate(all="ignore"):
        mixed = (first.astype(np.float64) * (1 - share[:, None]) + second * share[:, None]).astype(np.float32)
    # Distances are infinite where nothing was seen.
    rows = np.where(first == second, first, np.where(np.isfinite(first) & np.isfinite(second), mixed, least))
    rows[:, COLUMNS["clearances"]] = least[:, COLUMNS["clearances"]]
    rows[:, COLUMNS["enclosed"]] = np.maximum(first, second)[:, COLUMNS["enclosed"]]
    _blend_ellipses(rows, first, second, share)
    return rows


def in_surface_space(rows: Rows, posed: Posed, moving: NDArray[np.bool_]) -> Rows:
    """Turn rows of the core into the space of their surfaces. Directions around the normal are dropped where these move:
    clearances become the least one, and ellipses the circles in them.
    """
    rows = rows.copy()
    rows[moving, COLUMNS["elongations"]] = 1
    rows[moving, COLUMNS["axes"]] = 0
    clearances = rows[moving, COLUMNS["clearances"]]
    rows[moving, COLUMNS["clearances"]] = clearances.min(axis=1, keepdims=True)
    _turn(rows, moving, posed.frames.swapaxes(1, 2))
    turn_with_surfaces(rows, moving, posed, into_surface=True)
    return rows


def in_core_space(rows: Rows, posed: Posed, moving: NDArray[np.bool_], positions: NDArray[np.float32]) -> Rows:
    """Turn rows from the space of their surfaces to where these are; `positions` (N, 3) are in coordinates of the core."""
    rows = rows.copy()
    rows[:, COLUMNS["positions"]] = positions
    rows[:, COLUMNS["normals"]] = posed.normals
    _turn(rows, moving, posed.frames)
    turn_with_surfaces(rows, moving, posed, into_surface=False)
    return rows


def _turn(rows: Rows, which: NDArray[np.bool_], turns: Numbers) -> None:
    for name in _GRADIENTS:
        vectors = rows[which, COLUMNS[name]].reshape(-1, 3, 3)
        rows[which, COLUMNS[name]] = np.einsum("nij,ncj->nci", turns[which], vectors).reshape(-1, 9)


def _blend_ellipses(rows: Rows, first: Rows, second: Rows, share: Numbers) -> None:
    """Interpolate the ellipses within which records are valid, by the matrices of their squared eccentricities: a mean of
    angles would jump.
    """

    def matrix(of: Rows) -> Numbers:
        eccentricity = 1 - of[:, COLUMNS["elongations"]][:, 0].astype(np.float64) ** -2.0
        axis = of[:, COLUMNS["axes"]][:, 0].astype(np.float64)
        parts = np.column_stack([np.cos(2 * axis), np.sin(2 * axis), np.ones(len(axis))])
        return np.asarray(eccentricity[:, None] * parts / 2)

    names = ("elongations", "axes")
    turned = np.zeros(len(rows), np.bool_)
    for name in names:
        turned |= (first[:, COLUMNS[name]] != second[:, COLUMNS[name]])[:, 0]
    if not turned.any():
        return
    s = share[turned, None]
    cosine, sine, half = ((1 - s) * matrix(first[turned]) + s * matrix(second[turned])).T
    across = np.hypot(cosine, sine)
    larger, smaller = half + across, half - across
    # Only the ratio of the axes can be kept of an ellipse that is stretched along both.
    rows[turned, COLUMNS["elongations"].start] = np.sqrt((1 - smaller) / np.maximum(1 - larger, 1e-6))
    rows[turned, COLUMNS["axes"].start] = np.arctan2(sine, cosine) / 2
