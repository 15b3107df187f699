# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A least-squares fit of texel values, so that what viewers read comes close to the gathered irradiance.

Viewers read the map by bilinear lookups, B(x; p) at place p of the texel values x. The fit finds the values that
minimise

    Σₖ (B(x; pₖ) − Eₖ)²  +  κ Σₖ (xₖ − Eₖ)²  +  σ Σₛ (B(x; aₛ) − B(x; bₛ))²

where Eₖ is the irradiance gathered for texel k at place pₖ. The first sum matters where pₖ is not the texel's centre,
which lies outside the surface: the texel becomes what makes the lookup at its border right. The second keeps the
solution unique and near what was gathered. The third joins the two sides of each seam [Iwanicki13]. The normal
equations are solved by conjugate gradients [Hestenes52].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eclat.scene import FloatArray

Ints = NDArray[np.int64]

KEEP = 0.05
"""κ: so small that a border's texel follows its lookups, unless they read it with less weight than about a fifth."""

JOIN = 4.0
"""σ: seams are seen as lines, so that a step there weighs more than the same error inside."""

TOLERANCE = 1e-5
"""The iteration ends at this residual, relative to the first one."""

MOST_ITERATIONS = 200


@dataclass(frozen=True)
class Rows:
    """Sparse rows with equally many entries: Σⱼ weights[i, j] · x[columns[i, j]]."""

    columns: Ints
    weights: FloatArray

    def times(self, x: FloatArray) -> FloatArray:
        """The product with x (columns, C), shape (rows, C)."""
        product: FloatArray = np.einsum("ij,ijc->ic", self.weights, x[self.columns])
        return product

    def transposed_times(self, y: FloatArray, count: int) -> FloatArray:
        """The product of the transpose with y (rows, C), shape (count, C)."""
        entries = self.weights[:, :, None] * y[:, None, :]
        flat = self.columns.ravel()
        return np.column_stack(
            [np.bincount(flat, entries[..., c].ravel(), minlength=count)[:count] for c in range(y.shape[1])]
        )


def bilinear(numbers: Ints, places: FloatArray) -> Rows:
    """The lookups at `places` (N, 2), in texels, of an image whose texel (row, column) is unknown `numbers[row, column]`;
    −1 stands for none, and the others share its weight."""
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
    """The rows a − b. A row is 0 if one of its two sides is missing."""
    both = ((a.weights.max(axis=1) > 0) & (b.weights.max(axis=1) > 0))[:, None]
    return Rows(np.hstack((a.columns, b.columns)), np.hstack((a.weights, -b.weights)) * both)


def fit(gathered: FloatArray, lookups: Rows, seams: Rows) -> FloatArray:
    """Texel values (N, C) of at least 0 that fit the irradiance `gathered` (N, C); `lookups` has a row for each
    value."""
    count = len(gathered)

    def normal(x: FloatArray) -> FloatArray:
        total = lookups.transposed_times(lookups.times(x), count) + KEEP * x
        if len(seams.columns):
            total = total + JOIN * seams.transposed_times(seams.times(x), count)
        return total

    right = lookups.transposed_times(gathered, count) + KEEP * gathered
    x = gathered.astype(np.float64)
    residual = right - normal(x)
    direction, squared = residual.copy(), (residual**2).sum(axis=0)
    enough = TOLERANCE**2 * (right**2).sum(axis=0)
    for _ in range(MOST_ITERATIONS):
        if (squared <= enough).all():
            break
        along = normal(direction)
        curvature = (direction * along).sum(axis=0)
        # A channel that has converged or is dark no longer changes.
        step = np.where(squared > enough, squared / np.where(curvature > 0, curvature, 1), 0.0)
        x = x + step * direction
        residual = residual - step * along
        before, squared = squared, (residual**2).sum(axis=0)
        direction = residual + squared / np.where(before > 0, before, 1) * direction
    return np.maximum(x, 0.0)
