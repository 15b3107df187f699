# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Geometry for loaders of mesh files: triangulation of polygons, vertex normals, and checks of a file's data."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.polygons import EAR_WORK, polygon_triangles
from eclat.scene import FloatArray

IntArray = NDArray[np.integer]

LARGEST = float(np.finfo(np.float32).max)
"""The core computes in float32; what lies beyond is infinite there."""

_BYTES = 16.0
"""Colours beyond it are numbers of 0..255: as factors of white they would mean nothing on a surface."""
_ROUNDING = 1e-3

_SLIVER = 1e-9
"""A triangle lower than this share of its longest edge has no normal left in float32 (whose rounding is 6e-8)."""


def triangulate(
    positions: FloatArray, corners: IntArray, counts: IntArray, where: str
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Polygons cut into triangles, in the polygons' order.

    Parameters
    ----------
    positions : (V, 3).
    corners : (C,) vertices of all polygons, one after the other.
    counts : (P,) numbers of corners, their sum is C. Polygons of fewer than three corners give no triangle.

    Returns
    -------
    (T, 3) places in `corners`, and (T,) the polygon that each triangle comes from.
    """
    counts = np.asarray(counts, dtype=np.int64)
    starts = np.cumsum(counts) - counts
    pieces = np.maximum(counts - 2, 0)
    first = np.cumsum(pieces) - pieces
    triangles = np.empty((int(pieces.sum()), 3), dtype=np.int64)
    work = EAR_WORK
    for size in np.unique(counts[counts >= 3]).tolist():
        which = np.flatnonzero(counts == size)
        places = starts[which, None] + np.arange(size)
        local, work = polygon_triangles(positions, corners[places], where, work)
        rows = first[which, None] + np.arange(size - 2)
        triangles[rows] = np.take_along_axis(places[:, None, :], local, axis=2)
    return triangles, np.repeat(np.arange(len(counts)), pieces)


def check_positions(positions: FloatArray, where: str, *, numbers: list[int] | None = None) -> None:
    """Raise EclatError for the first of the (V, 3) `positions` that is not finite; `numbers` are the vertices'
    lines."""
    good = (np.abs(positions) <= LARGEST).all(axis=1)
    if good.all():
        return
    row = int(np.argmin(good))
    place = f"line {numbers[row]}" if numbers is not None else f"vertex {row}"
    got = " ".join(f"{x:g}" for x in positions[row])
    raise EclatError(f"{where}, {place}: expected finite coordinates below 3.4e38, got {got}")


def finite_rows(values: FloatArray, what: str, where: str) -> FloatArray:
    """The `values` as float32. Rows that are not finite become zeros, with a warning that counts them."""
    with np.errstate(over="ignore", invalid="ignore"):
        single = values.astype(np.float32)
    bad = ~np.isfinite(single).all(axis=1)
    if bad.any():
        warn(f"{where}: {int(bad.sum())} {what} are not finite; zeros are used")
        single[bad] = 0
    return single


def drop_slivers(
    positions: FloatArray, triangles: IntArray, where: str, *, short_polygons: int = 0
) -> NDArray[np.bool_]:
    """Which of the (T, 3) `triangles` have an area; a warning counts the others and the polygons too short to be any.

    Raises
    ------
    EclatError : nothing is left.
    """
    p = np.asarray(positions, dtype=np.float64)[triangles]
    edges = p[:, (1, 2, 0)] - p
    twice_area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    longest = (edges**2).sum(axis=2).max(axis=1, initial=0)
    keep: NDArray[np.bool_] = (twice_area > _SLIVER * longest) & (twice_area > 0)
    if not keep.any():
        raise EclatError(
            f"{where}: expected at least one triangle with an area, got {len(keep)} triangles, all without"
        )
    lost = len(keep) - int(keep.sum())
    if lost or short_polygons:
        short = f" and {short_polygons} faces of fewer than three corners" if short_polygons else ""
        warn(f"{where}: {lost} triangles of zero area{short} are left out")
    return keep


def face_normals(positions: FloatArray, triangles: IntArray) -> NDArray[np.float64]:
    """(T, 3) unit normals by counter-clockwise order; zero where the area is."""
    p = np.asarray(positions, dtype=np.float64)[triangles]
    return normalized(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]))


def normalized(vectors: FloatArray) -> NDArray[np.float64]:
    """The rows normalised, without overflow or underflow. Zero rows stay zero."""
    v = np.asarray(vectors, dtype=np.float64)
    largest = np.abs(v).max(axis=-1, keepdims=True, initial=0)
    v = v / np.where(largest > 0, largest, 1)
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return v / np.where(length > 0, length, 1)


def smooth_normals(positions: FloatArray, triangles: IntArray) -> NDArray[np.float32]:
    """(V, 3) unit vertex normals: the triangles' normals weighted by their angle at the vertex (as Mitsuba 3).

    Where they cancel the vertex gets the normal of one of its triangles, and an unused vertex +z.
    """
    faces = face_normals(positions, triangles)
    p = np.asarray(positions, dtype=np.float64)[triangles]
    sums = np.zeros((len(positions), 3))
    fallback = np.tile((0.0, 0.0, 1.0), (len(positions), 1))
    for corner in range(3):
        a = normalized(p[:, (corner + 1) % 3] - p[:, corner])
        b = normalized(p[:, (corner + 2) % 3] - p[:, corner])
        # Half-chords keep small angles exact where the arc cosine does not.
        angle = 2 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1))
        vertices = triangles[:, corner]
        for axis in range(3):
            sums[:, axis] += np.bincount(vertices, angle * faces[:, axis], minlength=len(positions))
        fallback[vertices] = faces
    cancelled = np.linalg.norm(sums, axis=1) < 1e-6
    sums[cancelled] = fallback[cancelled]
    return normalized(sums).astype(np.float32)


def vertex_normals(
    positions: FloatArray, triangles: IntArray, given: FloatArray | None, where: str
) -> NDArray[np.float32]:
    """`given` (V, 3) made unit, or, where there are none or they are zero or not finite, smooth ones."""
    if given is None:
        return smooth_normals(positions, triangles)
    units = normalized(finite_rows(given, "normals", where))
    missing = ~units.any(axis=1)
    if missing.any():
        units[missing] = smooth_normals(positions, triangles)[missing]
    return units.astype(np.float32)


def white_of(colors: FloatArray, what: str, where: str, *, linear: bool = False) -> float:
    """The number that means white in colours which should lie in 0..1: 1, or, with a warning, 255 if they look like
    bytes.

    Numbers between `_BYTES` and 255 are colours in bytes, and so are whole ones beyond 1, unless colours are
    `linear`, where 2 is more likely twice white. Of other colours beyond 1, which would reflect more than arrives, it is said
    that they will be cut.
    """
    largest = float(colors.max(initial=0))
    if _BYTES < largest <= 255 or (1 < largest <= _BYTES and not linear and not (colors % 1).any()):
        warn(f"{where}: {what} reach {largest:g}; they are taken for numbers of 0..255")
        return 255.0
    if largest > 1 + _ROUNDING:
        warn(f"{where}: {what} reach {largest:g}, expected 0..1; what lies above is cut")
    return 1.0


def linear_from_srgb(values: FloatArray) -> NDArray[np.float32]:
    """The inverse of the sRGB transfer function, for values in 0..1. [IEC61966]"""
    v = np.clip(np.asarray(values, dtype=np.float64), 0, 1)
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4).astype(np.float32)
