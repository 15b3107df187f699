# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tracks of records as named arrays, in which they are kept in files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields

import numpy as np

from eclat.bridge.anchors import Anchors
from eclat.methods.records.tracks import Gathers, Tracks
from eclat.methods.saved import DamagedArrayError

_PARTS = ("born", "moving", "keyed", "keys")
_ANCHORS = tuple(field.name for field in fields(Anchors))


def arrays_of(tracks: Tracks, name: str) -> dict[str, np.ndarray]:
    """Return tracks as arrays, whose names begin with the given one."""
    arrays = {f"{name}_{part}": getattr(tracks, part) for part in _PARTS}
    arrays |= {f"{name}_anchor_{part}": getattr(tracks.anchors, part) for part in _ANCHORS}
    gathers = tracks.gathers.items()
    arrays[f"{name}_gather_states"] = np.array([s for s, g in gathers for _ in range(len(g.records))], np.int64)
    arrays[f"{name}_gather_records"] = np.concatenate([np.zeros(0, np.int64), *(g.records for _, g in gathers)])
    arrays[f"{name}_gather_rows"] = np.concatenate([tracks.born[:0], *(g.rows for _, g in gathers)])
    return arrays


def tracks_from(arrays: Mapping[str, np.ndarray], name: str, width: int, times: int) -> Tracks:
    """Return the tracks whose arrays have names that begin with the given one.

    Parameters
    ----------
    width : the number of floats of a row.
    times : the number of times.

    Raises
    ------
    DamagedArrayError : an array is missing, or does not fit the others.
    """
    count = len(arrays.get(f"{name}_born", ()))

    def array(part: str, shape: tuple[int, ...], kind: type) -> np.ndarray:
        found = arrays.get(f"{name}_{part}")
        if found is None or found.shape != shape or not np.issubdtype(found.dtype, kind):
            raise DamagedArrayError(f"{name}_{part}")
        return found

    whole, real, number = np.integer, np.floating, len(arrays.get(f"{name}_gather_states", ()))
    shapes = {"meshes": ((count,), whole), "triangles": ((count,), whole), "sides": ((count,), real)}
    vectors = ((count, 3), real)
    anchors = Anchors(*(array(f"anchor_{part}", *shapes.get(part, vectors)) for part in _ANCHORS))
    tracks = Tracks(
        anchors, array("born", (count, width), real), array("moving", (count,), np.bool_),
        array("keyed", (count, times), np.bool_), array("keys", (count,), whole),
    )  # fmt: skip
    states, records = array("gather_states", (number,), whole), array("gather_records", (number,), whole)
    rows = array("gather_rows", (number, width), real)
    if number and not 0 <= records.min() <= records.max() < count:
        raise DamagedArrayError(f"{name}_gather_records")
    for state in np.unique(states).tolist():
        which = states == state
        tracks.gathers[state] = Gathers(records[which], rows[which])
    return tracks
