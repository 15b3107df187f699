# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Moves meshes by a matrix and makes their winding agree with their normals."""

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


def placed(mesh: Mesh, matrix: Matrix) -> Mesh:
    """`mesh` moved by the 4×4 `matrix`.

    With normals the winding follows them, also where the file's does not or `matrix` mirrors: Mitsuba lets shading
    normals decide which side shines. Without normals a mirrored mesh is turned inside out, as in Mitsuba.
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
    triangles = facing(positions, mesh.triangles, normals)
    return replace(mesh, positions=positions, triangles=triangles, normals=normals, tangents=tangents)


def facing(positions: FloatArray, triangles: NDArray[np.integer], normals: FloatArray) -> NDArray[np.integer]:
    """The `triangles`; those whose winding opposes the sum of their vertex normals are reversed."""
    corners = np.asarray(positions, dtype=np.float64)[triangles]
    with np.errstate(over="ignore", invalid="ignore"):
        geometric = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        against = np.einsum("ij,ikj->i", geometric, np.asarray(normals, dtype=np.float64)[triangles]) < 0
    if not against.any():
        return triangles
    return np.where(against[:, None], triangles[:, ::-1], triangles)
