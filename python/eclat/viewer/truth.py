# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of what a page sees, by the core, beside which the page shows its own."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.scene import Scene

MOST_SAMPLES = 1 << 14
"""Number of samples per pixel after which a picture is finished."""

EstimatorMaker = Callable[[], _core.Estimator]
"""Makes what takes the samples of a picture."""


@dataclass(frozen=True)
class TruthSoFar:
    """A picture as two pictures of half the samples each, so that whoever compares can tell their noise from an error."""

    samples: int
    """Number of samples per pixel of both together."""
    halves: tuple[np.ndarray, np.ndarray]
    """(height, width, 3) float32 linear radiance each, row 0 at the top."""


class TruthPicture:
    """A picture by the core, which gets better in a thread of its own until it is stopped."""

    def __init__(
        self,
        camera: _core.Camera,
        size: tuple[int, int],
        make_estimator: EstimatorMaker,
        changed: Callable[[], None],
        *,
        threads: int = 0,
    ) -> None:
        """Begin to render.

        Parameters
        ----------
        size : width and height in pixels.
        make_estimator : is called in the thread of the picture, where it may wait.
        changed : is called in this thread, too, whenever the picture is better.
        """
        self._camera, self._size, self._threads = camera, size, threads
        self._make_estimator, self._changed = make_estimator, changed
        self._progress = _core.Progress()
        self._lock = threading.Lock()
        self._latest: TruthSoFar | None = None
        self.failure: Exception | None = None
        """What ended the thread, if anything but `stop` did."""
        self._thread = threading.Thread(target=self._work, name="eclat view: truth", daemon=True)
        self._thread.start()

    @property
    def latest(self) -> TruthSoFar | None:
        """The picture so far; None at first."""
        with self._lock:
            return self._latest

    def stop(self) -> None:
        """End the thread."""
        self._progress.cancel()
        self._thread.join()

    def _work(self) -> None:
        try:
            self._render(self._make_estimator())
        except _core.Cancelled:
            return  # by `stop`
        except Exception as error:  # It is kept for whoever looks for it; the page keeps the picture so far.
            self.failure = error

    def _render(self, estimator: _core.Estimator) -> None:
        films = [_core.Film(*self._size) for _ in range(2)]
        width, height = self._size
        taken, end = 0, 1
        while 2 * taken < MOST_SAMPLES:
            for seed, film in enumerate(films):
                pixels = _core.RenderRange(
                    crop=(0, 0, width, height),
                    seed=seed,
                    threads=self._threads,
                    filter=_core.Filter.box,
                    tile_order=[],
                )
                begins, ends = (np.array([n], np.uint32) for n in (taken, end))
                _core.render(self._camera, film, estimator, pixels, begins, ends, self._progress)
            taken, end = end, 2 * end
            first, second = (np.array(film.radiance, np.float32) for film in films)
            with self._lock:
                self._latest = TruthSoFar(2 * taken, (first, second))
            self._changed()


def by_paths(scene: Scene, *, max_depth: int, roulette_depth: int) -> _core.Estimator:
    """Make the estimator of path tracing. `eclat render` warns of caustics that no path finds; here is nobody to read it."""
    return _core.path_estimator(compiled(scene).core, max_depth=max_depth, roulette_depth=roulette_depth)
