# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Geometry for the loaders of mesh files: triangulation of polygons, vertex normals, and validation of vertex data."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.polygons import EAR_WORK, polygon_triangles
from eclat.scene import FloatArray

IntArray = NDArray[np.integer]

LARGEST = float(np.finfo(np.float32).max)
"""The largest finite float32. The core computes in float32, where larger numbers would be infinite."""

_BYTES = 16.0
"""The value from which linear colours are taken for bytes in 0..255. No surface is 16 times as bright as white."""
_ROUNDING = 1e-3
"""The amount by which colours may exceed 1 without a warning, since rounding may explain it."""

_SLIVER = 1e-9
"""The smallest ratio of a triangle's height to its longest edge. The normal of a thinner triangle is lost to rounding
in float32, whose relative error is 6e-8."""


def triangulate(
    positions: FloatArray, corners: IntArray, counts: IntArray, where: str
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Cut polygons into triangles, in the order of the polygons.

    Parameters
    ----------
    positions : (V, 3).
    corners : (C,) vertex indices of all polygons, one polygon after the other.
    counts : (P,) the number of corners of each polygon. The sum is C. Polygons of fewer than three corners give no
        triangle.
    where : the file, for warnings.

    Returns
    -------
    (T, 3) indices into `corners`, and (T,) the polygon that each triangle was cut from.
    """
    counts = np.asarray(counts, dtype=np.int64)
    if len(counts) and (counts == 3).all():
        return np.arange(len(corners)).reshape(-1, 3), np.arange(len(counts))
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
    """Raise EclatError if one of the (V, 3) `positions` is not finite or exceeds float32.

    The message names the file `where` and the first such vertex: by its line, if `numbers` has the line number of each
    vertex, otherwise by its index.
    """
    good = (np.abs(positions) <= LARGEST).all(axis=1)
    if good.all():
        return
    row = int(np.argmin(good))
    place = f"line {numbers[row]}" if numbers is not None else f"vertex {row}"
    got = " ".join(f"{x:g}" for x in positions[row])
    raise EclatError(f"{where}, {place}: expected finite coordinates below 3.4e38, got {got}")


def finite_rows(values: FloatArray, what: str, where: str) -> FloatArray:
    """Convert the rows of `values` to float32, and replace each row that is not finite by zeros, with a warning.

    The warning names the file, `where`, and the kind of values, `what`.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        single = values.astype(np.float32)
    bad = ~np.isfinite(single).all(axis=1)
    if bad.any():
        warn(f"{where}: {int(bad.sum())} {what} are not finite; zeros are used instead")
        single[bad] = 0
    return single


def triangles_with_area(
    positions: FloatArray, triangles: IntArray, where: str, *, short_polygons: int = 0
) -> NDArray[np.bool_]:
    """Tell which of the (T, 3) `triangles` have an area, and warn how many have none.

    Parameters
    ----------
    positions : (V, 3).
    triangles : (T, 3) vertex indices.
    where : the file, for messages.
    short_polygons : the number of polygons with fewer than three corners, which the warning mentions too.

    Returns
    -------
    (T,) True for each triangle to keep.

    Raises
    ------
    EclatError : no triangle has an area.
    """
    keep = np.empty(len(triangles), dtype=bool)
    for rows, edges in _edges_by_parts(positions, triangles):
        twice_area = _length(_cross(edges[0], edges[1]))
        longest = np.einsum("kcn,kcn->kn", edges, edges).max(axis=0)
        keep[rows] = (twice_area > _SLIVER * longest) & (twice_area > 0)
    if not keep.any():
        raise EclatError(
            f"{where}: expected at least one triangle with an area, got {len(keep)} triangles of zero area"
        )
    lost = len(keep) - int(keep.sum())
    if lost or short_polygons:
        short = f" and {short_polygons} faces of fewer than three corners" if short_polygons else ""
        warn(f"{where}: {lost} triangles of zero area{short} are left out")
    return keep


def any_has_area(positions: FloatArray, triangles: IntArray) -> bool:
    """Tell whether at least one of the (T, 3) `triangles` of (V, 3) `positions` has an area."""
    return any((_length(_cross(edges[0], edges[1])) > 0).any() for _, edges in _edges_by_parts(positions, triangles))


def face_normals(positions: FloatArray, triangles: IntArray) -> NDArray[np.float64]:
    """Return the unit normals (T, 3) of triangles, on the side from which the corners appear counter-clockwise.

    A triangle without area has a zero normal.
    """
    p = np.asarray(positions, dtype=np.float64)[triangles]
    return normalized(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]))


def normalized(vectors: FloatArray) -> NDArray[np.float64]:
    """Normalise the rows of `vectors` without overflow or underflow. Zero rows stay zero."""
    v = np.asarray(vectors, dtype=np.float64)
    largest = np.abs(v).max(axis=-1, keepdims=True, initial=0)
    v = v / np.where(largest > 0, largest, 1)
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return v / np.where(length > 0, length, 1)


