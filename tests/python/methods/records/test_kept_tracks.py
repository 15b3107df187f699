# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tracks as arrays and back."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.bridge.anchors import Anchors
from eclat.methods.records.kept_tracks import arrays_of, tracks_from
from eclat.methods.records.tracks import Tracks
from eclat.methods.saved import DamagedArrayError

COUNT, WIDTH, TIMES = 4, 7, 3


def some_tracks() -> Tracks:
    rng = np.random.default_rng(0)
    whole = [rng.integers(-1, 5, COUNT) for _ in range(2)]
    anchors = Anchors(*whole, rng.random((COUNT, 3)), np.ones(COUNT), rng.random((COUNT, 3)), rng.random((COUNT, 3)))
    keyed, keys = rng.random((COUNT, TIMES)) < 0.5, rng.integers(0, 99, COUNT).astype(np.uint32)
    tracks = Tracks(anchors, rng.random((COUNT, WIDTH)).astype(np.float32), rng.random(COUNT) < 0.5, keyed, keys)
    tracks.store(2, np.array([0, 1, 3]), rng.random((3, WIDTH)).astype(np.float32))
    tracks.store(0, np.array([2]), np.full((1, WIDTH), np.nan, np.float32))
    return tracks


def test_tracks_come_back_as_they_were() -> None:
    tracks = some_tracks()
    back = tracks_from(arrays_of(tracks, "near"), "near", WIDTH, TIMES)
    for name in ("born", "moving", "keyed", "keys"):
        np.testing.assert_array_equal(getattr(back, name), getattr(tracks, name))
    for name in ("meshes", "triangles", "shares", "sides", "places", "normals"):
        np.testing.assert_array_equal(getattr(back.anchors, name), getattr(tracks.anchors, name))
    assert sorted(back.gathers) == [0, 2]
    for state, gathers in tracks.gathers.items():
        np.testing.assert_array_equal(back.gathers[state].records, gathers.records)
        np.testing.assert_array_equal(back.gathers[state].rows, gathers.rows)


def test_no_tracks_come_back_as_none() -> None:
    empty = some_tracks().taken(np.zeros(0, np.int64))
    empty.gathers.clear()
    assert len(tracks_from(arrays_of(empty, "far"), "far", WIDTH, TIMES)) == 0


@pytest.mark.parametrize("name", list(arrays_of(some_tracks(), "near")))
def test_damaged_arrays_are_named(name: str) -> None:
    arrays = arrays_of(some_tracks(), "near")
    for damaged in ({n: a for n, a in arrays.items() if n != name}, arrays | {name: arrays[name][:-1]}):
        with pytest.raises(DamagedArrayError, match="near_"):
            tracks_from(damaged, "near", WIDTH, TIMES)


def test_gathers_of_records_that_are_not_there_are_refused() -> None:
    arrays = arrays_of(some_tracks(), "near")
    arrays["near_gather_records"] = arrays["near_gather_records"] + COUNT
    with pytest.raises(DamagedArrayError, match="gather_records"):
        tracks_from(arrays, "near", WIDTH, TIMES)
