# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records that grow while someone walks, in a thread of their own."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.methods.records.laws import core_options, core_radiance_options
from eclat.methods.records.options import RadianceOptions
from eclat.methods.records.radiance_tables import radiance_tables
from eclat.methods.records.solution import Solution, solved_from_core
from eclat.scene import Scene
from eclat.viewer.gloss import GlossRecords, GlossSource
from eclat.viewer.record_rows import ROW, record_rows

View = tuple[object, _core.Camera]
"""Who wished for a view, and its camera."""


def empty_solution(scene: Scene, options: Any, max_depth: int = -1) -> Solution:
    """Make a solution without records, with which growth begins."""
    return solved_from_core(
        scene, options, _core.SolvedCaches(), {"records": 0.0, "rays": 0.0}, max_depth=max_depth, complete=False
    )


def growing_cache(scene: Scene, solution: Solution, *, threads: int, seed: int) -> _core.GrowingCache:
    """Make the caches of the core that begin with the records of a solution."""
    begin = solution.core() if len(solution.near) or len(solution.far) else _core.SolvedCaches()
    core, options, max_depth = compiled(scene).core, solution.options, solution.max_depth
    if not isinstance(options, RadianceOptions):
        settings = core_options(options, max_depth=max_depth, seed=seed, threads=threads)
        return _core.GrowingCache(core, settings, begin)
    tables = radiance_tables(scene, options, threads=threads or None)
    of_both = core_radiance_options(options, max_depth=max_depth, seed=seed, threads=threads)
    return _core.GrowingCache(core, of_both, tables, begin)


@dataclass(frozen=True)
class State:
    """How far the records are."""

    solving: bool
    """Whether passes of a view are being made."""
    passes_left: int
    """The number of passes that are left of the view."""
    everywhere: bool
    """Whether passes over all surfaces are left."""
    records: int
    """The number of records of irradiance that are read."""


