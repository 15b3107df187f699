# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How finely round shapes are cut into triangles: finely where they are few, by their size where they are many.

A chord over 1/s of a turn departs from a circle of radius r by about r / s². With s proportional to √r all shapes of a
scene depart by the same length, so that none is finer than it needs to be beside the others.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from eclat.errors import EclatError
from eclat.loaders.mitsuba.node import Node
from eclat.loaders.mitsuba.primitives import SEGMENTS

MOST_TRIANGLES = 2_000_000
"""For all round shapes of a scene together: 124 spheres of the finest cut, or a hundred thousand of the coarsest."""

FEWEST_SEGMENTS = 6
"""Divisions of a turn; a sphere is then 24 triangles. Its area, and so its power as a lamp, is exact all the same."""

ROUND = ("sphere", "cylinder", "disk")


def triangles_of(kind: str, segments: int) -> int:
    """Triangles of a round shape of that many divisions of a turn."""
    return {"sphere": segments * (segments - 2), "cylinder": 2 * segments, "disk": segments}[kind]


class Tessellation:
    """The divisions of a turn of each round shape in a tree."""

    def __init__(self, tree: Node) -> None:
        found = [(node, copies, _radius(node)) for node, copies in _round_shapes(tree, 1)]
        self._segments: dict[int, int] = {}
        if not found:
            return
        roots = np.sqrt(np.array([radius for _, _, radius in found]))
        least = float(roots[roots > 0].min()) if (roots > 0).any() else 1.0

        def cut(scale: float) -> list[int]:
            # An even number, so that a sphere has an equator.
            rounded = 2 * np.round(np.minimum(scale * roots, SEGMENTS) / 2)
            return [int(s) for s in np.clip(rounded, FEWEST_SEGMENTS, SEGMENTS)]

        def total(segments: list[int]) -> int:
            return sum(c * triangles_of(n.type, s) for (n, c, _), s in zip(found, segments, strict=True))

        low, high = 0.0, SEGMENTS / least
        best = cut(high)
        if total(best) > MOST_TRIANGLES:
            for _ in range(40):
                middle = (low + high) / 2
                low, high = (middle, high) if total(cut(middle)) <= MOST_TRIANGLES else (low, middle)
            best = cut(low)
        self._segments = {id(node): segments for (node, _, _), segments in zip(found, best, strict=True)}

    def segments(self, node: Node) -> int:
        """Divisions of a turn of the round shape `node`."""
        return self._segments.get(id(node), SEGMENTS)


def _round_shapes(tree: Node, copies: int) -> Iterator[tuple[Node, int]]:
    """Round shapes with how often they stand in the scene: those of a group once for each of its instances."""
    instances: dict[int, tuple[Node, int]] = {}
    for _, node in tree.of_tag("shape"):
        if node.type in ROUND:
            yield node, copies
        elif node.type == "merge":
            yield from _round_shapes(node, copies)
        elif node.type == "instance":
            for _, group in node.of_tag("shape"):
                instances[id(group)] = (group, instances.get(id(group), (group, 0))[1] + copies)
    for group, count in instances.values():
        yield from _round_shapes(group, count)


def _radius(node: Node) -> float:
    """About the radius in the world; 0 where the numbers make no sense, which is said when the shape is made."""
    try:
        scale = abs(float(np.linalg.det(node.transform("to_world")[:3, :3]))) ** (1 / 3)
        radius = scale * (1.0 if node.type == "disk" else node.number("radius", default=1.0))
    except EclatError:
        return 0.0
    return radius if math.isfinite(radius) and radius > 0 else 0.0
