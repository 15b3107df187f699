# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The error of the picture that is shown, measured by additional paths at a few of its pixels.

Symbol    name here    meaning
  s       shown        the picture that is shown, denoised or not
  T       –            the true picture, which is unknown
  p, q, r estimates    three independent estimates of T at a pixel, by paths that never end in a cache
  π       chances      the chance of a pixel to be probed
  P       –            number of pixels

(s − p)(s − q) has the expectation (s − T)² for any s, so it includes the remaining noise, the smoothing of a denoiser,
the error of records, and their correlations. It is divided by R² + c, which is estimated from r; each of the three
estimates takes the place of r once. The mean over pixels is estimated from some of them as the sum of these values / (π
P) [HorvitzThompson52]. Pixels at which the halves indicate a large error or noise are probed more often. The
probabilities depend on s alone, so the estimate of the mean is unbiased. R is not taken from s, because where a
denoiser spreads light over an edge, the square of s would hide the error (2.0 instead of 2.6 % in the Cornell box).

The probes are drawn after the decision to stop sampling. The estimate on which that decision is based is more often too
low than too high, because a low estimate ends the sampling.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eclat.measure.error_estimate import SIGMAS, ErrorEstimate
from eclat.measure.metrics import RELATIVE_C
from eclat.sampling.adaptive_sampling import Counts
from eclat.sampling.denoised_halves import NO_LESS, DenoisedHalves
from eclat.sampling.windows import WINDOW

Float64 = NDArray[np.float64]

TakeSamples = Callable[[Counts, int], NDArray[np.floating]]
"""A function that takes the number of samples of each pixel (H, W) and the number of the estimate (0, 1 or 2), and
returns the mean of these samples (H, W, 3). The estimates are independent of each other and of the picture.
"""

ESTIMATES = 3
"""The number of independent estimates at a pixel."""

PATHS = 96
"""The number of paths of each estimate. Fewer paths at more pixels give less information: the deviation of the product
of two noisy estimates is inversely proportional to the number of paths, but only to the root of the number of pixels.
"""

EVEN_CHANCE = 0.4
"""The share of the probes that is distributed evenly. The weight of a pixel is at most the inverse of this share."""

LEAST_PATHS = 1 << 18
"""Paths for the probes of a small picture; they take 0.1 to 0.5 s."""

PATHS_OF_PIXEL = 1.5
"""Paths for each pixel, besides those for each sample. A solve takes as long as 20 to 50."""

PATHS_OF_SAMPLE = 0.15
"""Paths for each sample of the picture."""

FIRST_PROBES = 24
"""The number of pixels that are probed first if the time is limited. They are the least number, and they show how long
the others take. A variance from fewer values of such a skew distribution would be meaningless."""

LEAST_STEP = 8
"""The least number of further pixels that are probed at once. The films for fewer of them would take longer than their
paths."""

DISTRUST = 0.5
"""The relative standard deviation that is assumed for the squared error from the halves and the probes of records. The
halves do not measure errors that both share, and neither measures the correlation of the two errors: in furnished rooms
the estimate was 0.6 to 1.2 of the true value.
"""


@dataclass(frozen=True)
class ProbedError:
    """`squared` is the estimated mean of (s − T)² / (R² + c), which noise can make negative, and `deviation` is its
    standard error. `in_one_tile` is the share of it, in 0..1, in the tile of the picture with the largest error.
    """

    squared: float
    deviation: float
    in_one_tile: float


def number_of_paths(pixels: int, samples: float) -> int:
    """Compute how many paths the probes of a picture take, from its number of pixels and of samples per pixel."""
    return max(LEAST_PATHS, int(pixels * (PATHS_OF_PIXEL + PATHS_OF_SAMPLE * samples)))


