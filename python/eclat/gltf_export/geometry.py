# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Write meshes as primitives [glTF 2.0, 3.7.2]."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from eclat.gltf_export.document import INDICES, VERTICES, Document, Json
from eclat.scene import FloatArray, Mesh

SMALL_INDICES = 65535
"""The largest number of vertices for 16-bit indices. The index 65535 is reserved for primitive restart."""


@dataclass(frozen=True, eq=False)
class Part:
    """A mesh of the file.

    Parameters
    ----------
    mesh : the mesh.
    one_of_two : whether the mesh is one side of a two-sided mesh whose other side is a separate part.
    back : whether it is the back side of such a mesh.
    lightmap_uvs : (V, 2) texture coordinates of the vertices in the light map.
    lightmap_page : the page of the light map to which they belong.
    """

    mesh: Mesh
    one_of_two: bool = False
    back: bool = False
    lightmap_uvs: FloatArray | None = None
    lightmap_page: int = 0


def reversed_sides(mesh: Mesh) -> Mesh:
    """Reverse the triangles and normals of a mesh. The tangents are adapted so that its normal map looks the same."""
    tangents = mesh.tangents
    if tangents is not None:
        # The bitangent is w · normal × tangent. Both w and the normal are reversed, so that it does not change.
        tangents = np.asarray(tangents) * np.array([1, 1, 1, -1], np.float32)
    return replace(
        mesh,
        triangles=np.ascontiguousarray(np.asarray(mesh.triangles)[:, ::-1]),
        normals=None if mesh.normals is None else -np.asarray(mesh.normals),
        tangents=tangents,
    )


def with_flat_normals(mesh: Mesh) -> Mesh:
    """Give a mesh with flat shading explicit normals. A mesh that has normals is returned unchanged.

    A vertex at which triangles with different normals meet is split into one vertex for each normal.
    """
    if mesh.normals is not None:
        return mesh
    corners = np.asarray(mesh.triangles).ravel()
    normals = np.repeat(face_normals(mesh), 3, axis=0)
    # The normals are rounded, so that coplanar triangles share vertices in spite of rounding errors.
    keys = np.column_stack((corners, np.rint(normals * 1e5).astype(np.int64)))
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    chosen = corners[first]
    split = select_vertices(mesh, chosen, inverse.reshape(-1, 3))
    return replace(split, normals=normals[first].astype(np.float32))


def select_vertices(mesh: Mesh, vertices: np.ndarray, triangles: np.ndarray) -> Mesh:
    """Return a mesh whose vertices are copies of the vertices of `mesh` with the indices `vertices` (N,).

    `triangles` (T, 3) are indices of the copies.
    """

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
    """Return the unit normals (T, 3) of the triangles. A triangle without area gets +z."""
    a, b, c = (np.asarray(mesh.positions, np.float64)[np.asarray(mesh.triangles)[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    with np.errstate(all="ignore"):
        unit: FloatArray = normals / lengths[:, None]
    unit[~(lengths > 0) | ~np.isfinite(unit).all(axis=1)] = (0, 0, 1)
    return unit


def bounding_box(parts: Sequence[Part]) -> FloatArray:
    """Return the lowest and the highest corner (2, 3) of all meshes. They are infinite if there are no vertices."""
    found = [np.asarray(part.mesh.positions, np.float64) for part in parts if len(part.mesh.positions)]
    if not found:
        return np.array([[np.inf] * 3, [-np.inf] * 3])
    return np.array([np.min([p.min(axis=0) for p in found], axis=0), np.max([p.max(axis=0) for p in found], axis=0)])


def primitive(document: Document, part: Part, material: int) -> Json:
    """Write the arrays of a part into the document, and return its primitive. `material` is the index of its material."""
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
    """Return the sets of texture coordinates TEXCOORD_0, TEXCOORD_1 and so on.

    The specification requires consecutive numbers. If the mesh does not have the first set but a later one, a later
    set is also written as the first.
    """
    if lightmap is None:
        if mesh.uvs2 is None:
            return [] if mesh.uvs is None else [mesh.uvs]
        return [mesh.uvs2 if mesh.uvs is None else mesh.uvs, mesh.uvs2]
    first = lightmap if mesh.uvs is None else mesh.uvs
    return [first, lightmap] + ([] if mesh.uvs2 is None else [mesh.uvs2])
