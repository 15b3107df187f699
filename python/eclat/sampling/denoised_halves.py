# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The error of a denoised picture, measured without a reference.

Symbol    name here    meaning
  A, B    a, b         two halves of the samples of a picture: unbiased, with independent noise
  d(A)    denoised_a   the half A denoised, by a denoiser that has not seen B
  m       mean         (d(A) + d(B)) / 2
  R       –            the picture without noise, which is unknown

d(A) is independent of B. The expectation of (d(A) − B)² is therefore that of (d(A) − R)² plus the variance of B; the
same is true with A and B exchanged. The expectation of (A − B)² is the sum of both variances. Hence

    ½ [(d(A) − B)² + (d(B) − A)² − (A − B)²] − ¼ (d(A) − d(B))²

has the same expectation as (m − R)²: it is an unbiased estimate of the squared error of m for any denoiser. It assumes
only that the halves are independent. It does not include errors that both halves share, such as the error of a cache
that both read.

Where the denoiser increases the error, the sampled picture is kept. The picture shown is s = w m + (1 − w) (k(A) + k(B)) / 2,
with a weight w in 0..1. k(A) is A, limited to `denoiser.BRIGHTER` times what d(A) has around a pixel: a few samples that are a
hundred times too bright would be seen as specks even with a small weight, on a wall beside a window whose frame needs it. The
formula above gives the error of s if w d(A) + (1 − w) k(A) takes the place of d(A), and likewise for B, because k(A) does not
depend on B. As a function of w it is a parabola, which its values at w = 0, ½ and 1 determine. The weight with the
least error is computed for windows of `WINDOW` × `WINDOW` pixels and interpolated between their centres. If it were
chosen for each pixel separately, estimates that are low by chance would be selected, and the estimated error would be
too low. Where little is gained by samples, none are kept (`CLEAN`), because eyes see their grain.

A picture s' with errors of its own that are independent of the noise of A and B, such as one that was read from records, may
be shown beside s (`with_picture`): v s' + (1 − v) s. The formula gives its error, too, if v s' + (1 − v) s(A) takes the place of
d(A), where s(A) is what s makes of A; for v = 1 it is (s' − A)(s' − B). The weight v is chosen as w is. All these values share
the product of the noise of A and of B, which is large where the halves have few samples. The error of s' is known from elsewhere,
so there is a second estimate: this error, plus the difference of the formula between v and 1, which does not contain the product.
Both are averaged with the inverse of their variances as weights. The first contains no error that A and B have in common, so what
this may be adds to its standard error; the second does. Where the formula contradicts the known error of s', s' is shown.

The estimate of the squared error is unbiased, but the estimate of the relative error is not, because it divides by R² +
c and takes R from the picture shown. Where a denoiser spreads much light into dark pixels, the estimated relative error
is too low, by a quarter for the worst picture in the tests.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat.errors import EclatError
from eclat.images.denoiser import BRIGHTER, LEAK
from eclat.images.nines import mean_of_nine, most_of_nine, own_or_median
from eclat.measure.error_estimate import ErrorEstimate
from eclat.measure.metrics import RELATIVE_C
from eclat.sampling.windows import WINDOW, between_centres, local_means, window_means, window_sums

Float64 = NDArray[np.float64]
DOUBT = 2.0
"""Standard errors by which halves must find another picture worse than it is known to be before they are doubted."""

CLEAN = 0.8
"""Weight w of the denoised picture from which on fewer samples are kept than the error asks for, and none from (1 + `CLEAN`) / 2
on. If the errors of both are independent, keeping samples takes 1 − w of the squared error away, little for their grain on walls
and ceilings. By judgement."""

FLAT, EDGE = 0.1, 0.3
"""Contrasts (most − least) / most of 3 × 3 denoised pixels. Below the first one, samples are not kept where the denoised picture
has a weight of ⅔ or more, and above the second one they are. Windows keep samples for the sake of their edges; on the walls
around, where the denoiser is right, one would see their grain. By judgement."""

NO_LESS = 1e-4
"""The least mean of R², relative to that of the square of both halves' mean."""

UNKNOWN = 1.0
"""The standard error of the squared error of a single pixel, which no other pixel tells."""

Quadruple = tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike]


@dataclass(frozen=True, eq=False)
class JudgedPicture:
    """A picture whose error is known: `pixels` (H, W, 3), the estimated mean over channels of (s' − R)² / (R² + c) at each pixel,
    `squared` (H, W), the standard error of its mean, `deviation`, which is infinite if the error is not known, and R² + c
    (H, W, 3), `scale`. `common` is the standard deviation of the squared error that halves beside it may have in common,
    which their differences do not show.
    """

    pixels: Float64
    squared: Float64
    deviation: float
    scale: Float64
    common: float = 0.0


