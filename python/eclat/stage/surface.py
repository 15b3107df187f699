# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The surface from which a default camera and light are chosen: all triangles of a scene, or a part of very many."""

from __future__ import annotations

import weakref
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eclat.scene import FloatArray, Material, Mesh, Scene

MANY = 400_000
"""The number of triangles above which only a part of about this number is used. A room has about 50,000 occupied cells,
so that several triangles of the part lie in each cell.
"""
_PART = 1 << 16
"""The number of triangles that are processed together, so that they stay in the processor's cache."""

_surfaces: weakref.WeakKeyDictionary[Mesh, tuple[list[weakref.ref[Mesh]], FloatArray]] = weakref.WeakKeyDictionary()
"""By the first mesh of a scene of many triangles: all its meshes, and their surface, which is asked for several
times."""


def surface(scene: Scene) -> FloatArray:
    """Return the corners (T, 3, 3) of all triangles whose coordinates are finite.

    In scenes with more than `MANY` triangles, these are the corners of only a part of the triangles, which `_chosen`
    chooses (see `is_part`).
    """
    meshes = [mesh for mesh in scene.meshes if len(mesh.triangles)]
    if not is_part(scene):
        return _corners(meshes, [slice(None)] * len(meshes))
    known = _surfaces.get(meshes[0])
    if known is None or [ref() for ref in known[0]] != meshes:
        known = _surfaces[meshes[0]] = [weakref.ref(mesh) for mesh in meshes], _corners(meshes, _chosen(meshes))
    return known[1]


def emits(material: Material) -> bool:
    """Return whether a material, one of the materials that it mixes, or that of its back emits light."""
    parts = [*material.children, *([] if material.back is None else [material.back])]
    own = material.emission is not None and max(material.emission.constant) > 0
    return own or any(emits(part) for part in parts)


def is_part(scene: Scene) -> bool:
    """Return whether `surface` is only a part of the scene's triangles, so that rays may pass between them."""
    return sum(len(mesh.triangles) for mesh in scene.meshes) > MANY


def _corners(meshes: list[Mesh], rows: Sequence[slice | NDArray[np.intp]]) -> FloatArray:
    corners = [m.positions[m.triangles[r]].astype(np.float64) for m, r in zip(meshes, rows, strict=True)]
    everything = np.concatenate(corners) if corners else np.zeros((0, 3, 3))
    finite: FloatArray = everything[np.isfinite(everything).all(axis=(1, 2))]
    return finite


def _chosen(meshes: list[Mesh]) -> list[NDArray[np.intp]]:
    """Choose a part of the triangles of meshes that together have more than `MANY`; return its rows in each mesh.

    One half of the part represents equal shares of the area, so that it has each large triangle; the other half
    represents equal shares of the number, so that it shows the scene even if a stray triangle has almost all area. The
    triangles that reach farthest along each axis are there too.
    """
    starts = np.concatenate([[0], np.cumsum([len(mesh.triangles) for mesh in meshes])])
    areas = np.empty(starts[-1], np.float32)
    ends: list[int] = []
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for mesh, begin in zip(meshes, starts, strict=False):
        for first in range(0, len(mesh.triangles), _PART):
            part = mesh.triangles[first : first + _PART]
            # Rows are coordinates x, y, z of first, second and third corners, because NumPy's reductions are fast along
            # contiguous rows.
            corners = [np.ascontiguousarray(mesh.positions.take(part[:, k], axis=0).T) for k in range(3)]
            areas[begin + first : begin + first + len(part)] = _twice_areas(*corners)
            for corner in corners:
                which, found = _finite(corner)
                if len(which) == 0:
                    continue
                least, most = found.min(axis=1), found.max(axis=1)
                far = [found[axis].argmin() for axis in np.flatnonzero(least < low)]
                far += [found[axis].argmax() for axis in np.flatnonzero(most > high)]
                ends += [int(begin + first + which[row]) for row in far]
                low, high = np.minimum(low, least), np.maximum(high, most)
    shares = np.cumsum(areas, dtype=np.float64)
    middles = (np.arange(MANY // 2) + 0.5) / (MANY // 2)
    by_area = np.searchsorted(shares, middles * shares[-1])
    by_number = (middles * len(areas)).astype(np.intp)
    rows = np.sort(np.concatenate([by_area, by_number, np.array(ends, np.intp)]))
    rows = rows[np.diff(rows, prepend=-1) > 0]
    parts = np.split(rows, np.searchsorted(rows, starts[1:-1]))
    return [part - begin for part, begin in zip(parts, starts, strict=False)]


def _finite(corner: FloatArray) -> tuple[Sequence[int] | NDArray[np.intp], FloatArray]:
    """Return the columns of positions (3, N) that are finite, and these positions."""
    with np.errstate(all="ignore"):
        if np.isfinite(corner.sum()):
            return range(corner.shape[1]), corner
    which = np.flatnonzero(np.isfinite(corner).all(axis=0))
    return which, corner[:, which]


def _twice_areas(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Return twice the areas (N,) of triangles from the positions (3, N) of their corners; 0 if it is not finite."""
    with np.errstate(all="ignore"):
        one, other = b - a, c - a
        x = one[1] * other[2] - one[2] * other[1]
        y = one[2] * other[0] - one[0] * other[2]
        z = one[0] * other[1] - one[1] * other[0]
        twice: FloatArray = np.sqrt(x * x + y * y + z * z)
        return np.where(np.isfinite(twice), twice, np.float32(0))
