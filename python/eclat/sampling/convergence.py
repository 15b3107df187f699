# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decides how many samples a picture takes: a given number, or until an error is reached, or until the time is over.

The error of a picture is estimated from two halves, the first and the last n/2 samples of each pixel. The even and the
odd samples would not do: consecutive Sobol' points are stratified against each other, with one in each half of every
dimension, so the even and odd means differ by up to three times their true error. The first 2^k points are stratified
among themselves, and so are the last 2^k; the errors of their means are almost independent.

A picture that may be denoised is instead taken in two halves with different seeds (`halves`). They also measure the
error that remains after denoising, and passes continue until this error is small enough.
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
from eclat.bridge.running import ProgressReport
from eclat.measure.metrics import RELATIVE_C
from eclat.sampling.adaptive_sampling import AdaptiveSamples, Counts
from eclat.sampling.denoised_halves import DenoisedHalves
from eclat.sampling.halves import Halves

FIRST_PASS = 4
"""Number of samples per pixel of the first pass."""
FIRST_ADAPTIVE_PASS = 2
"""Number of samples per pixel of the first pass with adaptive sampling; two such passes suffice to distribute the next one."""

MOST_SAMPLES = 1 << 14
"""Largest number of samples per pixel. A picture that has not reached the wanted error by then is not expected to reach
it soon."""

EXPECTED_SAMPLES = 64
"""Number of samples per pixel that progress assumes as the total until there is an estimate."""

LEAST_ROUNDS, FORESIGHT = 8, 16
"""Numbers of rounds after which the measured error of a blend is certain enough to end sampling where it is small, and where it
is clear that sampling will not reach its goal."""

LEAST_JUDGED, LEAST_LEFT = 4, 0.1
"""Number of rounds from which on samples go where the denoiser leaves most of their error, and the least share of the error that
it is taken to leave. Fewer rounds say little about what it leaves of a window."""

SLICE_SECONDS = 0.5
"""Seconds between two copies of the picture that are kept in case of an interrupt."""

MOST_GAIN = 16.0
"""Largest ratio of the noise to the wanted error at which denoising is tried. The denoiser reduces the error by a
smaller factor: at 4 samples by 4 in a furnished room, and by 10 in the Cornell box."""

RenderRange = Callable[[Counts, Counts, ProgressReport | None], float]
"""A function that adds samples [first, end) to the film, or to each half of it, and returns the number of rays. Both are
arrays with one number for each pixel, or with one number for all pixels."""


@dataclass(frozen=True)
class Goal:
    """The condition at which sampling stops.

    If `samples` is given, sampling stops at that number of samples per pixel, which with adaptive sampling is the mean
    over pixels. Otherwise, if `deadline` is given, it stops at that value of `time.perf_counter`. Otherwise it stops
    when the relative error is below `max_error`; with `denoised`, this is the error of the denoised picture. It also stops at
    `most_samples`, or `MOST_SAMPLES` if that is None. With `blended`, which says that the picture is blended with another one,
    sampling takes at least `LEAST_ROUNDS`, and stops as soon as it is clear that these samples do not suffice.

    `gathered_samples` is the number of samples per pixel of the final gather that is added to a picture of records; None adds as
    many as `max_error` needs.
    """

    samples: int | None
    max_error: float
    deadline: float | None
    denoised: bool = False
    most_samples: int | None = None
    blended: bool = False
    gathered_samples: int | None = None


def noise_beside_records(max_error: float, records: float) -> float:
    """Return the noise at which sampling stops, for a wanted error of the picture and the estimated error of its records.

    Squared errors add up. The noise gets what the records leave of the wanted error, and at least half of its square. If the
    records have more than the wanted error, noise of half of their error adds only an eighth to the error of the picture,
    and less noise would take many samples for nothing.
    """
    left = max_error * math.sqrt(max(0.5, 1 - (records / max_error) ** 2))
    return max(left, records / 2)


