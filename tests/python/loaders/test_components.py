# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Connected pieces, against a search that goes step by step."""

from __future__ import annotations

import numpy as np

from eclat.loaders.components import connected_components, triangle_edges


def test_connected_components_are_labelled() -> None:
    rng = np.random.default_rng(2)
    for count, pairs in ((1, 0), (50, 20), (200, 180), (300, 1000)):
        a, b = rng.integers(0, count, (2, pairs))
        neighbours: dict[int, set[int]] = {i: {i} for i in range(count)}
        for i, j in zip(a.tolist(), b.tolist(), strict=True):
            neighbours[i].add(j), neighbours[j].add(i)
        wanted = np.full(count, -1)
        for start in range(count):
            stack = [start] if wanted[start] < 0 else []
            while stack:
                i = stack.pop()
                if wanted[i] < 0:
                    wanted[i] = start
                    stack += neighbours[i]
        np.testing.assert_array_equal(connected_components(count, a, b), wanted)


def test_a_long_chain_of_nodes_is_connected() -> None:
    order = np.random.default_rng(3).permutation(1000)
    assert (connected_components(1000, order[:-1], order[1:]) == 0).all()


def test_edges() -> None:
    edges, owners = triangle_edges(np.array([[0, 1, 2], [2, 1, 3]]))
    assert edges.tolist() == [[0, 1], [0, 2], [1, 2], [1, 2], [1, 3], [2, 3]]
    assert owners.tolist() == [0, 0, 0, 1, 1, 1]
