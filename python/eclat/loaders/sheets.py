# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Distinguish triangles that enclose a volume from triangles of thin sheets, which need different glass materials.

Light is refracted where it enters a solid piece of glass and again where it leaves. Windows are often modelled as a
single sheet of triangles without an inside, which stands for a whole pane. A mesh may contain both solids and sheets,
so each connected piece is classified separately.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.loaders.components import connected_components
from eclat.scene import Mesh

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

_WELD = 1e-6
"""The distance, as a fraction of the mesh's size, within which vertices count as one. Files write coordinates with six
or seven digits."""
_HOLES = 0.02
"""The largest ratio of the area of a solid's holes to its surface area. It admits a missing face of a fine mesh, but not
the open end of a tube or the mouth of a bowl."""
_FLAT = 1e-7
"""The ratio volume / area^(3/2) of a closed piece below which its two sides coincide, so that it is a sheet. A pane of
3 m × 3 m and a thickness of 0.1 mm has a ratio of 1e-5."""


def bounding_triangles(mesh: Mesh) -> NDArray[np.bool_]:
    """Tell which triangles of a mesh belong to a connected piece that encloses a volume.

    Vertices at the same position count as one. A piece encloses a volume if each of its edges is used equally often in
    both directions. It may have holes if their area is small. At a T-junction, where a long edge meets several short
    ones, the hole has no area.

    Returns
    -------
    (T,) True for each triangle of such a piece.
    """
    triangles = np.asarray(mesh.triangles, np.int64)
    if not len(triangles):
        return np.zeros(0, bool)
    corners, places = _welded(np.asarray(mesh.positions, np.float64), triangles)
    labels = _pieces(corners, len(places))
    whole = np.zeros(len(triangles), bool)
    order = np.argsort(labels, kind="stable")
    for piece in np.split(order, np.flatnonzero(np.diff(labels[order])) + 1):
        whole[piece] = _encloses(corners[piece], places)
    return whole


def _welded(positions: Floats, triangles: Ints) -> tuple[Ints, Floats]:
    """Merge vertices at the same position.

    Returns
    -------
    (T, 3) the triangles as indices of merged vertices, and (P, 3) the merged vertices relative to the first vertex.
    """
    used = positions[triangles.reshape(-1)]
    used = used - used[0]
    size = float(np.abs(used).max()) or 1.0
    _, first, inverse = np.unique(np.round(used / (_WELD * size)), axis=0, return_index=True, return_inverse=True)
    return inverse.reshape(-1, 3), used[first]


def _pieces(corners: Ints, count: int) -> Ints:
    """Return the label (T,) of each triangle's connected piece. Triangles that share a vertex belong to the same piece."""
    labels = connected_components(count, np.repeat(corners[:, 0], 2), corners[:, 1:].reshape(-1))
    return labels[corners[:, 0]]


def _encloses(corners: Ints, places: Floats) -> bool:
    a, b, c = (places[corners[:, i]] for i in range(3))
    area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2
    start, end = _open_ends(corners)
    if len(start):
        # The area of a hole is that of a triangle fan from the centre of its border.
        labels = connected_components(len(places), start, end)[start]
        holes = 0.0
        for label in np.unique(labels):
            p, q = places[start[labels == label]], places[end[labels == label]]
            middle = p.mean(axis=0)
            holes += float(np.linalg.norm(np.cross(p - middle, q - middle), axis=1).sum()) / 2
        if holes > _HOLES * area:
            return False
    origin = places[corners[0, 0]]
    volume = abs(float((np.cross(a - origin, b - origin) * (c - origin)).sum())) / 6
    return bool(volume > _FLAT * area**1.5)


def _open_ends(corners: Ints) -> tuple[Ints, Ints]:
    """Return the start and end vertices of the edges that triangles do not use equally often in both directions."""
    start, end = corners.reshape(-1), np.roll(corners, -1, axis=1).reshape(-1)
    low, high = np.minimum(start, end), np.maximum(start, end)
    edges, which = np.unique(np.column_stack((low, high)), axis=0, return_inverse=True)
    surplus = np.zeros(len(edges), np.int64)
    np.add.at(surplus, which.reshape(-1), np.sign(end - start))
    found = edges[surplus != 0]
    return found[:, 0], found[:, 1]
