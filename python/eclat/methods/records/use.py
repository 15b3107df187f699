# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Which records of an animation are worth their gathers: at which times near records and those of radiance are seen, and which
far records would have to be gathered at nearly every time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.bridge.running import ProgressReport, run
from eclat.methods.records.lives import without_gaps
from eclat.methods.records.moving_solution import placed
from eclat.methods.records.radiance_rows import RECORD
from eclat.methods.records.tracks import Tracks
from eclat.methods.work import Times

LONGEST_GAP = 6
"""The longest time in frames during which a record that nobody sees is kept up to date, because it is seen before and after it.
It is chosen by judgement: with shorter times, records that are seen now and then would take more keys at the ends of these times
than they save."""
FASTEST_TURN = np.radians(30)
"""The largest angle by which a surface with far records may turn within the time that `turn_fast` is given. It is chosen by
judgement. A far record takes some hundred rays at each key; on a wheel, on which the light changes in each frame, fewer rays
end in it than that. Where there is none, rays go on. In the benchmark of the rolling ball, which turns by 80°, the 75 far
records on it took a seventh of all rays."""


def turn_fast(tracks: Tracks, times: Times, frames: float) -> NDArray[np.bool_]:
    """Return which tracks (N,) lie on surfaces that ever turn by more than `FASTEST_TURN` within a number of frames."""
    fast = np.zeros(len(tracks), np.bool_)
    which = np.nonzero(tracks.moving)[0]
    if not len(which) or len(times) < 2:
        return fast
    anchors = tracks.anchors.taken(which)
    normals = np.array([anchors.posed(times.scene(time)).normals for time in range(len(times))])
    step = min(max(1, round(frames * times.steps_per_frame)), len(times) - 1)
    cosines = np.einsum("tni,tni->tn", normals[step:], normals[:-step])
    fast[which] = np.fmin.reduce(cosines, axis=0, initial=1.0) < np.cos(FASTEST_TURN)
    return fast


def times_in_use(
    tracks: Tracks,
    times: Times,
    options: _core.IrradianceCacheOptions,
    progress: ProgressReport | None,
    counted: _core.Progress,
) -> NDArray[np.bool_]:
    """Return the times (N, S) at which tracks are in use: those at which the camera sees points that read them, and the gaps
    between these that are no longer than `LONGEST_GAP`.

    If the camera is at rest, tracks on surfaces that are at rest are always in use. Every track is in use at its keys, which
    are the times at which it was placed.
    """
    used = np.ones(tracks.keyed.shape, np.bool_)
    camera_moves = len(set(times.cameras)) > 1
    which = np.nonzero(tracks.moving | camera_moves)[0]
    if not len(which):
        return used
    some = tracks.taken(which)
    views = times.views
    found = {views[time]: _seen_at(some, times, time, options, progress, counted) for time in times.from_the_middle()}
    seen = np.stack([found[view] for view in views], axis=1) | some.keyed
    # A picture touches the rim of a record a little earlier and later than the points that were looked at.
    beside = np.pad(seen, ((0, 0), (1, 1)))
    seen = seen | beside[:, :-2] | beside[:, 2:]
    used[which] = without_gaps(seen, round(LONGEST_GAP * times.steps_per_frame))
    return used


def _seen_at(
    tracks: Tracks,
    times: Times,
    time: int,
    options: _core.IrradianceCacheOptions,
    progress: ProgressReport | None,
    counted: _core.Progress,
) -> NDArray[np.bool_]:
    """Return which tracks (N,) the camera sees at a time, as they were when they were placed."""
    scene = times.scene(time)
    prepared = compiled(scene)
    rows, _, there = placed(tracks.born, tracks, np.ones(len(tracks), np.bool_), scene)
    records = np.ascontiguousarray(rows[:, :RECORD])
    camera = prepared.camera(times.cameras[time], times.size)
    seen = np.zeros(len(tracks), np.bool_)
    seen[there] = run(
        "solve", lambda p: _core.records_in_use(prepared.core, camera, records, options, p), progress, counted
    )
    return seen
