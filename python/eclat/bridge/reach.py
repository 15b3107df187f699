# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The limits of coordinates: a single check of every position that enters the core.

The core and its ray tracer compute in float32, whose squares end at 3.4e38. A ray that starts beyond is invalid to Embree,
which stops the process where it was built to check, and answers wrongly where it was not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.scene import FloatArray, triangle_areas

FARTHEST = 1e18
"""Metres in any coordinate: the sum of the squares of three differences of such is 1.2e37."""

LARGEST_AREA = 4e18
"""m² of a triangle: the cross product of its edges is then squared to 6.4e37. (The Earth has 5e14 m².)"""
_SURELY_SMALL = 1e8
"""Metres of a mesh along each axis, below which no triangle needs to be looked at."""


def check_areas(positions: FloatArray, triangles: NDArray[np.integer], what: str) -> None:
    """Raise EclatError for the first triangle larger than `LARGEST_AREA`, which would otherwise be rendered black."""
    if not len(positions) or not len(triangles) or not np.ptp(positions, axis=0).max() > _SURELY_SMALL:
        return
    index = np.asarray(triangles)
    if index.min() < 0 or index.max() >= len(positions):
        return  # the core names the triangle
    areas = triangle_areas(np.asarray(positions)[index])
    large = np.isfinite(areas) & (areas > LARGEST_AREA)
    if large.any():
        row = int(np.argmax(large))
        raise EclatError(
            f"{what}: triangle {row} is too large: expected an area up to {LARGEST_AREA:g} m², got {areas[row]:g}"
        )


def check_reach(positions: FloatArray, what: str, noun: str = "position") -> None:
    """Raise EclatError for the first of the (N, 3) `positions`, in the core's frame, that lies beyond `FARTHEST`.

    NaN passes here: the core names it. `what` has the positions, such as "mesh 0"; `noun` says what they are.
    """
    table = np.asarray(positions).reshape(-1, 3)
    far = np.isfinite(table) & (np.abs(table) > FARTHEST)
    if far.any():
        row = int(np.argmax(far.any(axis=1)))
        which = f"{noun} {row}" if len(table) > 1 else noun
        got = ", ".join(f"{value:g}" for value in table[row])
        raise EclatError(f"{what}: {which} is too far away: expected coordinates within ±{FARTHEST:g} m, got ({got})")


def check_length(value: float, what: str, noun: str) -> None:
    """Raise EclatError where a length in metres is not finite or beyond `FARTHEST`."""
    if not abs(value) <= FARTHEST:
        raise EclatError(f"{what}: {noun} must be finite and within {FARTHEST:g} m, got {value:g}")
