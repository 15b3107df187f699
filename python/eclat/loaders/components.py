# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The graph of a triangle mesh: the edges of triangles, and connected components."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]


def triangle_edges(triangles: Ints) -> tuple[Ints, Ints]:
    """List the 3 T edges of T triangles.

    Returns
    -------
    (3 T, 2) the vertices of each edge, the smaller index first. The rows are sorted, so that equal edges of different
    triangles are adjacent. (3 T,) the triangle that each edge belongs to.
    """
    edges = np.sort(np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2), axis=1)
    owners = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort((owners, edges[:, 1], edges[:, 0]))
    return edges[order], owners[order]


def connected_components(count: int, a: Ints, b: Ints) -> Ints:
    """Label the connected components of a graph with nodes 0 … count − 1 and edges from a[i] to b[i].

    Each node points to a smaller or equal node of its component. Pointers are lowered along the edges and followed
    to the next pointer until nothing changes.

    Returns
    -------
    (count,) for each node, the smallest node of its component.
    """
    labels = np.arange(count)
    while True:
        before = labels.copy()
        low = np.minimum(labels[a], labels[b])
        np.minimum.at(labels, labels[a], low)
        np.minimum.at(labels, labels[b], low)
        labels = labels[labels]
        if (labels == before).all():
            return labels
