# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Following the links of a node tree from an input to the node that feeds it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

MOST_STEPS = 1000
"""Bound on the number of reroutes and groups between two nodes, far more than a person makes."""


@dataclass(frozen=True)
class Found:
    """What feeds an input: the output `socket` of `node`, or, if `node` is None, the input `socket` with its own value.

    `groups` are the group nodes around it, the outermost first.
    """

    node: Any
    socket: Any
    groups: tuple[Any, ...]


def follow(socket: Any, groups: tuple[Any, ...] = ()) -> Found:
    """Follow an input `socket` inside `groups` through reroutes, muted nodes, and into and out of groups."""
    for _ in range(MOST_STEPS):
        link = next((link for link in socket.links if link.is_valid and not link.is_muted), None)
        if link is None:
            return Found(None, socket, groups)
        node, output = link.from_node, link.from_socket
        if node.mute:
            behind = next((inner.from_socket for inner in node.internal_links if inner.to_socket == output), None)
            if behind is None:
                return Found(None, socket, groups)
            socket = behind
        elif node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.type == "GROUP" and node.node_tree is not None:
            ends = [inner for inner in node.node_tree.nodes if inner.type == "GROUP_OUTPUT"]
            end = next((inner for inner in ends if inner.is_active_output), None)
            if end is None:
                return Found(None, socket, groups)
            socket, groups = _same(end.inputs, output), (*groups, node)
        elif node.type == "GROUP_INPUT" and groups:
            socket, groups = _same(groups[-1].inputs, output), groups[:-1]
        else:
            return Found(node, output, groups)
    raise RecursionError(f"the links of {socket.name!r} have no end")


def active_output(tree: Any, kind: str) -> Any:
    """Return the output node of the type `kind` that renderers use, or None."""
    if tree is None:
        return None
    ends = [node for node in tree.nodes if node.type == kind]
    usual = [node for node in ends if getattr(node, "target", "ALL") in ("ALL", "CYCLES")]
    return next((node for node in usual if node.is_active_output), usual[0] if usual else None)


def _same(sockets: Any, wanted: Any) -> Any:
    return next(socket for socket in sockets if socket.identifier == wanted.identifier)