def probed_error(
    found: DenoisedHalves, take: TakeSamples, paths: int, seed: int, deadline: float | None = None
) -> ProbedError:
    """Measure the error of the picture `found.pixels` at some pixels, with about `paths` paths in all.

    `seed` determines which pixels are probed. If there is a `deadline`, a value of `time.perf_counter`, only as many of
    these pixels are probed, in random order, as there is time for, but at least `FIRST_PROBES`.
    """
    chances = _chances(found, max(2, paths // (ESTIMATES * PATHS))).ravel()
    drawn = np.flatnonzero(_drawn(chances.reshape(found.squared.shape), seed))
    step = drawn.size
    if deadline is not None:
        drawn, step = np.random.default_rng(seed).permutation(drawn), FIRST_PROBES
    parts, probed = np.zeros(chances.size), 0
    while probed < drawn.size and (probed == 0 or step >= LEAST_STEP):
        before = clock.perf_counter()
        these = drawn[probed : probed + step]
        parts[these] = _measured(found, take, these) / chances[these] / chances.size
        probed += these.size
        if deadline is not None:
            # Half of the pixels for which there is time are probed, then half of the rest, and so on, so that the time
            # of the last ones is predicted from recent ones.
            now = clock.perf_counter()
            step = int(max(0.0, deadline - now) / max((now - before) / these.size, 1e-9)) // 2
    # A random part of the pixels stands for all that were drawn.
    parts *= drawn.size / max(1, probed)
    taken = np.zeros(chances.size, dtype=bool)
    taken[drawn[:probed]] = True
    return _summary(parts.reshape(found.squared.shape), taken.reshape(found.squared.shape))


def _measured(found: DenoisedHalves, take: TakeSamples, these: NDArray[np.intp]) -> Float64:
    """Estimate (s − T)² / (R² + c), as a mean over RGB, at the pixels with the flat indices `these` (N,)."""
    where = np.unravel_index(these, found.squared.shape)
    counts = np.zeros(found.squared.shape, np.uint32)
    counts[where] = PATHS
    estimates = [np.asarray(take(counts, number), np.float64)[where] for number in range(ESTIMATES)]
    shown = found.pixels[where]
    brightness = max(float((found.pixels**2).mean()), NO_LESS * float(np.mean(np.square(estimates))))
    c = max(RELATIVE_C * brightness, float(np.finfo(np.float64).tiny))
    squares = np.zeros_like(shown)
    for k in range(ESTIMATES):
        p, q, r = (estimates[k - turn] for turn in range(ESTIMATES))
        squares += (shown - p) * (shown - q) / (r**2 + c) / ESTIMATES
    return np.asarray(squares.mean(axis=-1), np.float64)


def _chances(found: DenoisedHalves, probes: int) -> Float64:
    """Compute the probabilities (H, W) of the pixels, whose sum is about `probes`."""
    size = found.squared.size
    if probes >= size:
        return np.ones_like(found.squared)
    guess = _blurred(np.abs(found.squared))
    total = float(guess.sum())
    likely = guess / total if total > 0 else np.full_like(guess, 1 / size)
    # A pixel is probed at most once, so what a chance exceeds 1 by is lost.
    return np.minimum(1.0, probes * (EVEN_CHANCE / size + (1 - EVEN_CHANCE) * likely))


def _blurred(values: Float64) -> Float64:
    """Average each pixel with its eight neighbours; pixels at the border are repeated."""
    padded = np.pad(values, 1, mode="edge")
    height, width = values.shape
    return np.asarray(sum(padded[y : y + height, x : x + width] for y in range(3) for x in range(3))) / 9


def _drawn(chances: Float64, seed: int) -> NDArray[np.bool_]:
    """Draw pixels with the given probabilities (H, W).

    The pixels are listed window by window, in random order within each window. A pixel is drawn where the cumulative
    sum of the probabilities passes an integer, so that each window gets its share of the probes.
    """
    height, width = chances.shape
    y, x = np.mgrid[0:height, 0:width]
    window = (y // WINDOW) * (-(-width // WINDOW)) + x // WINDOW
    random = np.random.SeedSequence(seed).generate_state(chances.size + 1, np.uint32)
    order = np.lexsort((random[1:], window.ravel()))
    passed = np.floor(np.cumsum(chances.ravel()[order]) + random[0] / 2.0**32)
    drawn = np.zeros(chances.size, dtype=bool)
    drawn[order] = np.diff(passed, prepend=0.0) > 0
    return drawn.reshape(chances.shape)


def _summary(parts: Float64, drawn: NDArray[np.bool_]) -> ProbedError:
    """Sum the contributions, and estimate the standard error from their variance as if the pixels had been drawn
    independently.
    """
    used = parts[drawn]
    count = used.size
    if count == 0:
        return ProbedError(0.0, math.inf, 1.0)
    total = float(used.sum())
    deviation = math.inf if count < 2 else math.sqrt(count / (count - 1) * float(((used - total / count) ** 2).sum()))
    height, width = parts.shape
    tile = max(1, min(WINDOW, min(height, width) // 8))
    rows, columns = np.arange(0, height, tile), np.arange(0, width, tile)
    tiles = np.add.reduceat(np.add.reduceat(parts, rows, axis=0), columns, axis=1)
    share = min(1.0, float(tiles.max()) / total) if total > 0 else 1.0
    return ProbedError(total, deviation, share)


def joined(probed: ProbedError, known: ErrorEstimate | None) -> ErrorEstimate:
    """Return the mean of the error that the probes measured and the error that was estimated before, weighted by the
    inverse of their variances. Without the latter, this is the error that the probes measured.
    """
    if known is None:
        return _skew(probed.squared, probed.deviation, 0.0, probed.in_one_tile)
    squared = known.error**2
    variance = ((known.high**2 - squared) / SIGMAS) ** 2 + (DISTRUST * squared) ** 2
    if not math.isfinite(probed.deviation):
        return ErrorEstimate.of_squared(squared, math.sqrt(variance), known.unserved)
    # Probes that missed the few places with most of the error find too little, and too small a deviation with it. Their
    # relative deviation does not mislead: it is applied to what was known, if that is more.
    deviation = probed.deviation
    if 0 < probed.squared < squared:
        deviation *= squared / probed.squared
    both = variance + deviation**2
    weight = variance / both if both > 0 else 0.5
    found = weight * probed.squared + (1 - weight) * squared
    share = weight * max(0.0, probed.squared) * probed.in_one_tile / found if found > 0 else 0.0
    return _skew(found, math.sqrt(weight) * deviation, known.unserved, share)


def _skew(squared: float, deviation: float, unserved: float, in_one_tile: float) -> ErrorEstimate:
    """Make an estimate from a squared error that is the mean of many small values and a few large ones. Such a mean is
    underestimated more often than overestimated, so the upper end of the interval is that of an interval for its
    logarithm.
    """
    usual = ErrorEstimate.of_squared(squared, deviation, unserved)
    high = usual.high
    if 0 < deviation < squared:
        high = math.sqrt(squared * math.exp(SIGMAS * deviation / squared))
    return replace(usual, high=high, in_one_tile=in_one_tile)
