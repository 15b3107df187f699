# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The smaller levels of a light map's mip map.

A texel of a smaller level is the mean of those texels below it that surfaces use. Texels of gutters do not count, since each
would give its chart another border. A texel of which no surface uses any part takes the mean of those within it that are at
most half of its side away from used ones, because lookups in a chart read texels that are no farther away. It thus holds the
light of one chart only if charts are two of its sides apart, and where they are not, the levels end.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from eclat.lightmap.gutters import Mask, dilate
from eclat.scene import FloatArray


def most_levels(apart: float) -> int:
    """Return how many levels below a page do not mix the light of charts with `apart` texels between them."""
    return max(0, math.floor(math.log2(apart / 2))) if apart > 0 else 0


def smaller_levels(page: NDArray[np.float32], used: Mask, apart: float) -> list[NDArray[np.float32]]:
    """Compute the levels below a page (H, W, 3), the largest first; level n has the shape (H / 2ⁿ, W / 2ⁿ, 3).

    There are as many as do not mix the light of charts, and as two divides both sizes. `used` (H, W) marks the texels that
    surfaces use. `apart` is the number of texels between those of two charts.
    """
    values: FloatArray = np.where(used[..., None], page, 0.0)
    levels: list[NDArray[np.float32]] = []
    for number in range(1, most_levels(apart) + 1):
        side = 1 << number
        if page.shape[0] % side or page.shape[1] % side:
            break
        near, known = dilate(values, used, side // 2)
        own, covered = _means(values, used, side)
        beside, _ = _means(near, known, side)
        levels.append(np.where(covered[..., None], own, beside).astype(np.float32))
    return levels


def _means(values: FloatArray, known: Mask, side: int) -> tuple[FloatArray, Mask]:
    """Compute the mean of the known values of each square of `side` × `side` texels, and whether it has any."""
    height, width = known.shape[0] // side, known.shape[1] // side
    counts = known.reshape(height, side, width, side).sum(axis=(1, 3))
    masked = np.where(known[..., None], values, 0.0)
    sums = masked.reshape(height, side, width, side, -1).sum(axis=(1, 3))
    return sums / np.maximum(counts, 1)[..., None], counts > 0