class Growth:
    """The records of a scene, to which those that a view lacks are added.

    The passes are those of `eclat.solve` for a camera, in a thread of its own, one view after another: the latest wish
    counts. Where nobody is left who wished for the view, its passes end. Where no view wants passes, those over all
    surfaces are made if the whole scene is wanted, from when the first viewer has joined; a wish interrupts them.
    """

    def __init__(
        self,
        scene: Scene,
        solution: Solution,
        gloss: GlossSource | None = None,
        *,
        whole: bool = False,
        threads: int = 0,
        seed: int = 0,
    ) -> None:
        """Begin with the records of `solution`, which must belong to the scene; `gloss` has those of radiance."""
        self._scene, self._begun_with = scene, solution
        self._gloss = gloss or GlossSource(scene, solution)
        self._spacing = core_options(solution.options).spacing
        self._cache = growing_cache(scene, solution, threads=threads, seed=seed)
        if whole:
            self._cache.look_everywhere()
        self._whole = whole
        rows = record_rows(self._cache.caches, self._spacing) if len(solution.near) else np.zeros((0, ROW), np.float32)
        self._grown_to = (State(False, 0, self._cache.surfaces_left, len(rows)), rows, self._gloss.records)
        self._grown = False
        self._rays = 0.0
        self._lock = threading.Condition()  # guards what follows, and `_grown_to`
        self._passing = threading.Lock()  # is held while the caches are read or filled
        self._wished: View | None = None
        self._viewers: dict[object, Callable[[], None]] = {}
        self._begun = self._at_surfaces = False
        self._closed = False
        self._progress = _core.Progress()
        self.failure: Exception | None = None
        """What ended the thread, if anything but `close` did."""
        self._thread = threading.Thread(target=self._work, name="eclat view: records", daemon=True)
        self._thread.start()

    def join(self, viewer: object, changed: Callable[[], None]) -> None:
        """Add a viewer; `changed` is called, in another thread, whenever rows or state have changed."""
        with self._lock:
            self._viewers[viewer] = changed
            self._begun = True
            self._lock.notify()

    def leave(self, viewer: object) -> None:
        """Remove a viewer, and drop its wish."""
        with self._lock:
            self._viewers.pop(viewer, None)
            if self._wished is not None and self._wished[0] is viewer:
                self._wished = None

    def wish(self, viewer: object, camera: _core.Camera) -> None:
        """Ask for the records that this view lacks."""
        with self._lock:
            self._wished = (viewer, camera)
            if self._at_surfaces:
                self._progress.cancel()
            self._lock.notify()

    @property
    def grown(self) -> tuple[State, np.ndarray, GlossRecords]:
        """The state, the rows (n, 52) of all records so far (`record_rows`), and the records of radiance, all of one
        moment. Rows only change or are appended; the arrays do not."""
        with self._lock:
            return self._grown_to

    @property
    def rows(self) -> np.ndarray:
        """The rows of all records so far."""
        return self.grown[1]

    @property
    def state(self) -> State:
        """How far the records are."""
        return self.grown[0]

    def solution(self) -> Solution:
        """Return the records so far as a Solution, which waits for the pass that is being made."""
        with self._passing:
            begun = self._begun_with
            if not self._grown:
                return begun
            caches = self._cache.caches
            statistics = {
                "records": float(caches.near_count),
                "far_records": float(caches.far_count),
                "rays": begun.statistics.get("rays", 0.0) + self._rays,
            }
            complete = self._whole and not self._cache.surfaces_left
            return solved_from_core(
                self._scene, begun.options, caches, statistics, max_depth=begun.max_depth, complete=complete
            )

    def close(self) -> None:
        """End the thread, and the pass that it makes."""
        with self._lock:
            self._closed = True
            self._progress.cancel()
            self._lock.notify()
        self._thread.join()

    def _work(self) -> None:
        looking: View | None = None
        try:
            while (found := self._next(looking)) is not None:
                view, surfaces = found
                try:
                    self._pass(None if surfaces or view is looking else view)
                except _core.Cancelled:  # by `close`, or by a wish in the middle of a pass over all surfaces
                    continue
                looking = view
        except Exception as error:  # It is kept for whoever looks for it; the page keeps what it has.
            self.failure = error
            with self._lock:
                self._tell(False, 0)

    def _next(self, looking: View | None) -> tuple[View | None, bool] | None:
        """Wait until there is a pass to make; return the view that is looked at, and whether the pass is over all surfaces;
        or None when this is closed."""
        with self._lock:
            while not self._closed:
                if self._wished is None:
                    self._cache.drop_view()
                self._progress = _core.Progress()
                of_view = self._wished is not None and (self._wished is not looking or self._cache.passes_left > 0)
                self._at_surfaces = not of_view and self._begun and self._cache.surfaces_left
                if of_view or self._at_surfaces:
                    return (self._wished if of_view else looking), self._at_surfaces
                self._tell(False, self._cache.passes_left)
                self._lock.wait()
            return None

    def _pass(self, new: View | None) -> None:
        """Make a pass, of a new view if there is one, and give its records to the viewers."""
        with self._passing:
            if new is not None:
                self._cache.look(new[1])
            self._cache.step(self._progress)
            self._rays += float(self._progress.rays)
            self._grown = True
            rows = record_rows(self._cache.caches, self._spacing)
            gloss = self._gloss.update(self._cache.caches)
        with self._lock:
            self._grown_to = (self._grown_to[0], rows, gloss)
            self._tell(self._cache.passes_left > 0, self._cache.passes_left)

    def _tell(self, solving: bool, left: int) -> None:
        """Set the state and call the viewers; the caller holds the lock."""
        state, rows, gloss = self._grown_to
        now = State(solving, left, self._cache.surfaces_left, len(rows))
        if now == state:
            return
        self._grown_to = (now, rows, gloss)
        for changed in self._viewers.values():
            changed()
