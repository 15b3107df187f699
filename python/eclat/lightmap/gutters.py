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


def _neighbours(values: FloatArray) -> FloatArray:
    """Sum the values of the eight neighbours of each texel."""
    padded = np.pad(values, ((1, 1), (1, 1), (0, 0)))
    height, width = values.shape[:2]
    total = -values
    for dy in range(3):
        for dx in range(3):
            total = total + padded[dy : dy + height, dx : dx + width]
    return total
