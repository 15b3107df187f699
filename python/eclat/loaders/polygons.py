# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Cut polygons with equal numbers of corners into triangles: convex ones into fans, concave ones by ear clipping."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.errors import warn
from eclat.scene import FloatArray

EAR_WORK = 500_000_000
"""The largest sum of n³ over the concave polygons of a mesh, where n is the number of corners. Ear clipping takes up to
10 s for this sum (measured). Without a limit, a malicious file could keep it busy for hours."""

_FLAT = 1e-9
"""The ratio of areas, triangle to polygon, below which the corners of the triangle count as collinear."""

Point = tuple[float, float]


def polygon_triangles(
    positions: FloatArray, polygons: NDArray[np.integer], where: str, work: int = EAR_WORK
) -> tuple[NDArray[np.int64], int]:
    """Cut P polygons of n corners each into triangles.

    Parameters
    ----------
    positions : (V, 3).
    polygons : (P, n) vertex indices, n ≥ 3. The polygons need not be convex or exactly planar, but they should not
        intersect themselves.
    where : the file, for warnings.
    work : the budget for concave polygons, each of which costs n³. When it is spent, the rest are cut as if they
        were convex, with a warning.

    Returns
    -------
    (P, n − 2, 3) corner numbers 0 … n − 1, with the same orientation as the polygon, and the remaining `work`.
    """
    n = polygons.shape[1]
    fan = np.stack([np.zeros(n - 2, np.int64), np.arange(1, n - 1), np.arange(2, n)], axis=1)
    result = np.tile(fan, (len(polygons), 1, 1))
    if n == 3:
        return result, work
    p = np.asarray(positions, dtype=np.float64)[polygons]
    p -= p[:, :1]
    # The sum of the fan's cross products is twice the polygon's area vector, whether it is convex or not.
    crosses = np.cross(p[:, 1:-1], p[:, 2:])
    normal = crosses.sum(axis=1)
    areas = (crosses * normal[:, None]).sum(axis=2)
    misfit = areas.min(axis=1) <= _FLAT * np.abs(areas).sum(axis=1)
    concave = np.flatnonzero(misfit & (normal != 0).any(axis=1))
    affordable = concave[: work // n**3]
    for row in affordable:
        result[row] = _ears(_flattened(p[row], normal[row]))
    if len(affordable) < len(concave):
        skipped = len(concave) - len(affordable)
        warn(
            f"{where}: {skipped} concave polygons of {n} corners are triangulated as if they were convex, because "
            "there are too many of them or they have too many corners"
        )
    return result, work - len(affordable) * n**3


def _flattened(points: FloatArray, normal: FloatArray) -> list[Point]:
    """Project the (n, 3) `points` along the largest component of `normal`, so that they run counter-clockwise."""
    axis = int(np.argmax(np.abs(normal)))
    first, second = (axis + 1) % 3, (axis + 2) % 3
    if normal[axis] < 0:
        first, second = second, first
    return [(float(point[first]), float(point[second])) for point in points]


def _cross(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _ears(points: list[Point]) -> list[tuple[int, int, int]]:
    """Cut a simple counter-clockwise polygon of n points into n − 2 triangles by ear clipping.

    A polygon that intersects itself gives n − 2 arbitrary triangles.
    """
    left = list(range(len(points)))
    area = sum(_cross(points[0], points[i], points[i + 1]) for i in range(1, len(points) - 1))
    triangles = []
    while len(left) > 3:
        ear = _find_ear(points, left, _FLAT * abs(area))
        triangles.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
    triangles.append((left[0], left[1], left[2]))
    return triangles


def _find_ear(points: list[Point], left: list[int], flat: float) -> int:
    """Return the index in `left` of the corner to cut off: an ear if there is one, otherwise the flattest corner."""
    n = len(left)
    turns = [_cross(points[left[i - 1]], points[left[i]], points[left[(i + 1) % n]]) for i in range(n)]
    # Only a corner that is not convex (a right turn) can lie inside an ear.
    obstacles = [points[left[i]] for i in range(n) if turns[i] <= flat]
    for i in range(n):
        if turns[i] > flat and not _covers_any(
            points[left[i - 1]], points[left[i]], points[left[(i + 1) % n]], obstacles
        ):
            return i
    return min(range(n), key=lambda i: abs(turns[i]))


def _covers_any(a: Point, b: Point, c: Point, obstacles: list[Point]) -> bool:
    """Return whether one of the `obstacles`, except the triangle's own corners, lies in the triangle or on its edges."""
    return any(
        q not in (a, b, c) and _cross(a, b, q) >= 0 and _cross(b, c, q) >= 0 and _cross(c, a, q) >= 0 for q in obstacles
    )