class Sampling:
    """Takes the samples of one picture.

    `taken` is the number of samples per pixel so far, `rays` the number of rays, and `noise` the relative error
    estimated after the last complete pass (NaN before the first estimate). `found` is the picture and error that were
    computed from the halves, and `denoised` tells whether it is the denoised picture. `after_pass` is called between
    passes. With `by_denoised`, adaptive sampling goes by the error that is left after denoising. With `keep_partial`,
    `partial` is a copy of the film after `partial_taken` samples per pixel. The values of the picture depend only on the
    number of samples, and not on how passes divide them: with adaptive sampling, each pass except the last doubles the
    number of samples.

    Internally, samples are counted in rounds: a round is one sample of the film, or one of each half.
    """

    def __init__(
        self,
        film: _core.Film | Halves,
        render_range: RenderRange,
        keep_partial: bool,
        report: ProgressReport | None,
        adaptive: AdaptiveSamples | None = None,
        after_pass: Callable[[], None] | None = None,
        by_denoised: bool = False,
    ) -> None:
        self.film, self.render_range, self.keep_partial, self.report = film, render_range, keep_partial, report
        self.adaptive, self.after_pass = adaptive, after_pass
        self._halves = film if isinstance(film, Halves) else None
        self._by_denoised = by_denoised and adaptive is not None and self._halves is not None
        self._each = 1 if self._halves is None else self._halves.each
        self._first = (FIRST_PASS if adaptive is None else FIRST_ADAPTIVE_PASS) // self._each
        self.rays, self.noise = 0.0, math.nan
        self.found: DenoisedHalves | None = None
        self.denoised = False
        self.partial: _core.Film | Halves | None = None
        self.partial_taken = 0
        self._rounds, self._looked_at = 0, 0
        self._noise_around: NDArray[np.float64] | None = None  # error around each pixel, before denoising
        self._counts = _everywhere(0) if adaptive is None else adaptive.counts
        self._deadline = math.inf
        self._seconds_per_sample: float | None = None
        self._seconds_of_look, self._seconds_of_estimate = 0.0, 0.0

    @property
    def taken(self) -> int:
        """The number of samples per pixel so far, averaged over the pixels."""
        return self._rounds * self._each

    @property
    def error(self) -> float:
        """The relative error of the picture as it would be shown now, without errors that do not appear as noise; NaN
        before the first estimate.
        """
        return self.noise if self.found is None else self.found.estimate.quoted

    def run(self, goal: Goal) -> None:
        """Take samples until the goal is reached."""
        if goal.samples is not None:
            self._until_samples(-(-goal.samples // self._each))
        elif goal.deadline is not None:
            self._until(goal.deadline, goal.denoised)
        else:
            self._until_error(goal)
            if not goal.blended:
                return
        self.look(goal.denoised)

    def take_up(self, taken: int) -> None:
        """Go on from a film, and from adaptive sampling, that already have `taken` samples per pixel."""
        self._rounds, self._noise_around = taken // self._each, None
        if self.adaptive is not None:
            self._counts = self.adaptive.counts

    def _until_samples(self, rounds: int) -> None:
        self._expected = rounds
        if self.adaptive is not None:
            while self._rounds < rounds:
                self._pass(min(rounds, max(self._first, 2 * self._rounds)))
        else:
            if rounds // 2 > self._rounds:
                self._pass(rounds // 2)
            self._pass(rounds)

    def _until_error(self, goal: Goal) -> None:
        max_error, denoised = goal.max_error, goal.denoised
        self._expected = EXPECTED_SAMPLES // self._each
        most = (goal.most_samples or MOST_SAMPLES) // self._each
        while True:
            self._pass(max(self._first, 2 * self._rounds))
            if not math.isnan(self.noise):
                given_up = self._rounds >= most
                wants_look = denoised and (goal.blended or self.error > max_error)
                if wants_look and (given_up or self.noise <= MOST_GAIN * max_error):
                    self.look(True)
                # The noise decreases at most with the square root of the number of samples, which doubles in each pass.
                wanted = self._rounds * (self.error / max_error) ** 2
                certain = self._rounds * ((self.noise if self.found is None else self.found.error) / max_error) ** 2
                foreseen = goal.blended and self._rounds >= FORESIGHT and certain > most
                early = goal.blended and self._rounds < LEAST_ROUNDS
                if (self.error <= max_error and not early) or given_up or foreseen:
                    return
                doublings = math.ceil(math.log2(max(2.0, min(wanted, most) / self._rounds)))
                self._expected = self._rounds << doublings
            self._tell()

    def _until(self, deadline: float, denoised: bool) -> None:
        self._deadline = deadline
        looks = denoised  # The first measurement shows how long the last one will take.
        while self._rounds == 0 or self._affordable() >= 1:
            self._expected = self._rounds + max(1, self._affordable())
            self._pass(max(self._first, 2 * self._rounds))
            self.look(looks)
            looks = False
            self._tell()

    def look(self, denoised: bool) -> None:
        """Compute the picture to show and its error from the halves."""
        if self._halves is None or (self._looked_at == self._rounds and self.denoised == denoised):
            return
        before = clock.perf_counter()
        self.found = self._halves.denoised() if denoised else self._halves.sampled()
        self.denoised, self._looked_at = denoised, self._rounds
        if not denoised:
            self.noise, self._noise_around = self.found.error, self.found.local_error
        else:
            self._seconds_of_look = max(self._seconds_of_look, clock.perf_counter() - before)

    def _affordable(self) -> int:
        """Return the number of samples per pixel for which there is time, after reserving time for the estimate of the
        error that follows the last pass, and for the picture to show."""
        if self._seconds_per_sample is None or self._deadline == math.inf:
            return EXPECTED_SAMPLES
        left = self._deadline - clock.perf_counter() - self._seconds_of_look - self._seconds_of_estimate
        return max(0, int(left / max(self._seconds_per_sample, 1e-9)))

    def _step(self, end: int) -> int:
        """Return the number of samples per pixel to take before the time is checked again."""
        step, pace = end - self._rounds, self._seconds_per_sample
        if self._deadline < math.inf:
            # Half of the samples for which there is time are taken, then half of the rest, and so on, so that the time
            # of the last samples is predicted from recent ones.
            step = min(step, 1 if pace is None else max(1, self._affordable() // 2))
        if self.keep_partial:
            step = min(step, 1 if pace is None else max(1, int(SLICE_SECONDS / max(pace, 1e-9))))
        return step

    def _pass(self, end: int) -> None:
        """Take samples until each pixel, or the mean over pixels, has `end` of them; take fewer if the deadline is near."""
        half = self.film.radiance if self._rounds and end == 2 * self._rounds else None
        left = self._share_left()
        while self._rounds < end and (self._rounds == 0 or self._affordable() >= 1):
            step = self._step(end)
            first, last = _everywhere(self._rounds), _everywhere(self._rounds + step)
            if self.adaptive is not None:
                # The number of samples of each pixel increases with the mean number, so the parts of a pass add up to
                # the whole pass.
                first, last = self._counts, self.adaptive.unevenly(self._rounds + step, left)
                self._counts = last
            before = clock.perf_counter()
            self.rays += self.render_range(first.ravel(), last.ravel(), self._overall(step))
            self._seconds_per_sample = (clock.perf_counter() - before) / step
            self._rounds += step
            if self.keep_partial:
                self.partial, self.partial_taken = self.film.copy(), self.taken
        before = clock.perf_counter()
        self._estimate(half if self._rounds == end else None)
        self._seconds_of_estimate = max(self._seconds_of_estimate, clock.perf_counter() - before)

    def _share_left(self) -> NDArray[np.float64] | None:
        """Return the share of the error around each pixel that the denoiser leaves, if the next pass goes by it.

        It depends on the samples so far alone, so that pictures can be repeated and continued.
        """
        if not self._by_denoised or self._rounds < LEAST_JUDGED:
            return None
        if self._noise_around is None:
            self.look(False)
        self.look(True)
        assert self.found is not None and self._noise_around is not None
        noise, left = self._noise_around, self.found.local_error
        return np.clip(np.divide(left, noise, out=np.ones_like(noise), where=noise > 0), LEAST_LEFT, 1.0)

    def _tell(self) -> None:
        if self.after_pass is not None:
            self.after_pass()

    def _estimate(self, half: NDArray[np.floating] | None) -> None:
        """Estimate the noise of the samples so far; `half` is the picture of the first half of them, or None if
        unknown."""
        if self.adaptive is not None:
            self.adaptive.observe(self._counts, self.film.radiance)
            self.noise = self.adaptive.noise()
        if self._halves is not None:
            self.look(False)
        elif self.adaptive is None and half is not None:
            self.noise = estimated_error(half, self.film.radiance)

    def _overall(self, step: int) -> ProgressReport | None:
        """Make a progress function for one call, which reports the fraction of all expected samples and the rays of all
        calls."""
        report = self.report
        if report is None:
            return None

        def overall(phase: str, fraction: float, statistics: dict[str, float]) -> None:
            done = (self._rounds + fraction * step) / max(self._expected, self._rounds + step)
            so_far = {"rays": self.rays + statistics["rays"], "samples": float(self.taken)}
            if not math.isnan(self.error):
                so_far["error"] = self.error
            report(phase, done, statistics | so_far)

        return overall


def _everywhere(samples: int) -> Counts:
    return np.array([samples], dtype=np.uint32)


def estimated_error(half: NDArray[np.floating], mean: NDArray[np.floating]) -> float:
    """Estimate the relative error of a picture that is due to noise, as in `metrics.relative_rmse`, from half of its
    samples.

    The estimate is sqrt(mean((x₁ − x₂)² / 4 / (R² + c))), where x₁ and x₂ are the means of the first and of the last
    half of the samples. The picture is the mean of both, so its error is half their difference. The unknown R² is
    replaced by the mean of x₁ x₂ over 3 × 3 pixels, which is unbiased. The square of the picture itself would contain
    the noise, and the error of noisy pictures would be underestimated.

    Parameters
    ----------
    half, mean : (H, W, 3) means of the first half of the samples of each pixel, and of all its samples.
    """
    first = np.asarray(half, dtype=np.float64)
    last = 2 * np.asarray(mean, dtype=np.float64) - first
    padded = np.pad(first * last, ((1, 1), (1, 1), (0, 0)), mode="edge")
    square = np.maximum(sliding_window_view(padded, (3, 3), axis=(0, 1)).mean(axis=(-1, -2)), 0.0)
    scale = square + RELATIVE_C * square.mean()
    difference = ((first - last) / 2) ** 2
    # A picture that is black everywhere has no error.
    relative = np.divide(difference, scale, out=np.where(difference > 0, np.inf, 0.0), where=scale > 0)
    return float(np.sqrt(relative.mean()))
