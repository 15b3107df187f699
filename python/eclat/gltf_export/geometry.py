# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Meshes as glTF's primitives [glTF 2.0, 3.7.2]."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from eclat.gltf_export.document import INDICES, VERTICES, Document, Json
from eclat.scene import FloatArray, Mesh

SMALL_INDICES = 65535
"""Vertices up to which two bytes an index suffice: the last value is reserved for restarting strips."""


@dataclass(frozen=True, eq=False)
class Part:
    """One mesh of the file.

    `one_of_two`: one side of a two-sided sheet whose other side is a part of its own; `back`: that is its back.
    `lightmap_uvs` (V, 2): where its vertices lie in the light map.
    """

    mesh: Mesh
    one_of_two: bool = False
    back: bool = False
    lightmap_uvs: FloatArray | None = None


def reversed_sides(mesh: Mesh) -> Mesh:
    """The mesh seen from behind: its triangles and normals turned over, its normal map looking the same."""
    tangents = mesh.tangents
    if tangents is not None:
        # The bitangent is w · normal × tangent: with the normal turned over, w keeps it where it is.
        tangents = np.asarray(tangents) * np.array([1, 1, 1, -1], np.float32)
    return replace(
        mesh,
        triangles=np.ascontiguousarray(np.asarray(mesh.triangles)[:, ::-1]),
        normals=None if mesh.normals is None else -np.asarray(mesh.normals),
        tangents=tangents,
    )


def with_flat_normals(mesh: Mesh) -> Mesh:
    """The mesh with a normal at every vertex: one that is shaded flat gets a vertex for each normal that meets there."""
    if mesh.normals is not None:
        return mesh
    corners = np.asarray(mesh.triangles).ravel()
    normals = np.repeat(face_normals(mesh), 3, axis=0)
    # Triangles of one plane share vertices, though rounding tells their normals apart.
    keys = np.column_stack((corners, np.rint(normals * 1e5).astype(np.int64)))
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    chosen = corners[first]
    split = select_vertices(mesh, chosen, inverse.reshape(-1, 3))
    return replace(split, normals=normals[first].astype(np.float32))


def select_vertices(mesh: Mesh, vertices: np.ndarray, triangles: np.ndarray) -> Mesh:
    """The mesh with copies of the vertices numbered `vertices`, and triangles that refer to these copies."""

    def taken(values: FloatArray | None) -> FloatArray | None:
        return None if values is None else np.asarray(values)[vertices]

    return replace(
        mesh,
        positions=np.asarray(mesh.positions)[vertices],
        triangles=triangles,
        normals=taken(mesh.normals),
        uvs=taken(mesh.uvs),
        uvs2=taken(mesh.uvs2),
        colors=taken(mesh.colors),
        tangents=taken(mesh.tangents),
    )


def face_normals(mesh: Mesh) -> FloatArray:
    """(T, 3) unit normals of the triangles; of those without area +z."""
    a, b, c = (np.asarray(mesh.positions, np.float64)[np.asarray(mesh.triangles)[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    with np.errstate(all="ignore"):
        unit: FloatArray = normals / lengths[:, None]
    unit[~(lengths > 0) | ~np.isfinite(unit).all(axis=1)] = (0, 0, 1)
    return unit


def bounds_of(parts: Sequence[Part]) -> FloatArray:
    """(2, 3) lowest and highest corner; infinite where there is nothing."""
    found = [np.asarray(part.mesh.positions, np.float64) for part in parts if len(part.mesh.positions)]
    if not found:
        return np.array([[np.inf] * 3, [-np.inf] * 3])
    return np.array([np.min([p.min(axis=0) for p in found], axis=0), np.max([p.max(axis=0) for p in found], axis=0)])


def primitive(document: Document, part: Part, material: int) -> Json:
    """The primitive of a part, its arrays written into the document."""
    mesh = with_flat_normals(part.mesh) if part.lightmap_uvs is None else part.mesh
    count = len(mesh.positions)
    normals = np.zeros((count, 3)) if mesh.normals is None else np.asarray(mesh.normals, np.float64)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(lengths > 0, normals / np.where(lengths > 0, lengths, 1), (0.0, 0.0, 1.0))

    def vertex(values: np.ndarray, bounds: bool = False) -> int:
        return document.accessor(values, "f4", VERTICES, bounds=bounds)

    attributes: Json = {"POSITION": vertex(np.asarray(mesh.positions), True), "NORMAL": vertex(normals)}
    if mesh.tangents is not None and mesh.material.normal_map is not None:
        attributes["TANGENT"] = vertex(np.asarray(mesh.tangents))
    for i, uvs in enumerate(_uv_sets(mesh, part.lightmap_uvs)):
        attributes[f"TEXCOORD_{i}"] = vertex(np.asarray(uvs))
    if mesh.material.vertex_colors and mesh.colors is not None:
        attributes["COLOR_0"] = vertex(np.asarray(mesh.colors))
    kind = "u2" if count <= SMALL_INDICES else "u4"
    indices = document.accessor(np.asarray(mesh.triangles).ravel(), kind, INDICES)
    return {"attributes": attributes, "indices": indices, "material": material}


def _uv_sets(mesh: Mesh, lightmap: FloatArray | None) -> list[FloatArray]:
    """TEXCOORD_0, 1, …: numbers without a gap, as the specification wants, so that a missing set is filled by another."""
    if lightmap is None:
        if mesh.uvs2 is None:
            return [] if mesh.uvs is None else [mesh.uvs]
        return [mesh.uvs2 if mesh.uvs is None else mesh.uvs, mesh.uvs2]
    first = lightmap if mesh.uvs is None else mesh.uvs
    return [first, lightmap] + ([] if mesh.uvs2 is None else [mesh.uvs2])
