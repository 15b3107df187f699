# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Map numbers to colours, for images of errors."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Anchors = tuple[tuple[float, tuple[int, int, int]], ...]

SIGNED: Anchors = (
    (-1.0, (5, 30, 110)),
    (-0.5, (70, 140, 215)),
    (0.0, (245, 245, 245)),
    (0.5, (225, 110, 70)),
    (1.0, (120, 10, 25)),
)
"""The colour map of signed errors: from blue (too dark) over near white (correct) to red (too bright). Both ends are equally
dark. People with colour blindness can distinguish them."""

AMOUNT: Anchors = (
    (0.0, (8, 8, 16)),
    (0.25, (85, 25, 105)),
    (0.5, (190, 55, 85)),
    (0.75, (250, 145, 60)),
    (1.0, (255, 250, 200)),
)
"""The colour map of absolute errors: from black (no error) to pale yellow (largest error), with increasing brightness."""

NOT_A_NUMBER = (0, 255, 0)
"""The colour of NaN: green, which does not occur in either colour map."""


def colored(values: ArrayLike, anchors: Anchors) -> NDArray[np.uint8]:
    """Map numbers of any shape (...) to sRGB bytes (..., 3).

    The colours are interpolated linearly between the `anchors`, which are positions with their colours, and are constant
    beyond them. NaN becomes `NOT_A_NUMBER`.
    """
    numbers = np.asarray(values, dtype=np.float64)
    positions = [position for position, _ in anchors]
    channels = [np.interp(numbers, positions, [color[i] for _, color in anchors]) for i in range(3)]
    colors = np.rint(np.nan_to_num(np.stack(channels, axis=-1))).astype(np.uint8)
    colors[np.isnan(numbers)] = NOT_A_NUMBER
    return colors
