# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What a pixel and its eight neighbours have: mean, maximum and median. Pixels beyond the border repeat those at the border."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

Real = TypeVar("Real", np.float32, np.float64)


def mean_of_nine(values: NDArray[Real]) -> NDArray[Real]:
    """Average each pixel of (H, W, 3) with its eight neighbours."""
    return np.asarray(_nines(values).mean(axis=(-1, -2)))


def most_of_nine(values: NDArray[Real]) -> NDArray[Real]:
    """Take the largest value of each pixel of (H, W, 3) and its eight neighbours, channel by channel."""
    padded = _repeated_at_borders(values)
    rows = np.maximum.reduce([padded[k : k + values.shape[0]] for k in range(3)])
    return np.asarray(np.maximum.reduce([rows[:, k : k + values.shape[1]] for k in range(3)]))


def own_or_median(values: NDArray[Real], pixels: NDArray[np.bool_]) -> NDArray[Real]:
    """Take the value or the median of the nine, whichever is more, of the n pixels for which `pixels` (H, W) is True, (n, 3)."""
    nines = _nines(values)[pixels]
    return np.maximum(values[pixels], np.median(nines.reshape(*nines.shape[:2], 9), axis=-1))


def _nines(values: NDArray[Real]) -> NDArray[Real]:
    """View the 3 × 3 pixels around each one, as (H, W, 3, 3, 3)."""
    return sliding_window_view(_repeated_at_borders(values), (3, 3), axis=(0, 1))


def _repeated_at_borders(values: NDArray[Real]) -> NDArray[Real]:
    return np.pad(values, ((1, 1), (1, 1), (0, 0)), mode="edge")
