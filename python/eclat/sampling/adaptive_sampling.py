# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decides how many samples each pixel takes, so that the error of the picture is smallest for a given total number of
samples.

The squared error is the mean over pixels of v / n, where v is the variance of one sample, relative to the radiance of
the pixel as in `metrics.relative_rmse`, and n the number of samples of the pixel. For a given sum of n it is smallest
if n is proportional to √v [Neyman34]. v is estimated from the samples taken so far, in passes that each double the
samples of the picture; each pass distributes its samples according to the estimates of the passes before.

If an edge cuts off a small part of a pixel, a few samples may all miss this part and agree about the wrong colour. If a
lamp is on the other side of the edge, such pixels cause most of the error of a picture. The colour on the other side is
known from the neighbouring pixels, though. After n samples that all missed it, the probability that the next sample
hits it is 1 / (n + 2) by Laplace's rule of succession; the variance that follows from this probability is used until
more samples show a smaller one.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from eclat.measure.metrics import RELATIVE_C

FASTEST_GROWTH = 8
"""Largest factor by which one pass multiplies the number of samples of a pixel, because the variance that few samples
show is not reliable enough for more."""

LEAST_SHARE = 0.25
"""Lower bound of √v of a pixel, relative to its mean over the picture, because the samples of a pixel without visible
noise may have missed some light."""

Counts = NDArray[np.uint32]
Picture = NDArray[np.floating]


class AdaptiveSamples:
    """The number of samples of each pixel, and the variance estimated from them.

    Parameters
    ----------
    size : (width, height) of the picture.
    region : rectangle (x0, y0, x1, y1) of the pixels that are sampled, x1 and y1 exclusive.

        `counts`, (height, width), are the numbers of samples that the pixels have taken.
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
        """Return the counts after a pass that brings all pixels to the given number of samples."""
        counts = np.zeros_like(self.counts)
        counts[self._region] = samples
        return counts

    def unevenly(self, samples: int) -> Counts:
        """Return the counts after a pass that brings their mean over pixels to about the given number, distributed so
        that the error decreases most.

        Until two passes have been observed, all pixels get the same number of samples.
        """
        if self._variance is None or self._contrast is None:
            return self.evenly(samples)
        taken = self.counts[self._region].astype(np.float64)
        unseen = self._contrast * (taken + 1) / (taken + 2) ** 2  # The variance is p (1 − p) with p = 1 / (n + 2).
        weight = np.sqrt(np.maximum(_blurred(self._variance), unseen))
        weight = np.maximum(weight, LEAST_SHARE * weight.mean())
        wanted = samples * taken.size
        if not weight.any():
            return self.evenly(samples)

        def allocated(scale: float) -> NDArray[np.float64]:
            return np.asarray(np.clip(scale * weight, taken, FASTEST_GROWTH * taken))

        # The scale is found by bisection: the sum increases with it, and at the upper end it is at least
        # `FASTEST_GROWTH` times as large, so twice the samples are always reached.
        low, high = 0.0, FASTEST_GROWTH * float((taken / weight).max())
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if allocated(middle).sum() < wanted else (low, middle)
        counts = np.zeros_like(self.counts)
        counts[self._region] = np.floor(allocated(high))
        return counts

    def observe(self, counts: Counts, mean: Picture) -> None:
        """Update the variance after a pass, from the samples taken so far and the resulting picture (height, width,
        3)."""
        mean = np.asarray(mean[self._region], dtype=np.float64)
        if self._mean is not None:
            before, after = (c[self._region].astype(np.float64)[..., None] for c in (self.counts, counts))
            added = after - before
            # The variance of the difference between the means of `before` and of `added` samples is that of one sample
            # times 1 / before + 1 / added.
            new = (mean * after - self._mean * before) / np.maximum(added, 1)
            scale = _square(self._mean, new, added > 0, mean)
            single = (new - self._mean) ** 2 * (before * added / np.maximum(after, 1)) / scale
            variance = single.mean(axis=-1)
            seen = added[..., 0] > 0
            # The last pass has the largest weight, because samples are stratified, so their variance decreases with
            # their number.
            blended = variance if self._variance is None else (self._variance + 3 * variance) / 4
            kept = np.where(seen, blended, variance if self._variance is None else self._variance)
            # Files hold these with single precision, and a picture that is taken up from one must go on in the same way.
            self._variance, self._contrast = _single(kept), _single(_contrast(mean, scale))
        self.counts, self._mean = counts, mean

    def state(self) -> dict[str, NDArray[np.float32]]:
        """Return what `restore` needs besides the picture: `counts`, and `variance` and `contrast` if there are any, over the
        whole picture (height, width)."""
        known = {"counts": self.counts[self._region], "variance": self._variance, "contrast": self._contrast}
        state = {}
        for name, values in known.items():
            if values is not None:
                state[name] = np.zeros(self.counts.shape, np.float32)
                state[name][self._region] = values
        return state

    def restore(
        self,
        counts: NDArray[np.float32],
        mean: Picture,
        variance: NDArray[np.float32] | None,
        contrast: NDArray[np.float32] | None,
    ) -> None:
        """Go on from a picture (height, width, 3) and from what `state` gave for it."""
        self.counts = counts.astype(np.uint32)
        self._mean = np.asarray(mean[self._region], dtype=np.float64)
        if variance is not None and contrast is not None:
            self._variance, self._contrast = (v[self._region].astype(np.float64) for v in (variance, contrast))

    def noise(self) -> float:
        """Estimate the relative error of the last picture from its noise, as in `metrics.relative_rmse`; NaN before the
        second."""
        if self._variance is None:
            return float("nan")
        taken = np.maximum(self.counts[self._region], 1)
        # The variance is blurred, as for the allocation, because pixels that show little noise by chance got few
        # samples.
        return float(np.sqrt((_blurred(self._variance) / taken).mean()))


def _neighbourhood(values: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    """Yield the picture and its eight copies that are shifted by one pixel; pixels at the border are repeated."""
    height, width = values.shape[:2]
    padded = np.pad(values, ((1, 1), (1, 1), *((0, 0) for _ in values.shape[2:])), mode="edge")
    for dy, dx in itertools.product(range(3), range(3)):
        yield padded[dy : dy + height, dx : dx + width]


def _single(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Round to single precision."""
    return values.astype(np.float32).astype(np.float64)


def _blurred(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(sum(_neighbourhood(values))) / 9


def _square(first: Picture, last: Picture, both: NDArray[np.bool_], mean: Picture) -> NDArray[np.float64]:
    """Estimate R² + c, from the product of two independent pictures where `both` is True (see
    `convergence.estimated_error`)."""
    square = np.maximum(_blurred(np.where(both, first * last, mean * mean)), 0.0)
    return np.asarray(np.maximum(square + RELATIVE_C * (mean * mean).mean(), np.finfo(np.float64).tiny))


def _contrast(mean: Picture, scale: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the largest relative squared difference of each pixel from its eight neighbours."""
    greatest = np.zeros(mean.shape[:2])
    for neighbour in _neighbourhood(np.asarray(mean, dtype=np.float64)):
        np.maximum(greatest, ((neighbour - mean) ** 2 / scale).mean(axis=-1), out=greatest)
    return greatest
