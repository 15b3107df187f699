# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Resolve references: replace each `ref` node by the object with its id, which may precede or follow it in the file."""

from __future__ import annotations

from eclat.errors import EclatError, did_you_mean, warn
from eclat.loaders.mitsuba.node import MAX_DEPTH, Node


class Identifiers:
    """The objects of a scene by id, and the aliases of ids."""

    def __init__(self) -> None:
        self.nodes: dict[str, Node] = {}
        self.aliases: dict[str, tuple[str, str]] = {}

    def add(self, name: str, node: Node) -> None:
        """Register `node` under the id `name`, unless the name is empty.

        If the id exists already, references still refer to the first object, and a warning says so.
        """
        if not name:
            return
        if name in self.nodes:
            warn(
                f"{node.where}: the id {name!r} is also the id of {self.nodes[name].where}; references use that object"
            )
            return
        self.nodes[name] = node

    def alias(self, name: str, other: str, where: str) -> None:
        """Register `other` as an alias of the id `name`."""
        self.aliases[other] = (name, where)

    def find(self, name: str, where: str) -> Node:
        """Find the object with the id or alias `name`.

        Raises EclatError if there is no such object or if aliases refer to each other in a circle.
        """
        start = name
        for _ in range(len(self.aliases) + 1):
            if name in self.nodes:
                return self.nodes[name]
            if name not in self.aliases:
                known = [*self.nodes, *self.aliases]
                raise EclatError(
                    f"{where}: expected the id of an object, got {name[:80]!r}, which no object has"
                    f"{did_you_mean(name[:80], known)}"
                )
            name, where = self.aliases[name]
        raise EclatError(f"{where}: the alias {start[:80]!r} refers to itself")


def resolve_references(scene: Node, identifiers: Identifiers) -> None:
    """Replace every `ref` in the tree below `scene` by the object that it refers to.

    Raises EclatError if an id is unknown, an object refers to itself, or the tree becomes too deep.
    """
    _resolve(scene, identifiers, {}, 0)


def _resolve(node: Node, identifiers: Identifiers, heights: dict[int, int], depth: int) -> int:
    """Replace the references below `node`, and return the height of its tree.

    `heights` contains the height of each visited node by the `id` of the Python object, or −1 while a node is visited.
    `depth` is the depth of `node`.
    """
    known = heights.get(id(node))
    if known == -1:
        raise EclatError(f"{node.where}: expected references without cycles, but this object refers to itself")
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
        raise EclatError(
            f"{node.where}: expected at most {MAX_DEPTH} levels of nested objects and references, got more"
        )
