# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Choose the number of segments of round shapes: the largest if there are few shapes, otherwise depending on their size.

With s segments, the distance of a chord from a circle of radius r is about 5 r / s². If s is proportional to √r, this
distance is the same for all shapes of a scene, so that the triangles are distributed well among them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from eclat.errors import EclatError
from eclat.loaders.mitsuba.node import Node
from eclat.loaders.mitsuba.primitives import SEGMENTS

MOST_TRIANGLES = 2_000_000
"""The largest number of triangles of all round shapes of a scene together. This is enough for 124 spheres with the largest
number of segments, or for about 83,000 spheres with the smallest."""

FEWEST_SEGMENTS = 6
"""The smallest number of segments around a shape. A sphere then has 24 triangles. Even so, its area is exact, and with it
its power as an emitter."""

ROUND = ("sphere", "cylinder", "disk")
"""The types of round shapes."""


def triangle_count(kind: str, segments: int) -> int:
    """Return the number of triangles of a round shape of type `kind` with `segments` segments."""
    return {"sphere": segments * (segments - 2), "cylinder": 2 * segments, "disk": segments}[kind]


class Tessellation:
    """The number of segments of each round shape in a tree."""

    def __init__(self, tree: Node) -> None:
        found = [(node, copies, _radius(node)) for node, copies in _round_shapes(tree, 1)]
        self._segments: dict[int, int] = {}
        if not found:
            return
        roots = np.sqrt(np.array([radius for _, _, radius in found]))
        least = float(roots[roots > 0].min()) if (roots > 0).any() else 1.0

        def cut(scale: float) -> list[int]:
            # The number is even, so that a sphere has an equator.
            rounded = 2 * np.round(np.minimum(scale * roots, SEGMENTS) / 2)
            return [int(s) for s in np.clip(rounded, FEWEST_SEGMENTS, SEGMENTS)]

        def total(segments: list[int]) -> int:
            return sum(c * triangle_count(n.type, s) for (n, c, _), s in zip(found, segments, strict=True))

        low, high = 0.0, SEGMENTS / least
        best = cut(high)
        if total(best) > MOST_TRIANGLES:
            for _ in range(40):
                middle = (low + high) / 2
                low, high = (middle, high) if total(cut(middle)) <= MOST_TRIANGLES else (low, middle)
            best = cut(low)
        self._segments = {id(node): segments for (node, _, _), segments in zip(found, best, strict=True)}

    def segments(self, node: Node) -> int:
        """Return the number of segments around the round shape `node`."""
        return self._segments.get(id(node), SEGMENTS)


def _round_shapes(tree: Node, copies: int) -> Iterator[tuple[Node, int]]:
    """Yield each round shape below `tree`, and how often it occurs in the scene.

    A shape in a group occurs once for each instance of the group. `copies` is how often `tree` itself occurs.
    """
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
    """Return the approximate radius of a round shape in world space.

    It is 0 if a number is invalid, which raises an error later, when the shape is converted.
    """
    try:
        scale = abs(float(np.linalg.det(node.transform("to_world")[:3, :3]))) ** (1 / 3)
        radius = scale * (1.0 if node.type == "disk" else node.number("radius", default=1.0))
    except EclatError:
        return 0.0
    return radius if math.isfinite(radius) and radius > 0 else 0.0
