# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tells triangles that bound a body from those of thin sheets, which decides the material of glass.

Light that enters a body of glass is bent until it leaves it. A single sheet of triangles, as windows often are, has no
inside: it stands for a whole pane. A mesh may hold both, so each connected piece is judged by itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.loaders.components import connected
from eclat.scene import Mesh

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

_WELD = 1e-6
"""Share of a mesh's size within which vertices are at one place: files write six or seven digits."""
_HOLES = 0.02
"""Share of a piece's area that its holes may have: a missing face of a fine mesh, not the open end of a tube or the mouth
of a bowl."""
_FLAT = 1e-7
"""Volume of a piece, over its area to the power 3/2, below which its two sides lie on each other; a pane of 3 m whose sides
are 0.1 mm apart has 4e-6."""


def bounding_triangles(mesh: Mesh) -> NDArray[np.bool_]:
    """(T,) whether each triangle belongs to a piece that encloses a volume.

    Vertices at one place count as one. A piece is a body where its triangles run along each edge as often one way as the
    other, or its borders enclose hardly any area: those of T-junctions, where one long edge lies along several short ones,
    enclose none.
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
    """The triangles (T, 3) between places, and the places (P, 3) around the first."""
    used = positions[triangles.reshape(-1)]
    used = used - used[0]
    size = float(np.abs(used).max()) or 1.0
    _, first, inverse = np.unique(np.round(used / (_WELD * size)), axis=0, return_index=True, return_inverse=True)
    return inverse.reshape(-1, 3), used[first]


def _pieces(corners: Ints, count: int) -> Ints:
    """(T,) the number of each triangle's piece; triangles that share a vertex are of one."""
    labels = connected(count, np.repeat(corners[:, 0], 2), corners[:, 1:].reshape(-1))
    return labels[corners[:, 0]]


def _encloses(corners: Ints, places: Floats) -> bool:
    a, b, c = (places[corners[:, i]] for i in range(3))
    area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2
    start, end = _open_ends(corners)
    if len(start):
        # Each border as a fan around its middle.
        labels = connected(len(places), start, end)[start]
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
    """Edges along which more triangles run one way than the other: from where, to where."""
    start, end = corners.reshape(-1), np.roll(corners, -1, axis=1).reshape(-1)
    low, high = np.minimum(start, end), np.maximum(start, end)
    edges, which = np.unique(np.column_stack((low, high)), axis=0, return_inverse=True)
    surplus = np.zeros(len(edges), np.int64)
    np.add.at(surplus, which.reshape(-1), np.sign(end - start))
    found = edges[surplus != 0]
    return found[:, 0], found[:, 1]
