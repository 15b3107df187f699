# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decides how many samples each pixel takes, so that the error of the picture is smallest for a given total number of
samples.

The squared error is the mean over pixels of v / n, where v is the variance of one sample, relative to the radiance of
the pixel as in `metrics.relative_rmse`, and n the number of samples of the pixel. For a given sum of n it is smallest
if n is proportional to √v [Neyman34]. v is estimated from the samples taken so far, in passes that each double the
samples of the picture; each pass distributes its samples according to the estimates of the passes before.

The number of samples of a pixel does not depend on its own samples: v is the mean over its eight neighbours, relative
to their radiance. Otherwise, a pixel that found rare light by chance would get many more samples, in whose mean this
light has little weight, while a pixel that missed it would keep its few samples, so that the picture would be too dark.
A smaller bias remains, because the neighbours of such a pixel get more samples. If one sample in a hundred finds all
the light, pictures are a fifth too dark with 16 samples, a twentieth with 64, and correct with 256; if one sample in
ten finds it, they are 1 % too dark with 16.

If an edge cuts off a small part of a pixel, a few samples may all miss this part and agree about the wrong colour. If a
lamp is on the other side of the edge, such pixels cause most of the error of a picture. The colour on the other side is
known from the neighbouring pixels, though, which lie on both sides. After n samples that all missed it, the probability
that the next sample hits it is 1 / (n + 2) by Laplace's rule of succession; the variance that follows from this
probability is used until more samples show a smaller one.

Where a picture is denoised, noise counts as far as the denoiser leaves it: a wall that it cleans needs few samples, and a window
frame as many as without it. √v is then multiplied by the share of the error around the pixel that the denoiser leaves
(`convergence.Sampling`), because more samples reduce the error that is left about as they reduce the noise.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, did_you_mean
from eclat.images import denoiser
from eclat.measure.metrics import RELATIVE_C

FASTEST_GROWTH = 4
"""Largest factor by which one pass multiplies the number of samples of a pixel, because the variance that few samples
show is not reliable enough for more. With 3 `cornell-box` errs by a fifth more at 16 samples; with 8 no less, and light
that one sample in a hundred finds loses a tenth more."""

LEAST_SHARE = 0.25
"""Lower bound of √v of a pixel, relative to its mean over the picture, because the samples of a pixel without visible
noise may have missed some light."""

Counts = NDArray[np.uint32]
Picture = NDArray[np.floating]

Adaptive = Literal[False, "noise", "denoised"]
"""By what error pixels get more or fewer samples: by none, by their noise, or by what a denoiser leaves of it."""

ERRORS = ("noise", "denoised")


