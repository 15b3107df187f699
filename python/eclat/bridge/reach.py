# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The limits of coordinates, which are checked for every position that enters the core.

The core and Embree compute in float32, so squares of lengths must be below 3.4e38. A ray from a position beyond the
limit is invalid: a build of Embree with checks stops the process, and one without checks returns wrong hits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.scene import FloatArray, triangle_areas

FARTHEST = 1e18
"""Largest absolute coordinate in metres: the sum of the squares of three differences of such coordinates is 1.2e37."""

LARGEST_AREA = 4e18
"""Largest area of a triangle in m²: the square of the cross product of its edges is then 6.4e37. (The surface of the
Earth has 5e14 m².)"""
_SMALL_EXTENT = 1e8
"""Extent of a mesh along each axis, in metres, up to which its triangles need not be checked."""


def check_areas(positions: FloatArray, triangles: NDArray[np.integer], what: str) -> None:
    """Raise EclatError for the first triangle larger than `LARGEST_AREA`, which would otherwise be rendered black."""
    if not len(positions) or not len(triangles) or not np.ptp(positions, axis=0).max() > _SMALL_EXTENT:
        return
    index = np.asarray(triangles)
    if index.min() < 0 or index.max() >= len(positions):
        return  # The core reports the triangle.
    areas = triangle_areas(np.asarray(positions)[index])
    large = np.isfinite(areas) & (areas > LARGEST_AREA)
    if large.any():
        row = int(np.argmax(large))
        raise EclatError(
            f"{what}: triangle {row} is too large: expected an area up to {LARGEST_AREA:g} m², got {areas[row]:g}"
        )


def check_reach(positions: FloatArray, what: str, noun: str = "position") -> None:
    """Raise EclatError for the first of the (N, 3) `positions`, in the core's frame, that lies beyond `FARTHEST`.

    NaN is not reported here, because the core reports it. In the message, `what` names the object, such as "mesh 0",
    and `noun` is the word for its positions.
    """
    table = np.asarray(positions).reshape(-1, 3)
    far = np.isfinite(table) & (np.abs(table) > FARTHEST)
    if far.any():
        row = int(np.argmax(far.any(axis=1)))
        which = f"{noun} {row}" if len(table) > 1 else noun
        got = ", ".join(f"{value:g}" for value in table[row])
        raise EclatError(f"{what}: {which} is too far away: expected coordinates within ±{FARTHEST:g} m, got ({got})")


def check_length(value: float, what: str, noun: str) -> None:
    """Raise EclatError if a length in metres is not finite or is larger than `FARTHEST`."""
    if not abs(value) <= FARTHEST:
        raise EclatError(f"{what}: {noun} must be finite and within {FARTHEST:g} m, got {value:g}")
