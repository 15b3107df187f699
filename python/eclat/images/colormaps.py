# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers as colours, for error maps."""

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
"""Blue (too dark), near white (right), red (too bright); both ends are equally dark. Safe for the colour-blind."""

AMOUNT: Anchors = (
    (0.0, (8, 8, 16)),
    (0.25, (85, 25, 105)),
    (0.5, (190, 55, 85)),
    (0.75, (250, 145, 60)),
    (1.0, (255, 250, 200)),
)
"""Black (none) to pale yellow (most), brightness growing all the way."""

NOT_A_NUMBER = (0, 255, 0)
"""Green occurs in neither map."""


def colored(values: ArrayLike, anchors: Anchors) -> NDArray[np.uint8]:
    """(..., 3) sRGB bytes of numbers, linear between the anchors and constant beyond; NaN is `NOT_A_NUMBER`."""
    numbers = np.asarray(values, dtype=np.float64)
    positions = [position for position, _ in anchors]
    channels = [np.interp(numbers, positions, [color[i] for _, color in anchors]) for i in range(3)]
    colors = np.rint(np.nan_to_num(np.stack(channels, axis=-1))).astype(np.uint8)
    colors[np.isnan(numbers)] = NOT_A_NUMBER
    return colors
