# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Is it the same picture? Tests that know how noisy their inputs are."""

from __future__ import annotations

import itertools

import numpy as np
import scipy.stats
from numpy.typing import NDArray

Floats = NDArray[np.floating]


def block_means(image: Floats, size: int | tuple[int, int]) -> NDArray[np.float64]:
    """Means over blocks of `size` pixels (a side, or rows and columns), (rows, columns, 3), in double.

    The image must divide into them.
    """
    rows, columns = (size, size) if isinstance(size, int) else size
    h, w, c = image.shape
    assert h % rows == 0 and w % columns == 0, f"{h} × {w} pixels do not divide into blocks of {rows} × {columns}"
    return image.reshape(h // rows, rows, w // columns, columns, c).mean(axis=(1, 3), dtype=np.float64)


def welch(ours: Floats, theirs: Floats, false_alarm: float = 1e-6) -> tuple[float, float]:
    """The largest |t| over all columns of two samples (runs, values), and the limit that chance exceeds once in
    1 / `false_alarm` tests of this kind. A floor of 10⁻⁵ of the mean stands for float rounding."""
    runs = len(ours)
    error = np.sqrt((ours.var(0, ddof=1) + theirs.var(0, ddof=1)) / runs) + 1e-5 * theirs.mean()
    t = np.abs(ours.mean(0) - theirs.mean(0)) / error
    return float(t.max()), float(scipy.stats.t.isf(false_alarm / 2 / t.size, runs - 1))


def relative_error(image: Floats, a: Floats, b: Floats | None = None) -> float:
    """Relative RMS error of `image` against a reference with independent halves `a` and `b`.

    (x − a)(x − b) has the expectation (x − truth)², so noise of the reference puts no floor under the error; the
    noise of `image` counts. Darkness is floored by 1 % of the mean square. With `b` missing, `a` is taken for exact.
    """
    b = a if b is None else b
    reference = (a.astype(np.float64) + b) / 2
    products = (image - a.astype(np.float64)) * (image - b) / (reference**2 + 0.01 * np.mean(reference**2))
    return float(np.sqrt(max(0.0, products.mean())))


def squared_bias(first: Floats, second: Floats, references: list[NDArray[np.float64]]) -> tuple[float, float]:
    """The mean square of the relative difference from the truth, without noise, and its standard error.

    `first` and `second` are pictures of one method (or means of their blocks) with unrelated samples, `references`
    independent unbiased ones: the mean of (first − A_i)(second − A_j), i ≠ j, has the expectation (method − truth)², however
    noisy they all are. Darkness is floored by 1 % of the mean square.
    """
    truth = np.mean(references, axis=0)
    floor = truth**2 + 0.01 * np.mean(truth**2)
    squares = np.array([((first - a) * (second - b) / floor).mean() for a, b in itertools.permutations(references, 2)])
    # Disjoint pairs of references are independent, and there are half as many as references.
    return float(squares.mean()), float(squares.std() / np.sqrt(len(references) / 2))
