# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Apply the textures of PLY files.

The format itself has no textures. MeshLab, Metashape, COLMAP and other programs name the image files in comments
(`comment TextureFile skin.png`). They write texture coordinates for each vertex (s, t) or for each corner of a face
(`texcoord`). If there are several textures, the face property `texnumber` selects one for each face.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.files import read_texture, resolve, stand_in
from eclat.loaders.ply_data import Columns, Lists
from eclat.loaders.triangles import finite_rows
from eclat.scene import Material, Mesh, Texture, Value


@dataclass(frozen=True, eq=False)
class FaceCorners:
    """The origin of the triangles of a mesh. The first F triangles were cut from faces, the others from strips."""

    places: NDArray[np.int64]
    """(F, 3) for each corner of a triangle, its index in the list of the corners of all faces."""
    faces: NDArray[np.int64]
    """(F,) the face that each triangle was cut from."""
    counts: NDArray[np.int64]
    """The number of corners of each face of the file."""


def textured(mesh: Mesh, names: tuple[str, ...], corners: FaceCorners, face: Columns, path: Path) -> list[Mesh]:
    """Split `mesh` into one textured mesh for each texture that it uses. Without textures, return it unchanged.

    Parameters
    ----------
    mesh : the mesh. Its texture coordinates have v downwards.
    names : the names of the image files, in the order of their texture numbers, relative to the folder of `path`.
    corners : the faces that the triangles of `mesh` were cut from.
    face : the properties of the faces. `texcoord` and `texnumber` are used.
    path : the PLY file.
    """
    where = path.name
    if not names:
        return [mesh]
    uvs = _corner_uvs(corners, face, where)
    if uvs is not None:
        mesh = _split(mesh, corners, uvs)
    if mesh.uvs is None:
        warn(
            f"{where}: the texture {names[0][:100]!r} is ignored, because the file has no texture coordinates "
            "(s, t or texcoord)"
        )
        return [mesh]
    if mesh.colors is not None:
        warn(
            f"{where}: the vertex colours are ignored, because the file also has a texture, and both describe the same "
            "colours"
        )
        mesh = replace(mesh, colors=None)
    numbers = _texture_numbers(len(mesh.triangles), len(names), corners, face, where)
    parts = []
    for number in np.unique(numbers).tolist():
        texture = _texture(path, names[number])
        part = mesh if len(names) == 1 else _compact(mesh, numbers == number)
        reflectance = Value((1.0, 1.0, 1.0), texture, 0 if texture.image.shape[2] == 1 else None)
        parts.append(replace(part, material=Material(parameters={"reflectance": reflectance}, name=texture.name)))
    return parts


def _texture(path: Path, name: str) -> Texture:
    try:
        found = resolve(path.parent, name, where=path.name, allow_parent=True)
    except EclatError as error:
        return stand_in(str(error), srgb=True, where=path.name, name=name)
    return read_texture(found, srgb=True, where=path.name)


def _corner_uvs(corners: FaceCorners, face: Columns, where: str) -> NDArray[np.float32] | None:
    """Return the texture coordinates (C, 2) of the corners of all faces, with v downwards, or None if faces have none."""
    found = face.get("texcoord")
    if not isinstance(found, Lists) or not found.counts.any():
        return None
    if len(found.counts) != len(corners.counts) or (found.counts != 2 * corners.counts).any():
        wrong = int(np.argmax(found.counts != 2 * corners.counts))
        warn(
            f"{where}, face {wrong}: expected {2 * int(corners.counts[wrong])} numbers in texcoord, "
            f"got {int(found.counts[wrong])}; texcoord is ignored in all faces"
        )
        return None
    uvs = finite_rows(found.items.astype(np.float64).reshape(-1, 2), "texture coordinates", where)
    uvs[:, 1] = 1 - uvs[:, 1]
    return uvs


def _split(mesh: Mesh, corners: FaceCorners, uvs: NDArray[np.float32]) -> Mesh:
    """Split the vertices of `mesh` so that each has one pair of texture coordinates.

    `uvs` (C, 2) belong to the corners of faces. Triangles of strips get the texture coordinates (0, 0).
    """
    triangles = np.asarray(mesh.triangles, dtype=np.int64)
    own = np.zeros((triangles.size, 2), np.float32)
    own[: 3 * len(corners.places)] = uvs[corners.places.ravel()]
    keys = np.column_stack([triangles.ravel().astype(np.float64), own])
    first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)[1:]
    used = triangles.ravel()[first]
    return replace(
        mesh,
        positions=mesh.positions[used],
        triangles=inverse.reshape(-1, 3).astype(np.int32),
        normals=None if mesh.normals is None else mesh.normals[used],
        colors=None if mesh.colors is None else mesh.colors[used],
        uvs=own[first],
    )


def _texture_numbers(
    triangles: int, textures: int, corners: FaceCorners, face: Columns, where: str
) -> NDArray[np.int64]:
    """Return the texture number (T,) of each triangle, which is 0 if the file does not give one."""
    numbers = np.zeros(triangles, np.int64)
    found = face.get("texnumber")
    if found is None or isinstance(found, Lists):
        if textures > 1:
            warn(
                f"{where}: the file names {textures} textures, but its faces have no texnumber that selects one; the "
                "first texture is used for all faces"
            )
        return numbers
    own = found.astype(np.int64)[corners.faces]
    bad = (own < 0) | (own >= textures)
    if bad.any():
        warn(
            f"{where}: {int(bad.sum())} triangles have a texnumber outside 0..{textures - 1}; the first texture is "
            "used for them"
        )
    numbers[: len(own)] = np.where(bad, 0, own)
    return numbers


def _compact(mesh: Mesh, which: NDArray[np.bool_]) -> Mesh:
    """Return the mesh of the triangles that the mask `which` selects, without the vertices that they do not use."""
    used, inverse = np.unique(mesh.triangles[which], return_inverse=True)
    return replace(
        mesh,
        positions=mesh.positions[used],
        triangles=inverse.reshape(-1, 3).astype(np.int32),
        normals=None if mesh.normals is None else mesh.normals[used],
        uvs=None if mesh.uvs is None else mesh.uvs[used],
    )
