# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Means over square windows of a picture, which vary smoothly between their centres.

What single pixels estimate with much noise is averaged over windows, of which only pixels that count have a part.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Float64 = NDArray[np.float64]
WINDOW = 32
"""Side of the windows in which one weight is chosen, in pixels. The estimate over such a window, of about a thousand
pixels, is precise enough that choosing the least one hardly biases it."""


def window_sums(values: Float64, window: int = WINDOW) -> Float64:
    """Add up each window of `window` pixels a side; the last window of a row or column may be smaller."""
    rows, columns = (np.arange(0, size, window) for size in values.shape)
    return np.asarray(np.add.reduceat(np.add.reduceat(values, rows, axis=0), columns, axis=1))


def window_means(values: Float64, counted: Float64, window: int = WINDOW) -> Float64:
    """Average the pixels of each window that count; 0 where none does."""
    return np.asarray(window_sums(values * counted, window) / np.maximum(1.0, window_sums(counted, window)))


def local_means(values: Float64, counted: Float64) -> Float64:
    """Average each window with its neighbours, each with the share of its pixels that count as a further weight."""
    share = window_sums(counted) / window_sums(np.ones_like(counted))
    return _blurred(window_means(values, counted) * share) / np.maximum(_blurred(share), np.finfo(np.float64).tiny)


def _blurred(windows: Float64) -> Float64:
    """Average each window with its neighbours, with the weights 1, 2, 1 along both axes."""
    for axis in (0, 1):
        padded = np.pad(windows, [(1, 1) if axis == k else (0, 0) for k in (0, 1)], mode="edge")
        count = windows.shape[axis]
        before, here, after = (np.take(padded, np.arange(count) + k, axis=axis) for k in (0, 1, 2))
        windows = (before + 2 * here + after) / 4
    return windows


def between_centres(windows: Float64, shape: tuple[int, ...]) -> Float64:
    """Interpolate bilinearly between the centres of the windows, to an array of the given shape."""
    for axis in (0, 1):
        at = (np.arange(shape[axis]) + 0.5) / WINDOW - 0.5
        low = np.clip(np.floor(at).astype(int), 0, windows.shape[axis] - 1)
        high = np.minimum(low + 1, windows.shape[axis] - 1)
        part = np.clip(at - low, 0.0, 1.0).reshape((-1, 1) if axis == 0 else (1, -1))
        windows = (1 - part) * np.take(windows, low, axis=axis) + part * np.take(windows, high, axis=axis)
    return windows
