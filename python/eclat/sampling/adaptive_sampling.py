# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decides how many samples each pixel takes, so that the picture's error is least for a given total.

The error is the mean over pixels of v / n, with v the variance of one sample relative to the pixel's radiance as in
`metrics.relative_rmse` and n the pixel's samples: for a given sum of n it is least where n goes with √v
[Neyman34]. v is observed as samples arrive, over passes that each double the samples of the picture, so that what one
pass learns decides where the next one goes.

An edge that cuts a sliver off a pixel is missed by few samples, which then agree about the wrong colour; where the
other side is a lamp, such pixels hold most of a picture's error. What their neighbours show is known, though: after n
samples that all missed it, Laplace's rule of succession puts the chance that the next one meets it at 1 / (n + 2), and
the variance that goes with it is taken for true until more samples have refuted it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from eclat.measure.metrics import RELATIVE_C

FASTEST_GROWTH = 8
"""A pixel's samples grow by at most this factor in one pass: few samples do not tell its variance well enough for more."""

LEAST_SHARE = 0.25
"""Share of the mean of √v below which no pixel counts as quieter: its samples may have missed some light."""

Counts = NDArray[np.uint32]
Picture = NDArray[np.floating]


class AdaptiveSamples:
    """The number of samples of each pixel, and the variance estimated from them.

    Parameters
    ----------
    size : (width, height) of the picture.
    region : (x0, y0, x1, y1) of the pixels that are sampled at all, exclusive.

    `counts`, (height, width), are the samples that each pixel has taken.
    """

    def __init__(self, size: tuple[int, int], region: tuple[int, int, int, int]) -> None:
        width, height = size
        x0, y0, x1, y1 = region
        self._region = np.s_[y0:y1, x0:x1]
        self.counts: Counts = np.zeros((height, width), dtype=np.uint32)
        self._mean: Picture | None = None
        self._variance: NDArray[np.float64] | None = None
        self._contrast: NDArray[np.float64] | None = None

    def evenly(self, samples: int) -> Counts:
        """The counts after a pass that brings all pixels to the given number of samples."""
        counts = np.zeros_like(self.counts)
        counts[self._region] = samples
        return counts

    def unevenly(self, samples: int) -> Counts:
        """The counts after a pass that brings the mean over pixels to about the given number, where samples help most.

        Until two passes have been observed, all pixels take the same number.
        """
        if self._variance is None or self._contrast is None:
            return self.evenly(samples)
        taken = self.counts[self._region].astype(np.float64)
        unseen = self._contrast * (taken + 1) / (taken + 2) ** 2  # p (1 − p) with p = 1 / (n + 2)
        weight = np.sqrt(np.maximum(_blurred(self._variance), unseen))
        weight = np.maximum(weight, LEAST_SHARE * weight.mean())
        wanted = samples * taken.size
        if not weight.any():
            return self.evenly(samples)

        def allocated(scale: float) -> NDArray[np.float64]:
            return np.asarray(np.clip(scale * weight, taken, FASTEST_GROWTH * taken))

        # Bisection: the sum grows with the scale, up to the bound of growth that twice the samples cannot reach.
        low, high = 0.0, FASTEST_GROWTH * float((taken / weight).max())
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if allocated(middle).sum() < wanted else (low, middle)
        counts = np.zeros_like(self.counts)
        counts[self._region] = np.floor(allocated(high))
        return counts

    def observe(self, counts: Counts, mean: Picture) -> None:
        """Observe a pass: the samples taken so far, and the resulting picture, shape (height, width, 3)."""
        mean = np.asarray(mean[self._region], dtype=np.float64)
        if self._mean is not None:
            before, after = (c[self._region].astype(np.float64)[..., None] for c in (self.counts, counts))
            added = after - before
            # Means of `before` and of `added` samples differ by the variance of one times 1 / before + 1 / added.
            new = (mean * after - self._mean * before) / np.maximum(added, 1)
            scale = _square(self._mean, new, added > 0, mean)
            single = (new - self._mean) ** 2 * (before * added / np.maximum(after, 1)) / scale
            variance = single.mean(axis=-1)
            seen = added[..., 0] > 0
            # The last pass counts most: samples are stratified, so that the variance of one falls with their number.
            blended = variance if self._variance is None else (self._variance + 3 * variance) / 4
            self._variance = np.where(seen, blended, variance if self._variance is None else self._variance)
            self._contrast = _contrast(mean, scale)
        self.counts, self._mean = counts, mean

    def noise(self) -> float:
        """Estimated relative error (that of `metrics.relative_rmse`) of the picture observed last; NaN before two."""
        if self._variance is None:
            return float("nan")
        taken = np.maximum(self.counts[self._region], 1)
        # The variance is blurred as for the allocation, because pixels that look quiet by chance got few samples.
        return float(np.sqrt((_blurred(self._variance) / taken).mean()))


def _neighbourhood(values: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    """The picture and its eight copies shifted by one pixel. Pixels at the edges are repeated."""
    height, width = values.shape[:2]
    padded = np.pad(values, ((1, 1), (1, 1), *((0, 0) for _ in values.shape[2:])), mode="edge")
    for dy, dx in itertools.product(range(3), range(3)):
        yield padded[dy : dy + height, dx : dx + width]


def _blurred(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(sum(_neighbourhood(values))) / 9


def _square(first: Picture, last: Picture, both: NDArray[np.bool_], mean: Picture) -> NDArray[np.float64]:
    """R² + c, from products of independent pictures where there are both (see `convergence.estimated_error`)."""
    square = np.maximum(_blurred(np.where(both, first * last, mean * mean)), 0.0)
    return np.asarray(np.maximum(square + RELATIVE_C * (mean * mean).mean(), np.finfo(np.float64).tiny))


def _contrast(mean: Picture, scale: NDArray[np.float64]) -> NDArray[np.float64]:
    """The largest relative squared difference to any of the eight neighbours."""
    greatest = np.zeros(mean.shape[:2])
    for neighbour in _neighbourhood(np.asarray(mean, dtype=np.float64)):
        np.maximum(greatest, ((neighbour - mean) ** 2 / scale).mean(axis=-1), out=greatest)
    return greatest
