# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Move the vertices of a mesh with the joints of its skin [glTF 2.0, 3.7.3.3]."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.loaders.gltf.primitives import Primitive, unit_vectors
from eclat.scene import Material, Mesh

Matrix = NDArray[np.float64]


def bend_primitive(primitive: Primitive, joints: Matrix, material: Material, name: str) -> Mesh:
    """Move the vertices of a primitive with its joints, and make a mesh in world space.

    `joints` are those of `joint_matrices`. Raises EclatError if a vertex follows a joint that does not exist, or if
    positions overflow float32.
    """
    assert primitive.joints is not None and primitive.weights is not None
    used = primitive.weights > 0
    if primitive.joints[used].max(initial=0) >= len(joints):
        raise EclatError(
            f"{primitive.where}: expected joints below {len(joints)}, the number of joints of the skin, got "
            f"{int(primitive.joints[used].max())}"
        )
    matrices = np.zeros((len(primitive.positions), 4, 4))
    for column in range(primitive.joints.shape[1]):
        share = primitive.weights[:, column]
        if share.any():
            matrices += share[:, None, None] * joints[np.where(share > 0, primitive.joints[:, column], 0)]
    linear = matrices[:, :3, :3]
    with np.errstate(all="ignore"):
        positions = np.einsum("vij,vj->vi", linear, primitive.positions) + matrices[:, :3, 3]
        if not np.isfinite(positions.astype(np.float32)).all():
            raise EclatError(
                f"{primitive.where}: expected finite positions in world space, got an overflow by the joints"
            )
        mirrored = bool(np.sign(np.linalg.det(linear)).sum() < 0)
    sign = -1 if mirrored else 1
    normals, tangents = primitive.normals, primitive.tangents
    if normals is not None:
        # The rows of the cofactor matrix are cross products of the rows of the matrix.
        turned = [np.cross(linear[:, (i + 1) % 3], linear[:, (i + 2) % 3]) for i in range(3)]
        normals = unit_vectors(sign * np.einsum("ivj,vj->vi", np.stack(turned), normals))
    if tangents is not None:
        along = unit_vectors(np.einsum("vij,vj->vi", linear, tangents[:, :3]))
        tangents = np.column_stack((along, sign * tangents[:, 3])).astype(np.float32)
    triangles = primitive.triangles[:, [0, 2, 1]] if mirrored else primitive.triangles
    return Mesh(
        positions, triangles, material, normals, primitive.uvs, primitive.uvs2, primitive.colors, tangents, name
    )