def checked_adaptive(given: bool | str, denoised: bool, halves: bool) -> Adaptive:
    """Return by what error pixels get their samples, for an argument of the verb `render`.

    Parameters
    ----------
    given : the argument. True stands for "denoised" or "noise", as `denoised` says.
    halves : whether the picture is taken in halves.

    Raises
    ------
    EclatError : the name is unknown, or the error is that after a denoiser, which is not installed or needs halves.
    """
    if given is False or given == "noise":
        return given
    if given is True:
        return "denoised" if denoised else "noise"
    if given != "denoised":
        expected = " or ".join(map(repr, ERRORS))
        raise EclatError(f"adaptive: expected True, False, {expected}, got {given!r}{did_you_mean(given, ERRORS)}")
    denoiser.require_denoiser()
    if not halves:
        raise EclatError(
            "adaptive: expected denoising or halves=True with 'denoised', because the halves measure that error, got neither"
        )
    return "denoised"


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
        self._variance_around: NDArray[np.float64] | None = None
        self._contrast: NDArray[np.float64] | None = None

    def evenly(self, samples: int) -> Counts:
        """Return the counts after a pass that brings all pixels to the given number of samples."""
        counts = np.zeros_like(self.counts)
        counts[self._region] = samples
        return counts

    def unevenly(self, samples: int, left: NDArray[np.float64] | None = None) -> Counts:
        """Return the counts after a pass that brings their mean over pixels to about the given number, distributed so
        that the error decreases most.

        `left`, (height, width) of the region, is the share of the error around each pixel that a denoiser leaves; None means
        that nothing is denoised.

        Until two passes have been observed, all pixels get the same number of samples.
        """
        if self._variance_around is None or self._contrast is None:
            return self.evenly(samples)
        taken = self.counts[self._region].astype(np.float64)
        unseen = self._contrast * (taken + 1) / (taken + 2) ** 2  # The variance is p (1 − p) with p = 1 / (n + 2).
        weight = np.sqrt(np.maximum(self._variance_around, unseen))
        if left is not None:
            weight *= left
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
            both = np.where(added > 0, self._mean * new, mean * mean)
            scale = _scale(_blurred(both), mean)
            single = (new - self._mean) ** 2 * (before * added / np.maximum(after, 1))
            scale_around = _scale(_around(both), mean)
            variance = (single / scale).mean(axis=-1)
            seen = added[..., 0] > 0
            seen_around = _around(seen.astype(np.float64))
            variance_around = (_around(single) / scale_around).mean(axis=-1) / np.maximum(seen_around, 1 / 8)
            # Files hold these with single precision, and a picture that is taken up from one must go on in the same way.
            self._variance = _single(_blended(self._variance, variance, seen))
            self._variance_around = _single(_blended(self._variance_around, variance_around, seen_around > 0))
            self._contrast = _single(_contrast(mean, scale_around))
        self.counts, self._mean = counts, mean

    def state(self) -> dict[str, NDArray[np.float32]]:
        """Return the arrays that `restore` needs in addition to the picture: `counts` and, if they exist, `variance`,
        `variance_around` and `contrast`, all over the whole picture (height, width).
        """
        known = {
            "counts": self.counts[self._region],
            "variance": self._variance,
            "variance_around": self._variance_around,
            "contrast": self._contrast,
        }
        state = {}
        for name, values in known.items():
            if values is not None:
                state[name] = np.zeros(self.counts.shape, np.float32)
                state[name][self._region] = values
        return state

    def restore(self, state: Mapping[str, NDArray[np.float32]], mean: Picture) -> None:
        """Continue from a picture (height, width, 3) and the arrays that `state` returned for it."""
        self.counts = state["counts"].astype(np.uint32)
        self._mean = np.asarray(mean[self._region], dtype=np.float64)
        if "contrast" in state:
            self._variance, self._variance_around, self._contrast = (
                state[name][self._region].astype(np.float64) for name in ("variance", "variance_around", "contrast")
            )

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
    yield values
    yield from _neighbours(values, "edge")


def _neighbours(values: NDArray[np.float64], border: Literal["edge", "reflect"]) -> Iterator[NDArray[np.float64]]:
    """Yield eight copies of the picture, each shifted by one pixel. Pixels at the border are repeated beyond it; with
    "reflect", the pixels next to them are used instead, so that no pixel is its own neighbour.
    """
    height, width = values.shape[:2]
    if border == "reflect" and min(height, width) < 2:
        border = "edge"  # There is nothing beside it.
    padded = np.pad(values, ((1, 1), (1, 1), *((0, 0) for _ in values.shape[2:])), mode=border)
    for dy, dx in itertools.product(range(3), range(3)):
        if (dy, dx) != (1, 1):
            yield padded[dy : dy + height, dx : dx + width]


def _single(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Round to single precision."""
    return values.astype(np.float32).astype(np.float64)


def _blurred(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(sum(_neighbourhood(values))) / 9


def _around(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the mean over the eight neighbours of each pixel, without its own value."""
    return np.asarray(sum(_neighbours(values, "reflect"))) / 8


def _blended(
    before: NDArray[np.float64] | None, now: NDArray[np.float64], seen: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Combine the variances of earlier passes with those of the last pass at the pixels that it sampled, which `seen`
    marks.

    The last pass has the largest weight, because samples are stratified, so their variance decreases with their number.
    """
    return now if before is None else np.where(seen, (before + 3 * now) / 4, before)


def _scale(square: Picture, mean: Picture) -> NDArray[np.float64]:
    """Compute R² + c from the picture and an estimate of its square, such as the product of two independent pictures (see
    `convergence.estimated_error`)."""
    return np.asarray(
        np.maximum(np.maximum(square, 0.0) + RELATIVE_C * (mean * mean).mean(), np.finfo(np.float64).tiny)
    )


def _contrast(mean: Picture, scale: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the relative squared difference between the brightest and the darkest neighbour of each pixel."""
    values = np.asarray(mean, dtype=np.float64)
    least, most = np.full_like(values, np.inf), np.full_like(values, -np.inf)
    for neighbour in _neighbours(values, "reflect"):
        np.minimum(least, neighbour, out=least)
        np.maximum(most, neighbour, out=most)
    return np.asarray(((most - least) ** 2 / scale).mean(axis=-1))