def smooth_normals(positions: FloatArray, triangles: IntArray) -> NDArray[np.float32]:
    """Compute unit vertex normals (V, 3): means of the triangles' normals, weighted by the angle at the vertex.

    Mitsuba 3 uses the same weights. If the normals at a vertex cancel, the vertex gets the normal of one of its
    triangles. A vertex that no triangle uses gets +z.
    """
    sums = np.zeros((3, len(positions)))
    for rows, edges in _edges_by_parts(positions, triangles):
        faces, twice_area = _unit(_cross(edges[0], edges[1]))
        for corner in range(3):
            # The arc tangent keeps small angles exact where the arc cosine does not.
            angle = np.arctan2(twice_area, -np.einsum("cn,cn->n", edges[corner], edges[corner - 1]))
            _add_to(sums, triangles[rows, corner], angle * faces)
    cancelled = np.flatnonzero(_length(sums) < 1e-6)
    if len(cancelled):
        fallback = np.tile((0.0, 0.0, 1.0), (len(positions), 1))
        fallback[triangles] = face_normals(positions, triangles)[:, None]
        sums[:, cancelled] = fallback[cancelled].T
    normals = np.empty((len(positions), 3), np.float32)
    normals[:] = _unit(sums)[0].T
    return normals


_PART = 1 << 14
"""Triangles that are worked on at a time: their numbers stay in the processor's cache, so that ten million take a tenth
of the time and of the memory."""


def _edges_by_parts(positions: FloatArray, triangles: IntArray) -> Iterator[tuple[slice, NDArray[np.float64]]]:
    """Yield slices of the triangles, and the edges of these triangles as an array (3 edges, 3 axes, triangles).

    The edges are scaled such that the longest edge of each triangle is about 1, so that their products neither overflow
    nor vanish.
    """
    for start in range(0, len(triangles), _PART):
        rows = slice(start, start + _PART)
        corners = np.asarray(positions[triangles[rows]], dtype=np.float64).transpose(1, 2, 0)
        edges = np.empty(corners.shape)
        for k in range(3):
            np.subtract(corners[(k + 1) % 3], corners[k], out=edges[k])
        largest = np.abs(edges).max(axis=(0, 1))
        edges /= np.where(largest > 0, largest, 1)
        yield rows, edges


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cross products of vectors in columns, (3, N)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _length(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Lengths of vectors in columns."""
    lengths: NDArray[np.float64] = np.sqrt(np.einsum("cn,cn->n", vectors, vectors))
    return lengths


def _unit(vectors: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Vectors in columns made unit (zero ones stay zero), and their lengths."""
    lengths = _length(vectors)
    return vectors / np.where(lengths > 0, lengths, 1), lengths


def _add_to(sums: NDArray[np.float64], places: IntArray, vectors: NDArray[np.float64]) -> None:
    """Add vectors in columns to the columns `places` of `sums`, of which one may come many times."""
    low, high = int(places.min()), int(places.max()) + 1
    for total, values in zip(sums, vectors, strict=True):
        if high - low <= 8 * len(places):
            total[low:high] += np.bincount(places - low, values, minlength=high - low)
        else:
            np.add.at(total, places, values)


def vertex_normals(
    positions: FloatArray, triangles: IntArray, given: FloatArray | None, where: str
) -> NDArray[np.float32]:
    """Normalise the file's vertex normals, or compute smooth ones.

    Parameters
    ----------
    positions : (V, 3).
    triangles : (T, 3) vertex indices.
    given : (V, 3) the file's normals, or None if it has none. Normals that are zero or not finite are replaced by
        smooth ones.
    where : the file, for warnings.

    Returns
    -------
    (V, 3) unit vectors.
    """
    if given is None:
        return smooth_normals(positions, triangles)
    units = normalized(finite_rows(given, "normals", where))
    missing = ~units.any(axis=1)
    if missing.any():
        units[missing] = smooth_normals(positions, triangles)[missing]
    return units.astype(np.float32)


def white_level(colors: FloatArray, what: str, where: str, *, linear: bool = False) -> float:
    """Find the number that stands for white in floating-point colours: usually 1, but 255 if they look like bytes.

    Colours count as bytes, with a warning, if the largest is between `_BYTES` and 255, or if it exceeds 1 and all are
    whole numbers. The second rule does not hold for `linear` colours, where a 2 more likely means twice white. Other
    colours that exceed 1 get a warning that they will be clipped to 1, because a surface cannot reflect more light
    than it receives.
    """
    largest = float(colors.max(initial=0))
    if _BYTES < largest <= 255 or (1 < largest <= _BYTES and not linear and not (colors % 1).any()):
        warn(f"{where}: expected {what} in 0..1, got up to {largest:g}; they are taken for numbers in 0..255")
        return 255.0
    if largest > 1 + _ROUNDING:
        warn(f"{where}: expected {what} in 0..1, got up to {largest:g}; larger values are clipped to 1")
    return 1.0


def linear_from_srgb(values: FloatArray) -> NDArray[np.float32]:
    """Convert sRGB values in 0..1 to linear values by the inverse of the sRGB transfer function. [IEC61966]"""
    v = np.clip(np.asarray(values, dtype=np.float64), 0, 1)
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4).astype(np.float32)
