# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""References: each `ref` in the tree is replaced by the object with that id, which may come before or after it."""

from __future__ import annotations

from eclat.errors import EclatError, did_you_mean, warn
from eclat.loaders.mitsuba.node import MAX_DEPTH, Node


class Identifiers:
    """The objects of a scene by their ids."""

    def __init__(self) -> None:
        self.nodes: dict[str, Node] = {}
        self.aliases: dict[str, tuple[str, str]] = {}

    def add(self, name: str, node: Node) -> None:
        """Remember `node`; of two with the same id the first stays, with a warning."""
        if not name:
            return
        if name in self.nodes:
            warn(f"{node.where}: the id {name!r} is taken by {self.nodes[name].where}, to which references go")
            return
        self.nodes[name] = node

    def alias(self, name: str, other: str, where: str) -> None:
        """Add the alias `other` for the object `name`."""
        self.aliases[other] = (name, where)

    def find(self, name: str, where: str) -> Node:
        """The object called `name`. Raises EclatError for unknown names and circles of aliases."""
        start = name
        for _ in range(len(self.aliases) + 1):
            if name in self.nodes:
                return self.nodes[name]
            if name not in self.aliases:
                known = [*self.nodes, *self.aliases]
                raise EclatError(f"{where}: no object has the id {name[:80]!r}{did_you_mean(name[:80], known)}")
            name, where = self.aliases[name]
        raise EclatError(f"{where}: the alias {start[:80]!r} leads in a circle")


def resolve_references(scene: Node, identifiers: Identifiers) -> None:
    """Replace every `ref` below `scene`. Raises EclatError for unknown ids, circles and chains that are too long."""
    _resolve(scene, identifiers, {}, 0)


def _resolve(node: Node, identifiers: Identifiers, heights: dict[int, int], depth: int) -> int:
    """Resolve below `node` and return its height; `heights` has −1 for nodes that are being visited."""
    known = heights.get(id(node))
    if known == -1:
        raise EclatError(f"{node.where}: an object refers to itself")
    height = 0
    if known is None:
        heights[id(node)] = -1
        for index, (name, child) in enumerate(node.children):
            if child.tag == "ref":
                child = identifiers.find(child.id, child.where)
                node.children[index] = (name, child)
            _check_depth(child, depth + 1)
            height = max(height, 1 + _resolve(child, identifiers, heights, depth + 1))
        heights[id(node)] = known = height
    _check_depth(node, depth + known)
    return known


def _check_depth(node: Node, depth: int) -> None:
    if depth > MAX_DEPTH:
        raise EclatError(f"{node.where}: objects and references are nested more than {MAX_DEPTH} deep")
