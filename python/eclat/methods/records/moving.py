# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Temporal caching: the records of all frames of an animation in which something moves, of irradiance and of radiance
[Gautron07].

All frames are planned before the first is made, so that a frame is the same whatever frames are made, in which order and
where:

1. Records are placed for what the cameras see, at one time after the other, from the middle of the animation outwards.
   A place that a record serves, wherever its surface is by then, gets no other.
2. Each far record is gathered at its keys (`lives`), always at its place on its surface and with the same random numbers.
3. The same is done for near records and for those of radiance, whose rays read the far records of the same time.
4. Where radii that shrank have left gaps, such records are added, with lives of their own.

A frame reads the records as they are at its time, interpolated between keys: the difference of both ends is the gradient
over time, and since both neighbours of a key share it, nothing jumps when a life ends.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.bridge.anchors import anchors_of
from eclat.bridge.compiled import compiled
from eclat.bridge.running import run
from eclat.methods.records.changes import NOTHING, IrradianceMeasure, Measure, RadianceMeasure, Seen
from eclat.methods.records.laws import core_options, core_radiance_options
from eclat.methods.records.lives import Indices, coming_back, plan_lives
from eclat.methods.records.moving_solution import MovingSolution, placed, rows_at
from eclat.methods.records.options import RadianceOptions, RecordOptions
from eclat.methods.records.radiance_rows import RECORD, Rows, luminances, records_of, rows_of
from eclat.methods.records.radiance_tables import radiance_tables
from eclat.methods.records.solution import RadianceRecords
from eclat.methods.records.tracks import COLUMNS, Tracks, in_surface_space
from eclat.methods.records.use import times_in_use, turn_fast
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

NEAR, FAR, RADIANCE = _core.RecordKind.near, _core.RecordKind.far, _core.RecordKind.radiance
FIRST_KEYS = {NEAR: 0, RADIANCE: 1 << 30, FAR: 1 << 31}
"""The numbers of the first record of each kind, from which the keys of its random numbers follow."""

Kinds = dict[_core.RecordKind, Tracks]


def solve_over_time(options: RecordOptions, times: Times, work: Work) -> MovingSolution:
    """Solve records for all times of an animation."""
    return _Planner(options, times, work).solve()