@dataclass(frozen=True, eq=False)
class DenoisedHalves:
    """The mean of two denoised halves, with its estimated error.

    `pixels` is the picture s to show, (H, W, 3). `weight` is the weight of the denoised picture in it, (H, W) in 0..1.
    `squared_error` is the estimated mean of (s − R)² / (R² + c) over pixels and channels; noise can make it negative.
    `deviation` is the standard error of `squared_error`, computed from the differences between windows.
    `raw_squared_error` is the estimated squared error of the picture before denoising, (A + B) / 2.
    `local_error`, (H, W), is the error of the window around a pixel and of the neighbouring windows.
    `squared`, (H, W), is the estimate at each pixel, whose mean is `squared_error`; noise makes many of them negative.
    `scale`, (H, W, 3), is R² + c.
    `other_weight`, (H, W) in 0..1, is the weight of the other picture that is shown beside s, or None if there is none.
    """

    pixels: Float64
    weight: Float64
    squared_error: float
    deviation: float
    raw_squared_error: float
    local_error: Float64
    squared: Float64
    scale: Float64
    other_weight: Float64 | None = None

    @property
    def error(self) -> float:
        """Relative error of the picture (see `metrics.relative_rmse`); 0 if the estimated square is negative."""
        return math.sqrt(max(0.0, self.squared_error))

    @property
    def estimate(self) -> ErrorEstimate:
        """The error with its 95 % confidence interval."""
        return ErrorEstimate.of_squared(self.squared_error, self.deviation, 0.0)

    @property
    def error_deviation(self) -> float:
        """Standard error of `error`; the square root of `deviation` if the error is indistinguishable from 0."""
        return min(math.sqrt(self.deviation), self.deviation / (2 * self.error) if self.error > 0 else math.inf)


def judged_halves(
    a: ArrayLike,
    b: ArrayLike,
    denoised_a: ArrayLike,
    denoised_b: ArrayLike,
    covered: NDArray[np.bool_] | None = None,
) -> DenoisedHalves:
    """Denoise the mean of two halves of a picture where that reduces the error, and estimate the error that remains.

    Parameters
    ----------
    a, b : (H, W, 3) linear radiance; each is a mean of the same number of samples. Their noise must be independent, so
        they must be rendered with different seeds; two halves of one Sobol' sequence are not independent.
    denoised_a, denoised_b : (H, W, 3) a and b after `denoiser.denoise`. Each must depend on its own half alone; the layers that
        guide the denoiser must come from the same half too.
    covered : (H, W), True for the pixels that count, such as the texels of surfaces in a light map; the others have no part
        in errors and weights, and their error is 0. None means all.

    Raises
    ------
    EclatError : the arrays differ in shape or are not (H, W, 3).
    """
    halves = _of_one_shape(a, b, denoised_a, denoised_b)
    a, b, denoised_a, denoised_b = halves
    counted = np.ones(a.shape[:2]) if covered is None else covered.astype(np.float64)
    kept_a, kept_b = _kept(a, denoised_a, counted), _kept(b, denoised_b, counted)
    darker = np.minimum(denoised_a, denoised_b) ** 2
    brightness = ((a + b) / 2) ** 2
    scale = _scale(_blended_square(darker, a, b, 0.5, counted), brightness, counted)

    def blended(w: float) -> tuple[Float64, Float64]:
        return w * denoised_a + (1 - w) * kept_a, w * denoised_b + (1 - w) * kept_b

    weight = _best_weights([_squared_error(a, b, *blended(w), scale) for w in (0.0, 0.5, 1.0)], counted)
    weight = np.clip(2 * weight - CLEAN, weight, 1.0)
    scale = _scale(_blended_square(darker, a, b, weight[..., None], counted), brightness, counted)
    shown_a, shown_b = _shown(a, denoised_a, weight, counted), _shown(b, denoised_b, weight, counted)
    squared = _squared_error(a, b, shown_a, shown_b, scale) * counted
    pixels = (shown_a + shown_b) / 2
    raw = _squared_error(a, b, a, b, scale)
    return DenoisedHalves(
        pixels, weight, _mean(squared, counted), _deviation(squared, counted), _mean(raw, counted),
        _local_error(squared, counted), squared, scale,
    )  # fmt: skip


