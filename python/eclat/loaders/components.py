# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Triangles as a graph: their edges and their connected components."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]


def edges_of(triangles: Ints) -> tuple[Ints, Ints]:
    """All 3 T edges as pairs of vertices, the smaller first, sorted, so that shared ones follow each other, and the
    triangle of each."""
    edges = np.sort(np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2), axis=1)
    owners = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort((owners, edges[:, 1], edges[:, 0]))
    return edges[order], owners[order]


def connected(count: int, a: Ints, b: Ints) -> Ints:
    """(count,) the smallest member of each one's component, where a[i] and b[i] are joined, by pointers that jump until
    nothing changes."""
    labels = np.arange(count)
    while True:
        before = labels.copy()
        low = np.minimum(labels[a], labels[b])
        np.minimum.at(labels, labels[a], low)
        np.minimum.at(labels, labels[b], low)
        labels = labels[labels]
        if (labels == before).all():
            return labels
