# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Skins: meshes whose vertices follow joints [glTF 2.0, 3.7.3]."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.gltf.accessors import Accessors
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import Element

Matrix = NDArray[np.float64]


def joint_indices(document: Document, node: Element) -> list[int] | None:
    """Return the nodes that are the joints of a node's skin, or None if it has no skin. Raises EclatError."""
    skin = document.element(node, "skin", "skins")
    if skin is None:
        return None
    return skin.indices("joints", len(document.elements("nodes")), "nodes")


def joint_matrices(
    document: Document, accessors: Accessors, node: Element, places: Mapping[int, Matrix]
) -> Matrix | None:
    """Return the matrices (joints, 4, 4) that map vertices in the bind pose to world space; None without a skin.

    `places` are the matrices of the nodes to world space. Raises EclatError if the skin is invalid.
    """
    skin = document.element(node, "skin", "skins")
    joints = joint_indices(document, node)
    if skin is None or joints is None:
        return None
    if not joints or not set(joints) <= places.keys():
        raise EclatError(f"{skin.where}: expected joints that are visible nodes of the scene, got others or none")
    worlds = np.stack([places[joint] for joint in joints])
    columns = accessors.floats(skin, "inverseBindMatrices", ("MAT4",))
    if columns is None:
        return worlds
    if len(columns) < len(joints):
        raise EclatError(
            f"{skin.where}: expected {len(joints)} inverseBindMatrices, one for each joint, got {len(columns)}"
        )
    with np.errstate(all="ignore"):
        binds = columns[: len(joints)].astype(np.float64).reshape(-1, 4, 4).transpose(0, 2, 1)
        found: Matrix = worlds @ binds
    if not np.isfinite(found).all():
        raise EclatError(f"{skin.where}: expected finite inverseBindMatrices, got others")
    return found


def read_skinning(
    element: Element, accessors: Accessors, vertices: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Read which joints the vertices of a primitive follow: joints and weights, (V, 4 n) each; weights sum to 1.

    Raises EclatError if an attribute is missing or invalid.
    """
    attributes = element.child("attributes") or Element({}, element.where)
    joints, weights = [], []
    for number in range(8):
        if f"JOINTS_{number}" not in attributes.data:
            break
        indices = accessors.floats(attributes, f"JOINTS_{number}", ("VEC4",))
        shares = accessors.floats(attributes, f"WEIGHTS_{number}", ("VEC4",))
        if indices is None or shares is None or len(indices) != vertices or len(shares) != vertices:
            raise EclatError(
                f"{element.where}: expected {vertices} elements of JOINTS_{number} and of WEIGHTS_{number}"
            )
        joints.append(indices.astype(np.float64))
        weights.append(shares.astype(np.float64))
    if not joints:
        raise EclatError(
            f"{element.where}: expected the attributes JOINTS_0 and WEIGHTS_0 of a mesh with a skin, got none"
        )
    which, share = np.concatenate(joints, axis=1), np.concatenate(weights, axis=1)
    if not (np.isfinite(which).all() and np.isfinite(share).all() and (which >= 0).all() and (share >= 0).all()):
        raise EclatError(f"{element.where}: expected finite joints and weights of at least 0, got others")
    total = share.sum(axis=1, keepdims=True)
    loose = total[:, 0] <= 0
    if loose.any():
        warn(f"{element.where}: {int(loose.sum())} vertices have no weight; they follow their first joint")
        share[loose, 0], total[loose] = 1.0, 1.0
    return which.astype(np.int64), share / total