def with_picture(found: DenoisedHalves, halves: Quadruple, other: JudgedPicture) -> DenoisedHalves:
    """Blend another picture with that of the halves where this reduces the error, and estimate the error that remains.

    Parameters
    ----------
    found : what `judged_halves` or `sampled_halves` made of the halves.
    halves : the halves a and b, then both denoised, (H, W, 3) each; without a denoiser a and b once more.
    other : the other picture. Its errors must be independent of the noise of the halves.

    Raises
    ------
    EclatError : the arrays differ in shape or are not (H, W, 3).
    """
    a, b, denoised_a, denoised_b, others = _of_one_shape(*halves, other.pixels)
    scale, counted = other.scale, np.ones(found.weight.shape)
    own_a, own_b = (
        _shown(half, denoised, found.weight, counted) for half, denoised in ((a, denoised_a), (b, denoised_b))
    )

    def squared_error(v: Float64 | float) -> Float64:
        return _squared_error(a, b, v * others + (1 - v) * own_a, v * others + (1 - v) * own_b, scale)

    errors = [squared_error(v) for v in (0.0, 0.5, 1.0)]
    if _doubtful(errors[-1], other, counted):
        mean, local = _mean(other.squared, counted), _local_error(other.squared, counted)
        return DenoisedHalves(
            others, found.weight, mean, other.deviation, found.raw_squared_error, local, other.squared, scale,
            np.ones(found.weight.shape),
        )  # fmt: skip
    v = _best_weights(errors, counted)
    alone = squared_error(v[..., None])
    change = alone - errors[-1]
    deviations = (
        math.hypot(_deviation(alone, counted), other.common),
        math.hypot(other.deviation, _deviation(change, counted)),
    )
    if math.isinf(deviations[1]):
        squared = alone
    else:
        trust = deviations[1] ** 2 / max(sum(d**2 for d in deviations), np.finfo(np.float64).tiny)
        squared = trust * alone + (1 - trust) * (other.squared + change)
    deviation = min(deviations)
    pixels = v[..., None] * others + (1 - v[..., None]) * found.pixels
    return DenoisedHalves(
        pixels, found.weight, _mean(squared, counted), deviation, found.raw_squared_error, _local_error(squared, counted),
        squared, scale, v,
    )  # fmt: skip


def _doubtful(squared: Float64, other: JudgedPicture, counted: Float64) -> bool:
    """Return whether the halves find a clearly larger error of another picture than it is known to have.

    If most paths miss a small opening through which the light comes, both halves are too dark alike, and everything else looks
    too bright beside them. Their differences do not show that.
    """
    known, deviation = _mean(other.squared, counted), math.hypot(other.deviation, _deviation(squared, counted))
    return _mean(squared, counted) > 1.5 * known + DOUBT * deviation


def sampled_halves(a: ArrayLike, b: ArrayLike) -> DenoisedHalves:
    """Compute the mean of two halves of a picture and its error without denoising, with a weight of 0 everywhere.

    Raises
    ------
    EclatError : the shapes differ.
    """
    first, last = _of_one_shape(a, b)
    counted = np.ones(first.shape[:2])
    scale = _scale(_square(first * last, counted), ((first + last) / 2) ** 2, counted)
    squared = _squared_error(first, last, first, last, scale)
    mean = _mean(squared, counted)
    weight = np.zeros(squared.shape)
    deviation, local = _deviation(squared, counted), _local_error(squared, counted)
    return DenoisedHalves((first + last) / 2, weight, mean, deviation, mean, local, squared, scale)


def _of_one_shape(*pictures: ArrayLike) -> tuple[Float64, ...]:
    halves = tuple(np.asarray(picture, np.float64) for picture in pictures)
    shapes = [half.shape for half in halves]
    if len(shapes[0]) != 3 or shapes[0][2] != 3 or len(set(shapes)) != 1:
        raise EclatError(f"denoise: expected arrays of the same shape (height, width, 3), got shapes {shapes}")
    return halves


def _mean(values: Float64, counted: Float64) -> float:
    """Average the pixels that count; 0 if none does."""
    return float((values * counted).sum()) / max(1.0, float(counted.sum()))


