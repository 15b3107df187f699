# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Transform meshes, and make the orientation of their triangles agree with their normals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eclat.loaders.mitsuba.transforms import (
    Matrix,
    is_mirrored,
    normalize,
    transform_directions,
    transform_normals,
    transform_points,
)
from eclat.scene import FloatArray, Mesh


def transform_mesh(mesh: Mesh, matrix: Matrix) -> Mesh:
    """Transform `mesh` by the 4×4 `matrix`.

    If the mesh has normals, triangles are reversed where necessary so that their front side is that of the normals. In
    Mitsuba, the shading normals determine the side that emits light. If the mesh has no normals, a reflection turns it
    inside out, as in Mitsuba.
    """
    positions = transform_points(matrix, mesh.positions)
    tangents = mesh.tangents
    if tangents is not None:
        directions = normalize(transform_directions(matrix, tangents[:, :3]))
        sign = -tangents[:, 3:] if is_mirrored(matrix) else tangents[:, 3:]
        tangents = np.concatenate([directions, sign], axis=1)
    if mesh.normals is None:
        return replace(mesh, positions=positions, tangents=tangents)
    normals = transform_normals(matrix, mesh.normals)
    triangles = orient_triangles(positions, mesh.triangles, normals)
    return replace(mesh, positions=positions, triangles=triangles, normals=normals, tangents=tangents)


def orient_triangles(positions: FloatArray, triangles: NDArray[np.integer], normals: FloatArray) -> NDArray[np.integer]:
    """Reverse each triangle whose geometric normal points away from the sum of its vertex normals.

    `positions` and `normals` have the shape (V, 3), and `triangles` (T, 3) are vertex indices.
    """
    corners = np.asarray(positions, dtype=np.float64)[triangles]
    with np.errstate(over="ignore", invalid="ignore"):
        geometric = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        against = np.einsum("ij,ikj->i", geometric, np.asarray(normals, dtype=np.float64)[triangles]) < 0
    if not against.any():
        return triangles
    return np.where(against[:, None], triangles[:, ::-1], triangles)
