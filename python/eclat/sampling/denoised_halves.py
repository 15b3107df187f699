# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A denoised picture whose error is measured, without a reference.

Symbol    name here    meaning
  A, B    a, b         two halves of the samples of a picture: unbiased, with independent noise
  d(A)    denoised_a   the half A denoised, by a denoiser that has not seen B
  m       mean         (d(A) + d(B)) / 2
  R       –            the picture without noise, which nobody knows

d(A) is independent of B, so that the mean of (d(A) − B)² is that of (d(A) − R)² and the variance of B, and likewise with A
and B exchanged. (A − B)² has the variances of both. Hence

    ½ [(d(A) − B)² + (d(B) − A)² − (A − B)²] − ¼ (d(A) − d(B))²

has the expectation of (m − R)²: it is an unbiased estimate of the squared error of m, whatever the denoiser does. It needs
the independence of the halves and nothing else. What both halves share, the error of a cache that both read, it cannot see.

Where the denoiser does more harm than good, the picture as sampled is kept: with s = w m + (1 − w) (A + B) / 2 the formula
holds as well, if d(A) is replaced by w d(A) + (1 − w) A, and so does a parabola in w through its values for w = 0, ½ and 1.
The best w is found in windows of `WINDOW` pixels and varies smoothly between them. Choosing pixel by pixel would pick lucky
estimates, which would then be too low.

The estimate of the squared difference is unbiased; that it is relative adds a bias. R² + c is taken from what is shown, so
that where a denoiser carries much light into dark pixels their relative error is told too low, by a quarter in the worst
picture of the tests.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray

from eclat.errors import EclatError
from eclat.measure.metrics import RELATIVE_C

Float64 = NDArray[np.float64]
WINDOW = 32
"""Pixels along a side of the windows in which one weight is chosen; a thousand pixels make the choice hardly lucky."""


@dataclass(frozen=True, eq=False)
class DenoisedHalves:
    """The picture to show, with its estimated error.

    `pixels` is (H, W, 3); `weight`, (H, W) in 0..1, is the denoiser's part of it. `squared_error` is the estimated mean of
    (s − R)² / (R² + c) over pixels and channels, which may come out below 0, and `deviation` its standard error, from how
    much windows differ. `raw_squared_error` is that of the picture as sampled, (A + B) / 2.
    """

    pixels: Float64
    weight: Float64
    squared_error: float
    deviation: float
    raw_squared_error: float

    @property
    def error(self) -> float:
        """Relative error of the picture, the measure of `metrics.relative_rmse`."""
        return math.sqrt(max(0.0, self.squared_error))

    @property
    def error_deviation(self) -> float:
        """Standard error of `error`; that of an error which is not told from 0 is the root of the square's."""
        return min(math.sqrt(self.deviation), self.deviation / (2 * self.error) if self.error > 0 else math.inf)


def judged_halves(a: ArrayLike, b: ArrayLike, denoised_a: ArrayLike, denoised_b: ArrayLike) -> DenoisedHalves:
    """The mean of two halves of a picture, denoised where that reduces the error, and the error that remains.

    Parameters
    ----------
    a, b : (H, W, 3) linear radiance, means of equally many samples, whose noise must be independent: of two seeds. Halves
        of one Sobol' sequence are not.
    denoised_a, denoised_b : (H, W, 3) the same without noise; each must depend on its own half alone, also for what guides
        the denoiser.

    Raises
    ------
    EclatError : shapes differ.
    """
    halves = tuple(np.asarray(picture, np.float64) for picture in (a, b, denoised_a, denoised_b))
    shapes = [half.shape for half in halves]
    if len(shapes[0]) != 3 or shapes[0][2] != 3 or len(set(shapes)) != 1:
        raise EclatError(f"denoise: expected halves of one shape (height, width, 3), got {shapes}")
    a, b, denoised_a, denoised_b = halves
    products = (np.minimum(denoised_a, denoised_b) ** 2, a * b)
    scale = _scale(*products, 0.5)
    weight = _best_weights([_squared_error(halves, w, scale) for w in (0.0, 0.5, 1.0)])
    scale = _scale(*products, weight[..., None])
    squared = _squared_error(halves, weight[..., None], scale)
    pixels = weight[..., None] * (denoised_a + denoised_b) / 2 + (1 - weight[..., None]) * (a + b) / 2
    means = _window_means(squared)
    counts = _window_means(np.ones_like(squared), total=True)
    deviation = math.sqrt(float(np.average((means - squared.mean()) ** 2, weights=counts)) / max(1, means.size - 1))
    raw = _squared_error(halves, 0.0, scale)
    return DenoisedHalves(pixels, weight, float(squared.mean()), deviation, float(raw.mean()))


