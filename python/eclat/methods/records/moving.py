# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Temporal irradiance caching: the records of all frames of an animation in which something moves [Gautron07].

All frames are planned before the first is made, so that a frame is the same whatever frames are made, in which order and
where:

1. Records are placed for what the cameras see, at one time after the other, from the middle of the animation outwards.
   A place that a record serves, wherever its surface is by then, gets no other.
2. Each far record is gathered at its keys (`lives`), always at its place on its surface and with the same random numbers.
3. The same is done for near records, whose rays read the far records of the same time.
4. Where radii that shrank have left gaps, near records are added, with lives of their own.

A frame reads the records as they are at its time, interpolated between keys: the difference of both ends is the gradient
over time, and since both neighbours of a key share it, nothing jumps when a life ends.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.bridge.anchors import Posed, anchors_of
from eclat.bridge.compiled import compiled, fingerprint
from eclat.bridge.running import run
from eclat.methods.records.laws import core_options
from eclat.methods.records.lives import Indices, coming_back, plan_lives
from eclat.methods.records.options import RecordOptions
from eclat.methods.records.solution import Solution
from eclat.methods.records.tracks import COLUMNS, Rows, Tracks, in_core_space, in_surface_space
from eclat.methods.work import Times, Work
from eclat.scene import Scene

LARGEST_CHANGE = 2.0
"""The largest change during a life, in units of `max_error`."""
FAR_SHARE = 0.125
"""The share with which changes in single cells of far records count that cancel in their sum. The rays of far records are whole
paths, whose single values are mostly noise, and only averages over many far records are read. It is chosen by judgement."""
FAR_STEP = 8
"""After the first time, far records are placed at each eighth time, with an eighth of the candidates. Most of these are served,
and the others were left out at first because they lie too near to others: with all candidates at all times, a furnace of
30 times gets five times as many far records. Rays that find none go on."""
LONGEST_LIFE = 24
"""The longest life in frames, if anything moves meanwhile."""
LEAST_SHARE = 0.1
"""The lower bound of the irradiance that changes are compared to, as a share of the mean: that of the error measure."""

Seen = tuple[NDArray[np.float32], float, float]
"""What a gather saw: the luminance of each cell, and those of the irradiance without the excess and of the excess."""


@dataclass(eq=False)
class MovingSolution:
    """The records of all times of an animation. `at` gives those of one time."""

    options: RecordOptions
    times: Times
    max_depth: int
    near: Tracks
    far: Tracks
    statistics: dict[str, float] = field(default_factory=dict)

    def at(self, time: int) -> Solution:
        """Return the records at a time, by its index."""
        scene = self.times.scene(time)
        near, far = (rows_at(tracks, self.times, time) for tracks in (self.near, self.far))
        statistics = {"records": float(len(near)), "far_records": float(len(far))}
        return Solution(
            self.options, fingerprint(scene), near, far, compiled(scene).center, statistics, self.max_depth, True
        )


def solve_over_time(options: RecordOptions, times: Times, work: Work) -> MovingSolution:
    """Solve records for all times of an animation."""
    return _Planner(options, times, work).solve()


def rows_at(tracks: Tracks, times: Times, time: int) -> Rows:
    """Return the rows of records as they are at a time, in coordinates of the core. Those whose surface has no extent are
    left out.
    """
    scene = times.scene(time)
    rows = tracks.at(time, times.states, np.asarray(times.seconds, np.float64))
    known = np.asarray(np.isfinite(rows[:, COLUMNS["irradiance"]]).all(axis=1))
    return _placed(rows, tracks, known, scene)[0]


def _placed(
    rows: Rows, tracks: Tracks, known: NDArray[np.bool_], scene: Scene
) -> tuple[Rows, Posed, NDArray[np.bool_]]:
    """Return rows where their surfaces are in a scene, how these lie, and which rows these are."""
    posed = tracks.anchors.posed(scene)
    which = known & posed.valid
    posed = posed.taken(which)
    local = compiled(scene).to_core(posed.positions)
    return in_core_space(rows[which], posed, tracks.moving[which], local), posed, which


