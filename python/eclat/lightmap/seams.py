# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Seams, the edges at which two charts meet on one smooth surface: pairs of positions in the map that represent the
same point of the surface.

An edge is a seam if the shading normals of its two triangles agree at both ends, but their positions in the map differ.
The two sides of a real corner have different light, so it is not a seam.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.lightmap.texels import Corners
from eclat.scene import FloatArray

Ints = NDArray[np.int64]

SAME_NORMAL = 0.03
"""Largest distance between two unit normals that count as equal: about two degrees, which allows for rounding in
files."""

SAMPLES_PER_TEXEL = 2.0
"""Number of samples per texel along a seam. Lookups are linear between texel centres, so one sample between each two
centres suffices."""

MAX_TRIANGLES_AT_EDGE = 6
"""Largest number of triangles at one edge; with more, it is unclear which of them belong together, and the edge is
skipped."""


def seam_samples(corners: Corners) -> tuple[FloatArray, FloatArray]:
    """Return two arrays (S, 2) of positions in texels, evenly spaced along all seams, whose bilinear lookups should
    agree."""
    first, second = _seams(corners)
    lengths = [np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) for ends in (first, second)]
    counts = np.ceil(np.maximum(*lengths) * SAMPLES_PER_TEXEL).astype(np.int64) + 2
    which = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    t = (step / np.maximum(counts[which] - 1, 1))[:, None]
    a, b = (ends[which, 0] * (1 - t) + ends[which, 1] * t for ends in (first, second))
    return a, b


def _seams(corners: Corners) -> tuple[FloatArray, FloatArray]:
    """Find the two ends of each seam in the map, (E, 2, 2) for one of its sides and (E, 2, 2) for the other."""
    used = np.flatnonzero(corners.charts >= 0)
    empty = np.zeros((0, 2, 2))
    if not len(used):
        return empty, empty
    _, places = np.unique(corners.positions[used].reshape(-1, 3), axis=0, return_inverse=True)
    places = places.reshape(-1, 3)
    # Each edge starts at the end with the smaller index, so that both sides have the same direction.
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
    crowded = np.bincount(number)[number] > MAX_TRIANGLES_AT_EDGE
    found_a, found_b = [empty], [empty]
    for apart in range(1, MAX_TRIANGLES_AT_EDGE):
        a, b = slice(None, -apart), slice(apart, None)
        pair = (number[a] == number[b]) & ~crowded[a] & (keys[a][:, 0] != keys[a][:, 1])
        pair &= (np.linalg.norm(normals[a] - normals[b], axis=2) < SAME_NORMAL).all(axis=1)
        pair &= (np.abs(uvs[a] - uvs[b]) > 1e-6).any(axis=(1, 2))
        found_a.append(uvs[a][pair])
        found_b.append(uvs[b][pair])
    return np.concatenate(found_a), np.concatenate(found_b)
