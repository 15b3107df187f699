# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read the node hierarchy: the nodes of a scene and their transforms [glTF 2.0, 3.5]."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.budget import check
from eclat.loaders.gltf.accessors import Accessors
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import Element

Matrix = NDArray[np.float64]
_INSTANCING = "EXT_mesh_gpu_instancing"
_INSTANCE_SIZE = 512
"""The number of bytes that a transform takes while it is computed: four 4×4 matrices of float64."""


def scene_nodes(document: Document) -> Iterator[tuple[int, Element, Matrix]]:
    """Yield the index of each visible node of the default scene, the node, and the 4×4 matrix from its space to world
    space.

    Parents come before their children, and siblings are in the order of the file.

    Raises
    ------
    EclatError : a node is its own ancestor or has two parents, or a matrix is not affine or not finite.
    """
    nodes = document.elements("nodes")
    children = [node.indices("children", len(nodes), "nodes") for node in nodes]
    parents = _parents(nodes, children)
    seen = [False] * len(nodes)
    stack = [(index, np.eye(4)) for index in reversed(_roots(document, parents))]
    while stack:
        index, outer = stack.pop()
        node = nodes[index]
        if seen[index]:
            raise EclatError(
                f"{node.where}: expected a tree of nodes, got a node that is its own ancestor or that occurs twice"
            )
        seen[index] = True
        visibility = node.extension("KHR_node_visibility")
        if visibility is not None and not visibility.flag("visible", True):
            continue
        with np.errstate(all="ignore"):
            to_world = outer @ local_matrix(node)
        if not np.isfinite(to_world).all():
            raise EclatError(
                f"{node.where}: expected a finite transform, got an overflow: the product of the scales of this node and "
                "its ancestors is too large"
            )
        yield index, node, to_world
        stack.extend((child, to_world) for child in reversed(children[index]))


def local_matrix(node: Element) -> Matrix:
    """Return the 4×4 transform of a node relative to its parent.

    It is read from `matrix`, or from translation, rotation and scale. Raises EclatError if it is invalid.
    """
    if node.data.get("matrix") is not None:
        matrix: Matrix = np.array(node.numbers("matrix", 16)).reshape(4, 4).T
        if not np.allclose(matrix[3], (0, 0, 0, 1), rtol=0, atol=1e-6):
            raise EclatError(
                f"{node.at('matrix')}: expected an affine matrix, whose last row is 0 0 0 1, "
                f"got the last row {matrix[3].tolist()}"
            )
        matrix[3] = (0, 0, 0, 1)
        return matrix
    translation = np.array(node.numbers("translation", 3, (0, 0, 0)))
    rotation = np.array(node.numbers("rotation", 4, (0, 0, 0, 1)))
    scale = np.array(node.numbers("scale", 3, (1, 1, 1)))
    local: Matrix = _trs(translation[None], rotation[None], scale[None], node)[0]
    return local


def instances(node: Element, accessors: Accessors) -> Matrix:
    """Return the transforms (N, 4, 4) of the N instances of a node's mesh, relative to the node.

    Without EXT_mesh_gpu_instancing there is one instance. Raises EclatError if the attributes are invalid.
    """
    extension = node.extension(_INSTANCING)
    attributes = extension.child("attributes") if extension is not None else None
    if attributes is None:
        return np.eye(4)[None]
    found = {
        name: accessors.floats(attributes, name, types)
        for name, types in (("TRANSLATION", ("VEC3",)), ("ROTATION", ("VEC4",)), ("SCALE", ("VEC3",)))
    }
    counts = {len(values) for values in found.values() if values is not None}
    if len(counts) != 1:
        raise EclatError(f"{attributes.where}: expected attributes with equal counts, got {sorted(counts)}")
    count = counts.pop()
    check(_INSTANCE_SIZE * count, attributes.where)
    if count == 0:
        raise EclatError(f"{attributes.where}: expected at least one instance, got none")

    def of(name: str, default: tuple[float, ...]) -> Matrix:
        values = found[name]
        with np.errstate(invalid="ignore"):  # NaN, which is refused with the transforms
            return np.tile(np.array(default, np.float64), (count, 1)) if values is None else values.astype(np.float64)

    return _trs(of("TRANSLATION", (0, 0, 0)), of("ROTATION", (0, 0, 0, 1)), of("SCALE", (1, 1, 1)), attributes)


def _trs(translation: Matrix, rotation: Matrix, scale: Matrix, owner: Element) -> Matrix:
    """Return the matrices (N, 4, 4) of N translations, quaternions (x, y, z, w) and scales."""
    lengths = np.linalg.norm(rotation, axis=1, keepdims=True)
    finite = all(np.isfinite(values).all() for values in (translation, rotation, scale))
    if not finite or not (lengths > 0).all():
        raise EclatError(f"{owner.where}: expected finite transforms and nonzero quaternions, got others")
    if np.abs(lengths - 1).max(initial=0) > 0.01:
        warn(
            f"{owner.where}: expected a rotation by a unit quaternion, got one of length {float(lengths[0, 0]):.3g}; "
            "it is normalised"
        )
    x, y, z, w = (rotation / lengths).T
    matrices = np.zeros((len(rotation), 4, 4))
    matrices[:, 0, :3] = np.column_stack((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)))
    matrices[:, 1, :3] = np.column_stack((2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)))
    matrices[:, 2, :3] = np.column_stack((2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    matrices[:, :3, :3] *= scale[:, None, :]
    matrices[:, :3, 3] = translation
    matrices[:, 3, 3] = 1
    return matrices


def moving_with(document: Document, moved: set[int]) -> set[int]:
    """Return the nodes that move if the nodes `moved` do: these and all nodes below them."""
    nodes = document.elements("nodes")
    found: set[int] = set()
    stack = [index for index in moved if index < len(nodes)]
    while stack:
        index = stack.pop()
        if index not in found:
            found.add(index)
            stack.extend(nodes[index].indices("children", len(nodes), "nodes"))
    return found


def _parents(nodes: list[Element], children: list[list[int]]) -> list[int | None]:
    parents: list[int | None] = [None] * len(nodes)
    for parent, indices in enumerate(children):
        for child in indices:
            if parents[child] is not None:
                raise EclatError(
                    f"{nodes[child].where}: expected one parent, got nodes[{parents[child]}] and nodes[{parent}]"
                )
            parents[child] = parent
    return parents


def _roots(document: Document, parents: list[int | None]) -> list[int]:
    scenes = document.elements("scenes")
    if not scenes:
        return [index for index, parent in enumerate(parents) if parent is None]
    default = document.root.index("scene", len(scenes), "scenes") or 0
    if len(scenes) > 1:
        warn(f"{document.name}: the file has {len(scenes)} scenes; only scenes[{default}] is loaded")
    return scenes[default].indices("nodes", len(parents), "nodes")