class _Planner:
    def __init__(self, options: RecordOptions, times: Times, work: Work) -> None:
        self._options, self._times, self._work = options, times, work
        self._counted = _core.Progress()
        self._bright = _core.BrightPlaces()
        self._mean = {_core.RecordKind.near: 0.0, _core.RecordKind.far: 0.0}
        self._returns = coming_back(np.asarray(times.course, np.float64))
        self._gathers = 0

    def solve(self) -> MovingSolution:
        near, far = self._place()
        self._live(far, np.arange(len(far)), _core.RecordKind.far, None)
        self._live(near, np.arange(len(near)), _core.RecordKind.near, far)
        if len(self._times) > 1:
            near = self._filled(near, far)
        statistics = {
            "records": float(len(near)), "far_records": float(len(far)), "gathers": float(self._gathers),
            "rays": float(self._counted.rays),
        }  # fmt: skip
        return MovingSolution(self._options, self._times, self._work.max_depth, near, far, statistics)

    def _core_options(self) -> _core.IrradianceCacheOptions:
        return core_options(
            self._options, max_depth=self._work.max_depth, seed=self._work.seed, threads=self._work.threads
        )

    def _place(self) -> tuple[Tracks, Tracks]:
        """Place records for all times, with the light of the time at which they are placed."""
        near, far = self._empty(), self._empty()
        for number, time in enumerate(self._times.from_the_middle()):
            scene = self._times.scene(time)
            options = self._core_options()
            if number > 0:
                options.disagreement = np.inf  # Records of different times may well differ.
                options.far_records = options.far_records // FAR_STEP if number % FAR_STEP == 0 else 0
            known = [_placed(tracks.born, tracks, np.ones(len(tracks), np.bool_), scene)[0] for tracks in (near, far)]
            grown = self._grown(time, options, known)
            near, far = (
                tracks.joined(self._born(rows[len(old) :], scene, offset + len(tracks)))
                for tracks, rows, old, offset in zip((near, far), grown, known, (0, 1 << 31), strict=True)
            )
        for tracks, kind in ((near, _core.RecordKind.near), (far, _core.RecordKind.far)):
            light = _luminance(tracks.born[:, COLUMNS["irradiance"]])[tracks.born[:, COLUMNS["enclosed"].start] == 0]
            self._mean[kind] = float(light.mean(dtype=np.float64)) if len(light) else 0.0
        return near, far

    def _filled(self, near: Tracks, far: Tracks) -> Tracks:
        """Add near records where a camera finds none that serves."""
        options = self._core_options()
        options.disagreement, options.far_records = np.inf, 0
        whole = len(near)
        for time in self._times.from_the_middle():
            scene = self._times.scene(time)
            finished, new = near.taken(np.arange(whole)), near.taken(np.arange(whole, len(near)))
            rows = rows_at(finished, self._times, time)
            added = _placed(new.born, new, np.ones(len(new), np.bool_), scene)[0]
            known = np.concatenate([rows, added])
            grown, _ = self._grown(time, options, [known, rows_at(far, self._times, time)])
            near = near.joined(self._born(grown[len(known) :], scene, len(near)))
        self._live(near, np.arange(whole, len(near)), _core.RecordKind.near, far)
        return near

    def _grown(self, time: int, options: _core.IrradianceCacheOptions, known: list[Rows]) -> tuple[Rows, Rows]:
        """Return known near and far records, and those that the camera wants besides."""
        prepared = compiled(self._times.scene(time))
        caches = _core.SolvedCaches(np.ascontiguousarray(known[0]), np.ascontiguousarray(known[1]), options)
        growing = _core.GrowingCache(prepared.core, options, caches)
        growing.look(prepared.camera(self._times.cameras[time], self._times.size))
        while growing.passes_left:
            run("solve", growing.step, self._work.progress, self._counted)
        if not len(known[0]):
            self._bright = growing.bright
        return np.asarray(growing.caches.near), np.asarray(growing.caches.far)

    def _born(self, rows: Rows, scene: Scene, first: int) -> Tracks:
        """Make tracks of records that were placed in a scene."""
        center = compiled(scene).center
        positions = rows[:, COLUMNS["positions"]].astype(np.float64) + center
        radii = rows[:, COLUMNS["radii"]][:, 0].astype(np.float64)
        anchors = anchors_of(
            scene, positions, rows[:, COLUMNS["normals"]].astype(np.float64), radii, self._work.threads
        )
        moving = np.isin(anchors.meshes, self._times.moving_meshes)
        keys = (np.arange(first, first + len(rows)) * 2654435761 % (1 << 32)).astype(np.uint32)
        born = in_surface_space(rows, anchors.posed(scene), moving)
        return Tracks(anchors, born, moving, np.zeros((len(rows), len(self._times)), np.bool_), keys)

    def _empty(self) -> Tracks:
        return self._born(np.zeros((0, _core.SolvedCaches().near.shape[1]), np.float32), self._times.scene(0), 0)

    def _live(self, tracks: Tracks, records: Indices, kind: _core.RecordKind, far: Tracks | None) -> None:
        """Choose the keys of records, and gather them there."""
        seen: dict[tuple[int, int], Seen] = {}
        states = self._times.states
        unit = LEAST_SHARE * self._mean[kind]
        share = 1.0 if kind == _core.RecordKind.near else FAR_SHARE

        def gather(which: Indices, at: Indices) -> None:
            for state in np.unique(states[at]):
                wanted = np.unique(which[states[at] == state])
                known = tracks.gathers.get(int(state))
                wanted = wanted[known.lacks(wanted)] if known is not None else wanted
                if len(wanted):
                    self._renew(tracks, wanted, int(state), kind, far, seen)

        def changes(numbers: Indices, first: Indices, last: Indices) -> NDArray[np.float64]:
            which = records[numbers]
            gather(np.concatenate([which, which]), np.concatenate([first, last]))
            ends = zip(which.tolist(), states[first].tolist(), states[last].tolist(), strict=True)
            return np.array([_change(seen[a, w], seen[b, w], unit, share) for w, a, b in ends])

        def bends(numbers: Indices, first: Indices, middle: Indices, last: Indices) -> NDArray[np.float64]:
            which = records[numbers]
            gather(which, middle)
            seconds = self._times.seconds
            shares = (seconds[middle] - seconds[first]) / (seconds[last] - seconds[first])
            a, m, b = (states[at].tolist() for at in (first, middle, last))
            lives = zip(which.tolist(), a, m, b, shares.tolist(), strict=True)
            return np.array([_bend((seen[a, w], seen[m, w], seen[b, w]), share, unit) for w, a, m, b, share in lives])

        phases = np.array([_phase(int(key)) for key in tracks.keys[records]], np.float64)
        longest = max(1, round(LONGEST_LIFE * self._times.steps_per_frame))
        tolerance = LARGEST_CHANGE * self._options.max_error
        keyed = plan_lives(states, longest, phases, tolerance, changes, bends, self._returns)
        tracks.keyed[records] = keyed
        which, at = np.nonzero(keyed)
        gather(records[which], at)

    def _renew(
        self,
        tracks: Tracks,
        which: Indices,
        state: int,
        kind: _core.RecordKind,
        far: Tracks | None,
        seen: dict[tuple[int, int], Seen],
    ) -> None:
        """Gather records in a state of the scene."""
        time = self._times.first_time(state)
        scene, options = self._times.scene(time), self._core_options()
        some = tracks.taken(which)
        rows, posed, valid = _placed(some.born, some, np.ones(len(some), np.bool_), scene)
        none = np.zeros((0, rows.shape[1]), np.float32)
        far_rows = none if far is None else rows_at(far, self._times, time)
        caches = _core.SolvedCaches(none, np.ascontiguousarray(far_rows), options)
        shading = np.ascontiguousarray(posed.shading_normals, np.float32)
        given = (np.ascontiguousarray(rows), shading, some.keys[valid])
        core, settings = compiled(scene).core, _core.RenewalSettings(self._bright, kind, self._mean[kind])
        renewed, counts, values = run(
            "solve",
            lambda p: _core.renew_records(core, caches, settings, options, *given, p),
            self._work.progress, self._counted,
        )  # fmt: skip
        self._gathers += len(renewed)
        new = np.full_like(some.born, np.nan)
        new[valid] = _no_wider(renewed, some.born[valid], options, kind)
        new[valid] = in_surface_space(new[valid], posed, some.moving[valid])
        tracks.store(state, which, new)
        parts = np.split(values, np.cumsum(counts.astype(np.int64))[:-1]) if len(counts) else []
        for record, part, row in zip(which[valid].tolist(), parts, renewed, strict=True):
            light = (_luminance(row[COLUMNS["irradiance"]][None])[0], _luminance(row[COLUMNS["excess"]][None])[0])
            seen[state, record] = (part, float(light[0]), float(light[1]))
        for record in which[~valid].tolist():
            seen[state, record] = (np.zeros(0, np.float32), 0.0, 0.0)


