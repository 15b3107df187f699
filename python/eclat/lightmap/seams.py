# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Seams, where two charts meet on one smooth surface: pairs of places in the map that stand for the same point.

At a real corner the two sides have different light, and are left alone. An edge is a seam where the shading normals of
its two triangles agree at both ends, and their places in the map do not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.lightmap.texels import Corners
from eclat.scene import FloatArray

Ints = NDArray[np.int64]

SAME_NORMAL = 0.03
"""Distance of unit normals up to which a surface is smooth: two degrees, as the rounding of files leaves them."""

SAMPLES_A_TEXEL = 2.0
"""Along a seam: the lookups are linear between texel centres, so that one sample between any two sees all."""

MOST_AT_EDGE = 6
"""Triangles at one edge beyond which nobody can say which belong together."""


def seam_samples(corners: Corners) -> tuple[FloatArray, FloatArray]:
    """(S, 2) and (S, 2): places in texels whose bilinear lookups should agree, spread evenly over all seams."""
    first, second = _seams(corners)
    lengths = [np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) for ends in (first, second)]
    counts = np.ceil(np.maximum(*lengths) * SAMPLES_A_TEXEL).astype(np.int64) + 2
    which = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    t = (step / np.maximum(counts[which] - 1, 1))[:, None]
    a, b = (ends[which, 0] * (1 - t) + ends[which, 1] * t for ends in (first, second))
    return a, b


def _seams(corners: Corners) -> tuple[FloatArray, FloatArray]:
    """The two ends of each seam in the map, on its one side and on its other: (E, 2, 2) each."""
    used = np.flatnonzero(corners.charts >= 0)
    empty = np.zeros((0, 2, 2))
    if not len(used):
        return empty, empty
    _, places = np.unique(corners.positions[used].reshape(-1, 3), axis=0, return_inverse=True)
    places = places.reshape(-1, 3)
    # Each edge starts at the end with the smaller number, so that both sides run the same way.
    start, end = np.arange(3), np.array([1, 2, 0])
    flip = places[:, start] > places[:, end]
    begins, ends = np.where(flip, end, start), np.where(flip, start, end)
    rows = np.arange(len(used))[:, None]
    keys = np.stack((places[rows, begins], places[rows, ends]), axis=2).reshape(-1, 2)
    uvs = np.stack((corners.uvs[used][rows, begins], corners.uvs[used][rows, ends]), axis=2).reshape(-1, 2, 2)
    normals = np.stack((corners.normals[used][rows, begins], corners.normals[used][rows, ends]), axis=2)
    normals = normals.reshape(-1, 2, 3)
    order = np.lexsort((keys[:, 1], keys[:, 0]))
    keys, uvs, normals = keys[order], uvs[order], normals[order]
    number = np.cumsum(np.any(np.diff(keys, axis=0, prepend=keys[:1]), axis=1))
    crowded = np.bincount(number)[number] > MOST_AT_EDGE
    found_a, found_b = [empty], [empty]
    for apart in range(1, MOST_AT_EDGE):
        a, b = slice(None, -apart), slice(apart, None)
        pair = (number[a] == number[b]) & ~crowded[a] & (keys[a][:, 0] != keys[a][:, 1])
        pair &= (np.linalg.norm(normals[a] - normals[b], axis=2) < SAME_NORMAL).all(axis=1)
        pair &= (np.abs(uvs[a] - uvs[b]) > 1e-6).any(axis=(1, 2))
        found_a.append(uvs[a][pair])
        found_b.append(uvs[b][pair])
    return np.concatenate(found_a), np.concatenate(found_b)