def _deviation(squared: Float64, counted: Float64) -> float:
    """Compute the standard error of the mean from the differences between windows. In small pictures windows are
    smaller, so that there are at least four along each side. A single pixel does not show it, and gets `UNKNOWN` or more."""
    count = int(np.count_nonzero(counted))
    if count < 2:
        return count * max(UNKNOWN, abs(_mean(squared, counted)))
    window = max(1, min(WINDOW, min(squared.shape) // 4))
    if np.count_nonzero(window_sums(counted, window)) < 2:
        window = 1
    means, counts = window_means(squared, counted, window), window_sums(counted, window)
    spread = float(np.average((means - _mean(squared, counted)) ** 2, weights=counts))
    return math.sqrt(spread / (np.count_nonzero(counts) - 1))


def _local_error(squared: Float64, counted: Float64) -> Float64:
    """Compute the local error (H, W): the root of the mean over a window and its neighbours, interpolated between
    windows."""
    means = between_centres(local_means(squared, counted), squared.shape)
    return np.asarray(np.sqrt(np.maximum(means, 0.0)))


def _square(sampled: Float64, counted: Float64) -> Float64:
    """Estimate R², (H, W, 3), where samples are shown: the product of the halves, averaged over 3 × 3 pixels, which their noise
    does not make too large."""
    counted = counted[..., None]
    return mean_of_nine(sampled * counted) / np.maximum(mean_of_nine(counted), np.finfo(np.float64).tiny)


def _blended_square(denoised: Float64, a: Float64, b: Float64, weight: Float64 | float, counted: Float64) -> Float64:
    """Estimate R², (H, W, 3), where both may be shown, from the squares of the darker half, `denoised`, and from the samples.

    Where the denoised halves are shown, R² is the square of the darker half: most of the error is at edges, where
    denoisers spread light to the dark side. For a picture of a furnished room, the error computed with the darker half is 96 to
    98 % of the error computed with the true R²; with the product of the denoised halves it is 87 to 91 %. Beside what is far
    brighter (`denoiser.LEAK`), products of samples are not averaged with it, and R² is no less than the square of the samples'
    mean: where a few of them meet the edge of a lamp, R² is not that of the darkness beside it.
    """
    nearby = _square(a * b, counted)
    beside = np.any(denoised < LEAK**2 * most_of_nine(denoised * counted[..., None]), axis=-1)
    nearby[beside] = own_or_median(a * b * counted[..., None], beside)
    square = weight * denoised + (1 - weight) * nearby
    square[beside] = np.maximum(square[beside], ((a + b)[beside] / 2) ** 2)
    return square


def _scale(square: Float64, brightness: Float64, counted: Float64) -> Float64:
    """Return R² + c, (H, W, 3), for an estimate of R² that noise may have made negative, and the square of the mean of both
    halves: where they have no light in common, as in a picture of a few samples, errors are relative to a share of that."""
    counted = counted[..., None]
    pixels = max(1.0, square.shape[2] * float(counted.sum()))
    square = np.maximum(square, 0.0)
    mean, most = (float((values * counted).sum()) / pixels for values in (square, brightness))
    return np.asarray(np.maximum(square + RELATIVE_C * max(mean, NO_LESS * most), np.finfo(np.float64).tiny))


def _kept(samples: Float64, denoised: Float64, counted: Float64) -> Float64:
    """Limit the samples (H, W, 3) to `BRIGHTER` times the brightest denoised value of the 3 × 3 pixels around."""
    return np.minimum(samples, BRIGHTER * most_of_nine(denoised * counted[..., None]))


def _shown(samples: Float64, denoised: Float64, weight: Float64, counted: Float64) -> Float64:
    """Blend a denoised half (H, W, 3) of the given weight (H, W) with its samples. Away from edges of the denoised half, none of
    these are kept from a weight of ⅔ on, and all of them up to ⅓, where the denoiser must be wrong everywhere."""
    grey, outside = denoised.mean(axis=-1, keepdims=True), counted[..., None] == 0
    most = most_of_nine(np.where(outside, 0.0, grey))
    least = -most_of_nine(np.where(outside, -np.inf, -grey))
    contrast = (most - least) / np.maximum(most, np.finfo(np.float64).tiny)
    edge, w = np.clip((contrast - FLAT) / (EDGE - FLAT), 0.0, 1.0), weight[..., None]
    left = np.maximum(edge, np.clip(2 - 3 * w, 0.0, 1.0))
    return np.asarray(denoised + (1 - w) * left * (_kept(samples, denoised, counted) - denoised))


def _squared_error(a: Float64, b: Float64, shown_a: Float64, shown_b: Float64, scale: Float64) -> Float64:
    """Compute the relative squared error (H, W) of the mean of what is made of each half; noise makes single pixels negative."""
    squares = (shown_a - b) ** 2 + (shown_b - a) ** 2 - (a - b) ** 2
    error = 0.5 * squares - 0.25 * (shown_a - shown_b) ** 2
    return np.asarray((error / scale).mean(axis=-1))


def _best_weights(errors: list[Float64], counted: Float64) -> Float64:
    """Compute the weights (H, W) in 0..1 that minimise the error of each window, interpolated between their centres.

    `errors` are the squared errors f for the weights 0, ½ and 1. As a function of w, f is a parabola, which is least at
    w = (3 f(0) − 4 f(½) + f(1)) / (4 f(0) − 8 f(½) + 4 f(1)). The estimate of each window is averaged with those of its
    neighbours.
    """
    raw, half, full = (local_means(error, counted) for error in errors)
    slope, bend = 3 * raw - 4 * half + full, 4 * raw - 8 * half + 4 * full
    inside = np.divide(slope, bend, out=np.zeros_like(slope), where=bend > 0)
    weights = np.where(bend > 0, np.clip(inside, 0.0, 1.0), np.where(full <= raw, 1.0, 0.0))
    return between_centres(weights, errors[0].shape)