class _Planner:
    def __init__(self, options: RecordOptions, times: Times, work: Work) -> None:
        self._options, self._times, self._work = options, times, work
        self._kinds = (NEAR, FAR, RADIANCE) if isinstance(options, RadianceOptions) else (NEAR, FAR)
        self._counted = _core.Progress()
        self._bright: _core.BrightPlaces | None = None
        self._mean = dict.fromkeys(self._kinds, 0.0)
        self._returns = coming_back(np.asarray(times.course, np.float64))
        self._gathers = 0

    def solve(self) -> MovingSolution:
        tracks = self._place()
        for kind in (FAR, *(kind for kind in self._kinds if kind != FAR)):
            self._live(tracks, np.arange(len(tracks[kind])), kind)
        if len(self._times) > 1:
            self._fill(tracks)
        names = {NEAR: "records", FAR: "far_records", RADIANCE: "radiance_records"}
        statistics = {names[kind]: float(len(tracks[kind])) for kind in self._kinds}
        statistics |= {"gathers": float(self._gathers), "rays": float(self._counted.rays)}
        return MovingSolution(
            self._options,
            self._times,
            self._work.max_depth,
            tracks[NEAR],
            tracks[FAR],
            tracks.get(RADIANCE),
            statistics,
        )

    def _core_options(self) -> _core.IrradianceCacheOptions:
        return core_options(self._options, **self._settings())

    def _settings(self) -> dict[str, int]:
        return {"max_depth": self._work.max_depth, "seed": self._work.seed, "threads": self._work.threads}

    def _place(self) -> Kinds:
        """Place records for all times, with the light of the time at which they are placed."""
        tracks = {kind: self._empty(kind) for kind in self._kinds}
        for number, time in enumerate(self._times.from_the_middle()):
            scene = self._times.scene(time)
            options = self._core_options()
            if number > 0:
                options.disagreement = np.inf  # Records of different times may well differ.
                options.far_records = options.far_records // FAR_STEP if number % FAR_STEP == 0 else 0
            self._grow(tracks, time, options, {kind: _born_rows(tracks[kind], scene) for kind in self._kinds})
        for kind, made in tracks.items():
            light = _luminance(made.born[:, COLUMNS["irradiance"]])[made.born[:, COLUMNS["enclosed"].start] == 0]
            self._mean[kind] = float(light.mean(dtype=np.float64)) if len(light) else 0.0
        return tracks

    def _fill(self, tracks: Kinds) -> None:
        """Add records where a camera finds none that serves."""
        options = self._core_options()
        options.disagreement, options.far_records = np.inf, 0
        whole = {kind: len(tracks[kind]) for kind in self._kinds}
        for time in self._times.from_the_middle():
            scene, known = self._times.scene(time), {}
            for kind in self._kinds:
                numbers = np.arange(len(tracks[kind]))
                finished, new = tracks[kind].taken(numbers[: whole[kind]]), tracks[kind].taken(numbers[whole[kind] :])
                known[kind] = np.concatenate([rows_at(finished, self._times, time), _born_rows(new, scene)])
            self._grow(tracks, time, options, known)
        for kind in self._kinds:
            if kind != FAR:
                self._live(tracks, np.arange(whole[kind], len(tracks[kind])), kind)

    def _grow(
        self, tracks: Kinds, time: int, options: _core.IrradianceCacheOptions, known: dict[_core.RecordKind, Rows]
    ) -> None:
        """Add to the tracks what the camera wants at a time besides the known records."""
        scene = self._times.scene(time)
        prepared = compiled(scene)
        camera = prepared.camera(self._times.cameras[time], self._times.size)
        caches = _core.SolvedCaches(np.ascontiguousarray(known[NEAR]), np.ascontiguousarray(known[FAR]), options)
        growing = self._growing(scene, options, caches, known)
        growing.look(camera)
        while growing.passes_left:
            run("solve", growing.step, self._work.progress, self._counted)
        caches = growing.caches
        if self._bright is None:
            self._bright = growing.bright
        grown = {NEAR: np.asarray(caches.near), FAR: np.asarray(caches.far)}
        if isinstance(self._options, RadianceOptions):
            grown[RADIANCE] = rows_of(RadianceRecords.of(caches), self._options.order)
        for kind, rows in grown.items():
            first = FIRST_KEYS[kind] + len(tracks[kind])
            made = self._born(rows[len(known[kind]) :], scene)
            if kind == FAR:
                made = made.taken(~turn_fast(made, self._times, LONGEST_LIFE / 4))
            made.keyed[:, time] = True
            made.keys[:] = np.arange(first, first + len(made)) * 2654435761 % (1 << 32)
            tracks[kind] = tracks[kind].joined(made)

    def _growing(
        self,
        scene: Scene,
        options: _core.IrradianceCacheOptions,
        caches: _core.SolvedCaches,
        known: dict[_core.RecordKind, Rows],
    ) -> _core.GrowingCache:
        """Return what grows from the known records, of which `caches` has those of irradiance."""
        core = compiled(scene).core
        if not isinstance(self._options, RadianceOptions):
            return _core.GrowingCache(core, options, caches)
        settings = core_radiance_options(self._options, **self._settings())
        settings.irradiance = options
        tables = radiance_tables(scene, self._options, threads=self._work.threads or None, progress=self._work.progress)
        records = records_of(known[RADIANCE])
        if len(records):
            caches.set_radiance(records.records, records.values, records.gradients, settings)
        return _core.GrowingCache(core, settings, tables, caches)

    def _born(self, rows: Rows, scene: Scene) -> Tracks:
        """Make tracks of records that were placed in a scene."""
        center = compiled(scene).center
        positions = rows[:, COLUMNS["positions"]].astype(np.float64) + center
        radii = rows[:, COLUMNS["radii"]][:, 0].astype(np.float64)
        anchors = anchors_of(
            scene, positions, rows[:, COLUMNS["normals"]].astype(np.float64), radii, self._work.threads
        )
        moving = np.isin(anchors.meshes, self._times.moving_meshes)
        born = in_surface_space(rows, anchors.posed(scene), moving)
        return Tracks(
            anchors, born, moving, np.zeros((len(rows), len(self._times)), np.bool_), np.zeros(len(rows), np.uint32)
        )

    def _empty(self, kind: _core.RecordKind) -> Tracks:
        width = RECORD
        if kind == RADIANCE:
            assert isinstance(self._options, RadianceOptions)
            width += 9 * self._options.order**2
        return self._born(np.zeros((0, width), np.float32), self._times.scene(0))

    def _measure(self, kind: _core.RecordKind) -> Measure:
        if kind == RADIANCE:
            return RadianceMeasure(self._mean[kind])
        return IrradianceMeasure(self._mean[kind], FAR_SHARE if kind == FAR else 1.0)

    def _live(self, all_tracks: Kinds, records: Indices, kind: _core.RecordKind) -> None:
        """Choose the keys of records of one kind, and gather them there."""
        seen: dict[tuple[int, int], Seen] = {}
        states, tracks, measure = self._times.states, all_tracks[kind], self._measure(kind)

        def gather(which: Indices, at: Indices) -> None:
            for state in np.unique(states[at]):
                wanted = np.unique(which[states[at] == state])
                known = tracks.gathers.get(int(state))
                wanted = wanted[known.lacks(wanted)] if known is not None else wanted
                if len(wanted):
                    self._renew(all_tracks, kind, wanted, int(state), seen)

        def changes(numbers: Indices, first: Indices, last: Indices) -> NDArray[np.float64]:
            which = records[numbers]
            gather(np.concatenate([which, which]), np.concatenate([first, last]))
            ends = zip(which.tolist(), states[first].tolist(), states[last].tolist(), strict=True)
            return np.array([measure.change(seen[a, w], seen[b, w]) for w, a, b in ends])

        def bends(numbers: Indices, first: Indices, middle: Indices, last: Indices) -> NDArray[np.float64]:
            which = records[numbers]
            gather(which, middle)
            seconds = self._times.seconds
            shares = (seconds[middle] - seconds[first]) / (seconds[last] - seconds[first])
            a, m, b = (states[at].tolist() for at in (first, middle, last))
            lives = zip(which.tolist(), a, m, b, shares.tolist(), strict=True)
            return np.array([measure.bend(seen[a, w], seen[m, w], seen[b, w], share) for w, a, m, b, share in lives])

        phases = np.array([_phase(int(key)) for key in tracks.keys[records]], np.float64)
        longest = max(1, round(LONGEST_LIFE * self._times.steps_per_frame))
        tolerance = LARGEST_CHANGE * self._options.max_error
        some = tracks.taken(records)
        used = np.ones(some.keyed.shape, np.bool_)
        if kind != FAR:
            used = times_in_use(some, self._times, self._core_options(), self._work.progress, self._counted)
        keyed = plan_lives(states, longest, phases, tolerance, changes, bends, self._returns, used)
        tracks.keyed[records] = keyed
        which, at = np.nonzero(keyed)
        gather(records[which], at)

    def _renew(
        self,
        all_tracks: Kinds,
        kind: _core.RecordKind,
        which: Indices,
        state: int,
        seen: dict[tuple[int, int], Seen],
    ) -> None:
        """Gather records in a state of the scene."""
        time = self._times.first_time(state)
        scene, options, tracks = self._times.scene(time), self._core_options(), all_tracks[kind]
        some = tracks.taken(which)
        rows, posed, valid = placed(some.born, some, np.ones(len(some), np.bool_), scene)
        none = np.zeros((0, RECORD), np.float32)
        far_rows = none if kind == FAR else rows_at(all_tracks[FAR], self._times, time)
        caches = _core.SolvedCaches(none, np.ascontiguousarray(far_rows), options)
        shading = np.ascontiguousarray(posed.shading_normals, np.float32)
        given = (np.ascontiguousarray(rows[:, :RECORD]), shading, some.keys[valid])
        renewed, looks = self._gathered(compiled(scene).core, caches, kind, given)
        self._gathers += len(renewed)
        new = np.full_like(some.born, np.nan)
        new[valid] = _no_wider(renewed, some.born[valid])
        new[valid] = in_surface_space(new[valid], posed, some.moving[valid])
        tracks.store(state, which, new)
        for record, look, row in zip(which[valid].tolist(), looks, renewed, strict=True):
            light = (_luminance(row[COLUMNS["irradiance"]][None])[0], _luminance(row[COLUMNS["excess"]][None])[0])
            seen[state, record] = Seen(look, float(light[0]), float(light[1]))
        for record in which[~valid].tolist():
            seen[state, record] = NOTHING

    def _gathered(
        self, core: _core.Scene, caches: _core.SolvedCaches, kind: _core.RecordKind, given: tuple[Any, Any, Any]
    ) -> tuple[Rows, list[NDArray[np.floating]]]:
        """Return the rows of records (their old rows, shading normals and keys are `given`), and what changes are measured
        by of each."""
        progress = self._work.progress
        if kind == RADIANCE:
            assert isinstance(self._options, RadianceOptions)
            settings = core_radiance_options(self._options, **self._settings())
            rows, coefficients = run(
                "solve",
                lambda p: _core.renew_radiance(core, caches, self._mean[kind], settings, *given, p),
                progress, self._counted,
            )  # fmt: skip
            whole = np.concatenate([rows, coefficients], axis=1)
            return whole, list(luminances(whole))
        aimed = _core.RenewalSettings(self._bright or _core.BrightPlaces(), kind, self._mean[kind])
        options = self._core_options()
        rows, counts, values = run(
            "solve",
            lambda p: _core.renew_records(core, caches, aimed, options, *given, p),
            progress, self._counted,
        )  # fmt: skip
        return rows, np.split(values, np.cumsum(counts.astype(np.int64))[:-1]) if len(counts) else []


def _born_rows(tracks: Tracks, scene: Scene) -> Rows:
    """Return the rows with which records were placed, where their surfaces are in a scene."""
    return placed(tracks.born, tracks, np.ones(len(tracks), np.bool_), scene)[0]


def _no_wider(rows: Rows, born: Rows) -> Rows:
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
