# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Textures of PLY files. The format has none, so programs name the image files in comments and number them by face.

MeshLab, Metashape, COLMAP and others write `comment TextureFile skin.png`, and texture coordinates of vertices (s, t) or
of each face's corners (`texcoord`), with `texnumber` where there are several textures.
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
    """The origin of a mesh's triangles: the first ones are cut from faces, the others from strips."""

    places: NDArray[np.int64]
    """(F, 3) places among the corners of all faces, one face after the other."""
    faces: NDArray[np.int64]
    """(F,) the face of each."""
    counts: NDArray[np.int64]
    """Corners of each face."""


def textured(mesh: Mesh, names: tuple[str, ...], corners: FaceCorners, face: Columns, path: Path) -> list[Mesh]:
    """Split `mesh` into one mesh for each used texture. Without textures it stays as it is.

    Parameters
    ----------
    mesh : with v downwards in its texture coordinates.
    names : the files, in the order of their numbers.
    face : columns of the faces, of which `texcoord` and `texnumber` are read.
    path : the PLY file, from whose folder names count.
    """
    where = path.name
    if not names:
        return [mesh]
    uvs = _corner_uvs(corners, face, where)
    if uvs is not None:
        mesh = _split(mesh, corners, uvs)
    if mesh.uvs is None:
        warn(f"{where}: its texture {names[0][:100]!r} needs texture coordinates (s, t or texcoord), got none")
        return [mesh]
    if mesh.colors is not None:
        warn(f"{where}: has a texture and vertex colours, which say the same twice; the texture is used")
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
    """(C, 2) texture coordinates of all corners of faces, v downwards; None where faces have none."""
    found = face.get("texcoord")
    if not isinstance(found, Lists) or not found.counts.any():
        return None
    if len(found.counts) != len(corners.counts) or (found.counts != 2 * corners.counts).any():
        wrong = int(np.argmax(found.counts != 2 * corners.counts))
        warn(
            f"{where}, face {wrong}: expected {2 * int(corners.counts[wrong])} numbers in texcoord, "
            f"got {int(found.counts[wrong])}; texcoord is ignored"
        )
        return None
    uvs = finite_rows(found.items.astype(np.float64).reshape(-1, 2), "texture coordinates", where)
    uvs[:, 1] = 1 - uvs[:, 1]
    return uvs


def _split(mesh: Mesh, corners: FaceCorners, uvs: NDArray[np.float32]) -> Mesh:
    """`mesh` with a vertex for each pair of vertex and texture coordinates; triangles of strips get (0, 0)."""
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
    """The number (T,) of each triangle's texture, which is the first one if the file does not say."""
    numbers = np.zeros(triangles, np.int64)
    found = face.get("texnumber")
    if found is None or isinstance(found, Lists):
        if textures > 1:
            warn(f"{where}: names {textures} textures and not which faces have which (texnumber); the first is used")
        return numbers
    own = found.astype(np.int64)[corners.faces]
    bad = (own < 0) | (own >= textures)
    if bad.any():
        warn(
            f"{where}: {int(bad.sum())} triangles have a texnumber outside 0..{textures - 1}; the first texture is used"
        )
    numbers[: len(own)] = np.where(bad, 0, own)
    return numbers


def _compact(mesh: Mesh, which: NDArray[np.bool_]) -> Mesh:
    """A mesh of the triangles `which` and only their vertices."""
    used, inverse = np.unique(mesh.triangles[which], return_inverse=True)
    return replace(
        mesh,
        positions=mesh.positions[used],
        triangles=inverse.reshape(-1, 3).astype(np.int32),
        normals=None if mesh.normals is None else mesh.normals[used],
        uvs=None if mesh.uvs is None else mesh.uvs[used],
    )