def _change(a: Seen, b: Seen, least: float, share: float) -> float:
    """Return the change c between two gathers: the change of their sums, or the `share` of those of all cells if this is
    more."""
    if len(a[0]) != len(b[0]):
        return np.inf if len(a[0]) or len(b[0]) else 0.0
    gained = float(np.abs(a[0] - b[0]).mean(dtype=np.float64)) * np.pi if len(a[0]) else 0.0
    whole = float(np.hypot(max(a[1] + a[2], b[1] + b[2]), least))
    cells, net = gained + abs(a[2] - b[2]), abs(a[1] + a[2] - b[1] - b[2])
    return max(net, share * cells) / whole if whole > 0 else 0.0


def _bend(gathers: tuple[Seen, Seen, Seen], share: float, least: float) -> float:
    """Return how far the light of the second of three gathers is from the line between the others, relative to the largest."""
    light = [irradiance + excess for _, irradiance, excess in gathers]
    whole = float(np.hypot(max(light), least))
    return abs(light[1] - (1 - share) * light[0] - share * light[2]) / whole if whole > 0 else 0.0


def _no_wider(rows: Rows, born: Rows, options: _core.IrradianceCacheOptions, kind: _core.RecordKind) -> Rows:
    """Return rows whose radii follow lengths that are no longer than those with which the records were placed. These may
    have shrunk beside others that disagreed.
    """
    rows = rows.copy()
    distances, radii = COLUMNS["distances"].start, COLUMNS["radii"].start
    shorter = born[:, distances] < rows[:, distances]
    with np.errstate(invalid="ignore"):
        share = born[:, distances] / rows[:, distances]
    rows[shorter, distances] = born[shorter, distances]
    rows[shorter, radii] = np.maximum(
        rows[shorter, radii] * share[shorter], rows[shorter, COLUMNS["least_radii"].start]
    )
    return rows


def _luminance(colors: NDArray[np.float32]) -> NDArray[np.float64]:
    found: NDArray[np.float64] = colors.astype(np.float64) @ np.array([0.2126, 0.7152, 0.0722])
    return found


def _phase(key: int) -> float:
    """Return a number in [0, 1) from the key of a record."""
    key = (key ^ (key >> 16)) * 0x45D9F3B & 0xFFFFFFFF
    key = (key ^ (key >> 16)) * 0x45D9F3B & 0xFFFFFFFF
    return (key ^ (key >> 16)) / 2.0**32
