# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How many samples a picture takes: a given number, until an error is met, or until time is up.

A picture's error is estimated from its two halves, the first n/2 samples of each pixel and the last. They must not be
the even and the odd samples: consecutive Sobol points are stratified against each other, one in each half of every
dimension, so that even and odd means differ by up to three times their true error. The first and the last 2^k points
are a net each, so that their means err (almost) independently.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from eclat import _core
from eclat.metrics import RELATIVE_C
from eclat.running import ProgressReport

FIRST_PASS = 4
MOST_SAMPLES = 1 << 14
"""After which a picture is given up as not converging: at that many even fireflies have become rare."""

EXPECTED_SAMPLES = 64
"""What progress is measured against until there is an estimate."""

SLICE_SECONDS = 0.5
"""Between two pictures that are kept for the case of an interrupt."""

RenderRange = Callable[[int, int, ProgressReport | None], float]
"""Adds samples [first, end) of all pixels to the film; returns the rays it took."""


@dataclass(frozen=True)
class Goal:
    """When to stop: at `samples`, else when `deadline` (of `time.perf_counter`) is near, else at `max_error`."""

    samples: int | None
    max_error: float
    deadline: float | None


class Sampling:
    """Takes the samples of one picture.

    `taken` and `rays` say how far it is, `noise` what error it estimates for its whole passes (NaN before the first
    estimate). With `keep_partial`, `partial` is a copy of the film after `partial_taken` samples of every pixel.
    Values depend on the number of samples only, never on how passes divide them.
    """

    def __init__(
        self, film: _core.Film, render_range: RenderRange, keep_partial: bool, report: ProgressReport | None
    ) -> None:
        self.film, self.render_range, self.keep_partial, self.report = film, render_range, keep_partial, report
        self.taken, self.rays, self.noise = 0, 0.0, math.nan
        self.partial: _core.Film | None = None
        self.partial_taken = 0
        self._seconds_per_sample: float | None = None

    def run(self, goal: Goal) -> None:
        """Sample until the goal is reached."""
        if goal.samples is not None:
            self._expected = goal.samples
            self._pass(goal.samples // 2)
            half = self.film.radiance if goal.samples % 2 == 0 else None
            self._pass(goal.samples)
            if half is not None:
                self.noise = estimated_error(half, self.film.radiance)
        elif goal.deadline is not None:
            self._until(goal.deadline)
        else:
            self._until_error(goal.max_error)

    def _until_error(self, max_error: float) -> None:
        self._expected = EXPECTED_SAMPLES
        while True:
            half = self.film.radiance if self.taken else None
            self._pass(max(FIRST_PASS, 2 * self.taken))
            if half is not None:
                self.noise = estimated_error(half, self.film.radiance)
                if self.noise <= max_error or self.taken >= MOST_SAMPLES:
                    return
                # Noise falls at least with the square root, and the number of samples doubles.
                wanted = self.taken * (self.noise / max_error) ** 2
                doublings = math.ceil(math.log2(max(2.0, min(wanted, MOST_SAMPLES) / self.taken)))
                self._expected = self.taken << doublings

    def _until(self, deadline: float) -> None:
        self._deadline = deadline
        while True:
            before, step = clock.perf_counter(), max(FIRST_PASS, self.taken)
            self._expected = self._reachable(self.taken + step, before)
            self._pass(self.taken + step)
            now = clock.perf_counter()
            left, spent = deadline - now, now - before
            if left < spent * 2:
                # The next pass would take as long as all before, so only a part of it fits.
                extra = int(step * left / max(spent, 1e-9))
                if extra > 0:
                    self._expected = self.taken + extra
                    self._pass(self.taken + extra)
                return

    def _reachable(self, least: int, now: float) -> int:
        if self._seconds_per_sample is None:
            return max(least, EXPECTED_SAMPLES)
        return max(least, self.taken + int((self._deadline - now) / max(self._seconds_per_sample, 1e-9)))

    def _pass(self, end: int) -> None:
        """Take samples until there are `end` of each pixel."""
        while self.taken < end:
            step = end - self.taken
            if self.keep_partial:
                pace = self._seconds_per_sample
                step = min(step, 1 if pace is None else max(1, int(SLICE_SECONDS / max(pace, 1e-9))))
            before = clock.perf_counter()
            self.rays += self.render_range(self.taken, self.taken + step, self._overall(step))
            self._seconds_per_sample = (clock.perf_counter() - before) / step
            self.taken += step
            if self.keep_partial:
                self.partial, self.partial_taken = self.film.copy(), self.taken

    def _overall(self, step: int) -> ProgressReport | None:
        """Reports of one call, as a part of all samples that are expected, and with the rays of all calls."""
        report = self.report
        if report is None:
            return None

        def overall(phase: str, fraction: float, statistics: dict[str, float]) -> None:
            done = (self.taken + fraction * step) / max(self._expected, self.taken + step)
            report(phase, done, statistics | {"rays": self.rays + statistics["rays"], "samples": float(self.taken)})

        return overall


def estimated_error(half: NDArray[np.floating], mean: NDArray[np.floating]) -> float:
    """Relative error (that of `metrics.relative_rmse`) of a picture's noise, from the picture of half its samples.

    sqrt(mean((x₁ − x₂)² / 4 / (R² + c))) with x₁, x₂ the means of the first and the last half, whose own mean is the
    picture: it errs by half their difference. For R², which is not known, stands the mean of x₁ x₂ over 3 × 3 pixels:
    its expectation is right, while that of the picture's own square contains the noise that it is to measure, so
    that noisy pictures would look better than they are.

    Parameters
    ----------
    half, mean : (H, W, 3) means of the first half of the samples of each pixel, and of all.
    """
    first = np.asarray(half, dtype=np.float64)
    last = 2 * np.asarray(mean, dtype=np.float64) - first
    padded = np.pad(first * last, ((1, 1), (1, 1), (0, 0)), mode="edge")
    square = np.maximum(sliding_window_view(padded, (3, 3), axis=(0, 1)).mean(axis=(-1, -2)), 0.0)
    scale = square + RELATIVE_C * square.mean()
    difference = ((first - last) / 2) ** 2
    # Where everything is black there is no error.
    relative = np.divide(difference, scale, out=np.where(difference > 0, np.inf, 0.0), where=scale > 0)
    return float(np.sqrt(relative.mean()))