def _scale(denoised: Float64, sampled: Float64, weight: Float64 | float) -> Float64:
    """R² + c as far as it is known: where the denoised halves are shown, the square of the darker one, since at edges, where
    most of the error is, denoisers carry light to the dark side; elsewhere the product of the halves, over 3 × 3 pixels, which
    is not too large by their noise. In a furnished room the former gives 96 to 98 % of the error that the true R² gives, the
    product of the denoised halves 87 to 91 %."""
    square = np.maximum(weight * denoised + (1 - weight) * _mean_of_nine(sampled), 0.0)
    return np.asarray(np.maximum(square + RELATIVE_C * square.mean(), np.finfo(np.float64).tiny))


def _squared_error(halves: tuple[Float64, ...], weight: Float64 | float, scale: Float64) -> Float64:
    """(H, W) the formula above, relative, for a weight of the denoiser; single pixels may well be below 0."""
    a, b, denoised_a, denoised_b = halves
    shown_a, shown_b = (weight * d + (1 - weight) * x for d, x in ((denoised_a, a), (denoised_b, b)))
    squares = (shown_a - b) ** 2 + (shown_b - a) ** 2 - (a - b) ** 2
    error = 0.5 * squares - 0.25 * (shown_a - shown_b) ** 2
    return np.asarray((error / scale).mean(axis=-1))


def _mean_of_nine(values: Float64) -> Float64:
    """The mean of each pixel and its eight neighbours; edges repeat."""
    padded = np.pad(values, ((1, 1), (1, 1), (0, 0)), mode="edge")
    return np.asarray(sliding_window_view(padded, (3, 3), axis=(0, 1)).mean(axis=(-1, -2)))


def _best_weights(errors: list[Float64]) -> Float64:
    """(H, W) weights in 0..1 that make the error of each window least, smooth between the windows' centres.

    `errors` are those for the weights 0, ½ and 1: with f the error as a parabola in w,
    w = (3 f(0) − 4 f(½) + f(1)) / (4 f(0) − 8 f(½) + 4 f(1)). A window's own estimate counts with those of its neighbours.
    """
    raw, half, full = (_blurred(_window_means(error)) for error in errors)
    slope, bend = 3 * raw - 4 * half + full, 4 * raw - 8 * half + 4 * full
    inside = np.divide(slope, bend, out=np.zeros_like(slope), where=bend > 0)
    weights = np.where(bend > 0, np.clip(inside, 0.0, 1.0), np.where(full <= raw, 1.0, 0.0))
    return _between_centres(weights, errors[0].shape)


def _window_means(values: Float64, total: bool = False) -> Float64:
    """Means, or sums, over windows of `WINDOW` pixels; the last of a row or column may be smaller."""
    rows, columns = (np.arange(0, size, WINDOW) for size in values.shape)
    sums = np.add.reduceat(np.add.reduceat(values, rows, axis=0), columns, axis=1)
    if total:
        return np.asarray(sums)
    return np.asarray(sums / _window_means(np.ones_like(values), total=True))


def _blurred(windows: Float64) -> Float64:
    """Each window's mean with its neighbours', weights 1, 2, 1 along both axes."""
    for axis in (0, 1):
        padded = np.pad(windows, [(1, 1) if axis == k else (0, 0) for k in (0, 1)], mode="edge")
        count = windows.shape[axis]
        before, here, after = (np.take(padded, np.arange(count) + k, axis=axis) for k in (0, 1, 2))
        windows = (before + 2 * here + after) / 4
    return windows


def _between_centres(windows: Float64, shape: tuple[int, ...]) -> Float64:
    """Bilinear interpolation between the windows' centres."""
    for axis in (0, 1):
        at = (np.arange(shape[axis]) + 0.5) / WINDOW - 0.5
        low = np.clip(np.floor(at).astype(int), 0, windows.shape[axis] - 1)
        high = np.minimum(low + 1, windows.shape[axis] - 1)
        part = np.clip(at - low, 0.0, 1.0).reshape((-1, 1) if axis == 0 else (1, -1))
        windows = (1 - part) * np.take(windows, low, axis=axis) + part * np.take(windows, high, axis=axis)
    return windows
