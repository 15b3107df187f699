# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A least-squares fit of the texel values, after which bilinear lookups come close to the gathered irradiance.

Viewers read the map by bilinear lookups: B(x; p) is the lookup at position p in a map of texel values x. The fit finds
the values that minimise

    Σₖ (B(x; pₖ) − Eₖ)²  +  κ Σₖ (xₖ − Eₖ)²  +  σ Σₛ (B(x; aₛ) − B(x; bₛ))²

where Eₖ is the irradiance that was gathered for texel k at position pₖ. The first sum makes the lookups at these
positions right. This matters at the border of a surface, where the centre of a texel may lie outside the surface, so
that pₖ is another point. The second sum makes the solution unique and keeps it near the gathered values. The third sum
makes lookups on the two sides of each seam agree [Iwanicki13]. The normal equations are solved by conjugate gradients
[Hestenes52].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eclat.scene import FloatArray

Ints = NDArray[np.int64]

GATHERED_WEIGHT = 0.05
"""κ, the weight of the gathered value of a texel relative to lookups. It is so small that a texel at a border follows
its lookups, unless they read it with a weight below about a fifth (0.2² ≈ κ)."""

SEAM_WEIGHT = 4.0
"""σ, the weight of a seam relative to lookups (tuned by eye). It is above 1 because a step at a seam is visible as a
line, and disturbs more than the same error inside a chart."""

TOLERANCE = 1e-5
"""Norm of the residual, relative to the right-hand side, at which the iteration ends."""

MAX_ITERATIONS = 200


@dataclass(frozen=True)
class Rows:
    """A sparse matrix with the same number of entries in each row; row i times x is Σⱼ weights[i, j] · x[columns[i,
    j]]."""

    columns: Ints
    weights: FloatArray

    def times(self, x: FloatArray) -> FloatArray:
        """Multiply by x, of shape (columns, C); the product has the shape (rows, C)."""
        product: FloatArray = np.einsum("ij,ijc->ic", self.weights, x[self.columns])
        return product

    def transposed_times(self, y: FloatArray, count: int) -> FloatArray:
        """Multiply the transpose by y, of shape (rows, C); the product has the shape (count, C)."""
        entries = self.weights[:, :, None] * y[:, None, :]
        flat = self.columns.ravel()
        return np.column_stack(
            [np.bincount(flat, entries[..., c].ravel(), minlength=count)[:count] for c in range(y.shape[1])]
        )


def bilinear(numbers: Ints, places: FloatArray) -> Rows:
    """Make the matrix of bilinear lookups at `places` (N, 2), in texels.

    `numbers` (H, W) is the index of each texel among the unknowns, or −1 for a texel without a value, whose weight the
    other texels of the lookup share. If more than half of the weight is lost, the row is 0.
    """
    height, width = numbers.shape
    corner = np.floor(places - 0.5).astype(np.int64)
    fraction = places - 0.5 - corner
    columns, weights = [], []
    for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
        x, y = np.clip(corner[:, 0] + dx, 0, width - 1), np.clip(corner[:, 1] + dy, 0, height - 1)
        found = numbers[y, x]
        share = np.where(dx, fraction[:, 0], 1 - fraction[:, 0]) * np.where(dy, fraction[:, 1], 1 - fraction[:, 1])
        columns.append(np.maximum(found, 0))
        weights.append(np.where(found >= 0, share, 0))
    total = np.sum(weights, axis=0)
    scale = np.where(total > 0.5, 1 / np.maximum(total, 1e-9), 0.0)
    return Rows(np.column_stack(columns), np.column_stack(weights) * scale[:, None])


def differences(a: Rows, b: Rows) -> Rows:
    """Subtract two matrices row by row. A row of the result is 0 if the row of either matrix is 0."""
    both = ((a.weights.max(axis=1) > 0) & (b.weights.max(axis=1) > 0))[:, None]
    return Rows(np.hstack((a.columns, b.columns)), np.hstack((a.weights, -b.weights)) * both)


def fit(gathered: FloatArray, lookups: Rows, seams: Rows, least: float = 0.0) -> FloatArray:
    """Fit texel values (N, C), none of them below `least`, to the irradiance `gathered` (N, C).

    `lookups` has one row for each gathered value; the rows of `seams` are the differences of lookups across seams.
    """
    count = len(gathered)

    def normal(x: FloatArray) -> FloatArray:
        total = lookups.transposed_times(lookups.times(x), count) + GATHERED_WEIGHT * x
        if len(seams.columns):
            total = total + SEAM_WEIGHT * seams.transposed_times(seams.times(x), count)
        return total

    right = lookups.transposed_times(gathered, count) + GATHERED_WEIGHT * gathered
    x = gathered.astype(np.float64)
    residual = right - normal(x)
    direction, squared = residual.copy(), (residual**2).sum(axis=0)
    enough = TOLERANCE**2 * (right**2).sum(axis=0)
    for _ in range(MAX_ITERATIONS):
        if (squared <= enough).all():
            break
        along = normal(direction)
        curvature = (direction * along).sum(axis=0)
        # A channel that has converged, or that is dark everywhere, does not change any more.
        step = np.where(squared > enough, squared / np.where(curvature > 0, curvature, 1), 0.0)
        x = x + step * direction
        residual = residual - step * along
        before, squared = squared, (residual**2).sum(axis=0)
        direction = residual + squared / np.where(before > 0, before, 1) * direction
    return np.maximum(x, least)
