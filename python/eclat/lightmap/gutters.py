# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Filling texels without a surface point with the means of their neighbours, ring by ring around the charts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.scene import FloatArray

Mask = NDArray[np.bool_]


def dilate(values: FloatArray, known: Mask, rings: int, wanted: Mask | None = None) -> tuple[FloatArray, Mask]:
    """Fill up to `rings` rings of texels around the known ones; return the values (H, W, C) and the mask of known
    texels.

    A texel takes the mean of those of its eight neighbours that were known before its ring was filled. If the mask
    `wanted` is given, only its texels are filled.
    """
    values, known = np.where(known[..., None], values, 0).astype(np.float64), known.copy()
    for _ in range(rings):
        sums, counts = _neighbours(values), _neighbours(known[..., None].astype(np.float64))
        new = ~known & (counts[..., 0] > 0)
        if wanted is not None:
            new &= wanted
        if not new.any():
            break
        values[new] = sums[new] / counts[new]
        known |= new
    return values, known


def fill_nearest(values: FloatArray, known: Mask) -> FloatArray:
    """Give each texel that is not known the value of the nearest one that is, (H, W, C); 0 if none is.

    The nearest is found by jump flooding [RongTan06]: texels ask those at distances that halve from step to step which known
    texel they are nearest to. Where two are about as near, it may be the other one.
    """
    height, width = known.shape
    rows, columns = np.mgrid[0:height, 0:width]
    far = 4 * (height + width)
    nearest_row, nearest_column = np.where(known, rows, -far), np.where(known, columns, -far)
    step = 1 << max(0, max(height, width) - 1).bit_length()
    while step := step // 2:
        for dy in (-step, 0, step):
            for dx in (-step, 0, step):
                there = np.clip(rows + dy, 0, height - 1), np.clip(columns + dx, 0, width - 1)
                row, column = nearest_row[there], nearest_column[there]
                now = (nearest_row - rows) ** 2 + (nearest_column - columns) ** 2
                nearer = (row - rows) ** 2 + (column - columns) ** 2 < now
                nearest_row[nearer], nearest_column[nearer] = row[nearer], column[nearer]
    found = nearest_row >= 0
    filled: FloatArray = np.where(
        found[..., None], values[np.maximum(nearest_row, 0), np.maximum(nearest_column, 0)], 0.0
    )
    return filled


def _neighbours(values: FloatArray) -> FloatArray:
    """Sum the values of the eight neighbours of each texel."""
    padded = np.pad(values, ((1, 1), (1, 1), (0, 0)))
    height, width = values.shape[:2]
    total = -values
    for dy in range(3):
        for dx in range(3):
            total = total + padded[dy : dy + height, dx : dx + width]
    return total
