# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of other frames, seen at the places that the pixels of one frame show.

Symbol   name here   meaning                                                              unit
  m        motion      of the layers of motion: columns, rows, and how much farther        pixel, pixel, m
  d        depth       distance of the first surface along the ray of a pixel              m
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Float64 = NDArray[np.float64]

SAME_DEPTH = 0.02
"""The largest difference of depths, relative to the depth, between a pixel and the place that it is compared with."""
SAME_NORMAL = 0.9
"""The least cosine between their normals: that of 26°, as between records that serve each other."""
SAME_SHARE = 0.99
"""The share of the pixels around a place above which the place is seen."""


@dataclass(frozen=True, eq=False)
class Look:
    """What one frame shows: radiance (H, W, 3), and of the first surface the number of the object (H, W), the normal
    (H, W, 3) and the depth (H, W)."""

    radiance: NDArray[np.floating]
    objects: NDArray[np.floating]
    normals: NDArray[np.floating]
    depths: NDArray[np.floating]


def followed(here: Look, there: Look, motion: NDArray[np.floating]) -> tuple[Float64, Float64]:
    """Return the radiance (H, W, 3) that `there` has where the places that `here` shows are then, interpolated between pixels,
    and which share (H, W), 0..1, of the four pixels around each such place shows the same surface. The others are left out.

    `motion` (H, W, 3) leads from `here` to `there`. Surfaces are the same if their objects are, and if their depths and
    normals fit.
    """
    height, width = here.objects.shape
    rows, columns = np.mgrid[:height, :width]
    x, y = columns + motion[..., 0].astype(np.float64), rows + motion[..., 1].astype(np.float64)
    expected = here.depths.reshape(height, width) + motion[..., 2].astype(np.float64)
    left, top = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    found, weights = np.zeros((height, width, 3)), np.zeros((height, width))
    depths = there.depths.reshape(height, width)
    for down in (0, 1):
        for right in (0, 1):
            share = np.abs(1 - right - (x - left)) * np.abs(1 - down - (y - top))
            column, row = left + right, top + down
            inside = (column >= 0) & (row >= 0) & (column < width) & (row < height)
            at = np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)
            same = inside & (there.objects[at] == here.objects)
            with np.errstate(invalid="ignore"):
                near = np.abs(depths[at] - expected) <= SAME_DEPTH * np.abs(expected)
            facing = np.einsum("hwi,hwi->hw", there.normals[at], here.normals)
            same &= (near & (facing >= SAME_NORMAL)) | (here.objects == 0)
            share = np.where(same, share, 0.0)
            found += share[..., None] * there.radiance[at]
            weights += share
    with np.errstate(all="ignore"):
        radiance = np.where(weights[..., None] > 0, found / weights[..., None], 0.0)
    return radiance, weights


def accumulated(here: Look, others: Sequence[tuple[Look, NDArray[np.floating]]]) -> NDArray[np.float32]:
    """Return the mean (H, W, 3) of what a frame shows and what others show at the same places, each with the motion that leads
    to it. A frame counts by the share of pixels that show the same surface."""
    total, weights = here.radiance.astype(np.float64), np.ones(here.objects.shape)
    for there, motion in others:
        radiance, share = followed(here, there, motion)
        total = total + share[..., None] * radiance
        weights = weights + share
    return np.asarray(total / weights[..., None], np.float32)
