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
from eclat.methods.records.laws import core_options
from eclat.methods.records.solution import Solution, solved_from_core
from eclat.scene import Scene
from eclat.viewer.record_rows import ROW, record_rows


def empty_solution(scene: Scene, options: Any, max_depth: int = -1) -> Solution:
    """Make a solution without records, with which growth begins."""
    return solved_from_core(
        scene, options, _core.SolvedCaches(), {"records": 0.0, "rays": 0.0}, max_depth=max_depth, complete=False
    )


@dataclass(frozen=True)
class State:
    """How far the records are: whether passes are being made, how many are left of the view, and the records."""

    solving: bool
    passes_left: int
    records: int


class Growth:
    """The records of a scene, to which those that a view lacks are added.

    The passes are those of `eclat.solve` for a camera, in a thread of its own, one view after another: the latest wish
    counts. Where nobody is left who wished for the view, its passes end.
    """

    def __init__(self, scene: Scene, solution: Solution, *, threads: int = 0, seed: int = 0) -> None:
        """Begin with the records of `solution`, which must belong to the scene."""
        self._scene, self._begun_with = scene, solution
        options = core_options(solution.options, max_depth=solution.max_depth, seed=seed, threads=threads)
        begin = solution.core() if len(solution.near) or len(solution.far) else _core.SolvedCaches()
        self._cache = _core.GrowingCache(compiled(scene).core, options, begin)
        self._rows = (
            record_rows(self._cache.caches, options.spacing) if len(solution.near) else np.zeros((0, ROW), np.float32)
        )
        self._spacing = options.spacing
        self._grown = False
        self._rays = 0.0
        self._lock = threading.Condition()  # guards what follows
        self._passing = threading.Lock()  # is held while the caches are read or filled
        self._wished: tuple[object, _core.Camera] | None = None
        self._viewers: dict[object, Callable[[], None]] = {}
        self._closed = False
        self._state = State(False, 0, len(self._rows))
        self._progress = _core.Progress()
        self.failure: Exception | None = None
        """What ended the thread, if anything but `close` did."""
        self._thread = threading.Thread(target=self._work, name="eclat view: records", daemon=True)
        self._thread.start()

    def join(self, viewer: object, changed: Callable[[], None]) -> None:
        """Add a viewer; `changed` is called, in another thread, whenever rows or state have changed."""
        with self._lock:
            self._viewers[viewer] = changed

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
            self._lock.notify()

    @property
    def rows(self) -> np.ndarray:
        """The rows (n, 52) of all records so far (`record_rows`). Rows only change or are appended; the array does not."""
        with self._lock:
            return self._rows

    @property
    def state(self) -> State:
        """How far the records are."""
        with self._lock:
            return self._state

    def solution(self) -> Solution:
        """Return the records so far as a Solution, which waits for the pass that is being made."""
        with self._passing:
            if not self._grown:
                return self._begun_with
            caches = self._cache.caches
            begun = self._begun_with
            statistics = {
                "records": float(caches.near_count),
                "far_records": float(caches.far_count),
                "rays": begun.statistics.get("rays", 0.0) + self._rays,
            }
            return solved_from_core(
                self._scene, begun.options, caches, statistics, max_depth=begun.max_depth, complete=False
            )

    def close(self) -> None:
        """End the thread, and the pass that it makes."""
        with self._lock:
            self._closed = True
            self._progress.cancel()
            self._lock.notify()
        self._thread.join()

    def _work(self) -> None:
        looking: tuple[object, _core.Camera] | None = None
        left = 0
        try:
            while True:
                with self._lock:
                    while not self._closed and (self._wished is None or (self._wished is looking and left == 0)):
                        self._tell(False, left)
                        self._lock.wait()
                    if self._closed:
                        return
                    wished = self._wished
                    self._progress = _core.Progress()
                with self._passing:
                    if wished is not None and wished is not looking:
                        self._cache.look(wished[1])
                        looking = wished
                    self._cache.step(self._progress)
                    self._rays += float(self._progress.rays)
                    self._grown = True
                    rows, left = record_rows(self._cache.caches, self._spacing), int(self._cache.passes_left)
                with self._lock:
                    self._rows = rows
                    self._tell(left > 0, left)
        except _core.Cancelled:
            return  # by `close`
        except Exception as error:  # It is kept for whoever looks for it; the page keeps what it has.
            self.failure = error
            with self._lock:
                self._tell(False, 0)

    def _tell(self, solving: bool, left: int) -> None:
        """Set the state and call the viewers; the caller holds the lock."""
        state = State(solving, left, len(self._rows))
        if state == self._state:
            return
        self._state = state
        for changed in self._viewers.values():
            changed()
