# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Load PLY files: a mesh of polygons or triangle strips, with vertex normals, colours and texture coordinates.

The coordinates in the file are world coordinates in metres. Colours of an integer type are sRGB, and colours of a
floating-point type are linear. Comments can name textures (`comment TextureFile skin.png`). The modules `ply_header`
and `ply_data` read the format, and `ply_textures` reads the textures. This module interprets the properties by name.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders import triangles as geometry
from eclat.loaders.files import read_bytes
from eclat.loaders.ply_data import Columns, Lists, read_elements
from eclat.loaders.ply_header import Header, read_header
from eclat.loaders.ply_textures import FaceCorners, textured
from eclat.loaders.text_files import utf8
from eclat.scene import FloatArray, Material, Mesh, Scene, grey

_UV_NAMES = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"), ("texture_s", "texture_t"), ("s0", "t0"))
_COLOR_NAMES = (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b"))
_ALPHA_NAMES = ("alpha", "diffuse_alpha", "a")
_FACE_ATTRIBUTES = {"texcoord", "texnumber", "red", "green", "blue", "alpha"}
_TEXTURE_ATTRIBUTES = {"texcoord", "texnumber"}
_INDEX_NAMES = ("vertex_indices", "vertex_index")


def load_ply_scene(path: Path) -> Scene:
    """Load the scene in a PLY file. It has neither a camera nor lights.

    The scene has one mesh, which is grey or has vertex colours. If the file has textures, the scene has one textured
    mesh for each of them. Raises EclatError as `load_ply` does.
    """
    header, elements = _read(path)
    faces, mesh = _mesh(path, elements, face_normals=False, flip_v=True, textured=bool(header.textures))
    return Scene(meshes=tuple(textured(mesh, header.textures, faces, elements.get("face", {}), path)), name=path.stem)


def load_ply(path: Path, *, face_normals: bool = False, flip_v: bool = False) -> Mesh:
    """Load the mesh of a PLY file, with a diffuse material whose reflectance is 0.5 or the vertex colours.

    Parameters
    ----------
    path : the file.
    face_normals : use flat shading. Otherwise the mesh has the file's vertex normals or, if there are none, smooth
        normals weighted by angle.
    flip_v : replace v by 1 − v, because most programs write a v that grows upwards and in Éclat it grows downwards.
        If False, v is kept, as in Mitsuba.

    Raises
    ------
    EclatError : the file cannot be read or is truncated, an index is out of range, a coordinate is not finite, or
        there is no triangle with an area.
    """
    return _mesh(path, _read(path)[1], face_normals=face_normals, flip_v=flip_v)[1]


def _read(path: Path) -> tuple[Header, dict[str, Columns]]:
    where = path.name
    data = utf8(read_bytes(path, where=where), where)
    header = read_header(data, where)
    return header, read_elements(data, header, where)


def _mesh(
    path: Path, elements: dict[str, Columns], *, face_normals: bool, flip_v: bool, textured: bool = False
) -> tuple[FaceCorners, Mesh]:
    where = path.name
    vertex = elements.get("vertex", {})
    positions = _columns(vertex, ("x", "y", "z"))
    if positions is None or not len(positions):
        raise EclatError(f"{where}: expected at least one vertex with the coordinates x, y, z, got none")
    geometry.check_positions(positions, where)
    triangles, faces = _triangles(elements, positions, where)
    unread = elements.get("face", {}).keys() & (_FACE_ATTRIBUTES - (_TEXTURE_ATTRIBUTES if textured else set()))
    if unread:
        names = ", ".join(sorted(unread))
        warn(f"{where}: these properties of faces are ignored, because they are only read from vertices: {names}")
    ignored = sorted(elements.keys() - {"vertex", "face", "tristrips"})
    if ignored:
        warn(f"{where}: these unknown elements are ignored: {', '.join(map(repr, ignored[:8]))}")
    colors = _colors(vertex, where)
    reflectance = grey(0.5 if colors is None else 1.0)
    return faces, Mesh(
        positions=positions,
        triangles=triangles.astype(np.int32, copy=False),
        material=Material(parameters={"reflectance": reflectance}, vertex_colors=colors is not None),
        normals=None
        if face_normals
        else geometry.vertex_normals(positions, triangles, _columns(vertex, ("nx", "ny", "nz")), where),
        uvs=_uvs(vertex, where, flip_v=flip_v),
        colors=colors,
        name=path.stem,
    )


def _columns(vertex: Columns, names: tuple[str, ...]) -> FloatArray | None:
    """Return the columns of the properties `names`, shape (V, len(names)), or None if one of them is missing.

    The type is float32 if all columns have it in the file, otherwise float64.
    """
    found = [vertex[name] for name in names if name in vertex]
    arrays = [column for column in found if not isinstance(column, Lists)]
    if len(arrays) < len(names):
        return None
    single = all(column.dtype == np.float32 for column in arrays)
    with np.errstate(invalid="ignore"):  # NaN, which is the callers' matter
        return np.stack(arrays, axis=1, dtype=np.float32 if single else np.float64)


def _uvs(vertex: Columns, where: str, *, flip_v: bool) -> NDArray[np.float32] | None:
    for names in _UV_NAMES:
        found = _columns(vertex, names)
        if found is not None:
            uvs = geometry.finite_rows(found, "texture coordinates", where)
            if flip_v:
                uvs[:, 1] = 1 - uvs[:, 1]
            return uvs
    return None


def _colors(vertex: Columns, where: str) -> NDArray[np.float32] | None:
    """Return the vertex colours (V, 4) in linear RGBA, or None if the file has none."""
    for names in _COLOR_NAMES:
        rgb = _columns(vertex, names)
        if rgb is None:
            continue
        rgb = geometry.finite_rows(rgb, "vertex colours", where)
        white = _white(vertex, names, rgb, where)
        linear = rgb if white is None else geometry.linear_from_srgb(rgb / white)
        alpha = np.ones(len(rgb), dtype=np.float32)
        for name in _ALPHA_NAMES:
            column = _columns(vertex, (name,))
            if column is not None:
                alpha = geometry.finite_rows(column, "alphas", where)[:, 0]
                alpha = alpha / np.float32(_white(vertex, (name,), alpha, where) or 1)
                break
        colors: NDArray[np.float32] = np.clip(np.column_stack([linear, alpha]), 0, 1).astype(np.float32)
        return colors
    return None


def _white(vertex: Columns, names: tuple[str, ...], values: FloatArray, where: str) -> float | None:
    """Return the number that stands for white in sRGB colours, or None if the colours are linear in 0..1.

    White is the largest number of an integer type. It is 255, with a warning, if the colours have a larger integer type
    or a floating-point type but look like bytes.
    """
    columns = [column for column in map(vertex.__getitem__, names) if not isinstance(column, Lists)]
    what = f"vertex colours ({', '.join(names)})"
    if any(column.dtype.kind == "f" for column in columns):
        white = geometry.white_level(values, what, where, linear=True)
        return None if white == 1 else white
    largest = float(max(np.iinfo(column.dtype).max for column in columns))
    if largest > 255 and 1 < values.max(initial=0) <= 255:
        warn(
            f"{where}: {what} have the type {columns[0].dtype} but only reach {values.max():g}; they are taken for "
            "numbers in 0..255"
        )
        return 255.0
    return largest


def _triangles(
    elements: dict[str, Columns], positions: FloatArray, where: str
) -> tuple[geometry.IntArray, FaceCorners]:
    """Collect the triangles of all faces and strips, except those without area.

    Returns
    -------
    (T, 3) vertex indices, and the face corners that the triangles were cut from.
    """
    parts: list[geometry.IntArray] = []
    places, polygons, counts = np.zeros((0, 3), np.int64), np.zeros(0, np.int64), np.zeros(0, np.int64)
    short = 0
    faces = _index_lists(elements.get("face", {}))
    if faces is not None:
        indices = _checked(faces, len(positions), "face", where)
        counts = faces.counts
        short = int((counts < 3).sum())
        places, polygons = geometry.triangulate(positions, indices, counts, where)
        # Where all are triangles, as in most large files, nothing is cut.
        parts.append(indices.reshape(-1, 3) if (counts == 3).all() else indices[places])
    strips = _index_lists(elements.get("tristrips", {}))
    if strips is not None:
        parts.append(_from_strips(_checked(strips, len(positions), "tristrips", where), strips.counts))
    if not sum(map(len, parts)):
        raise EclatError(
            f"{where}: expected a mesh with faces or triangle strips, got only {len(positions)} vertices; "
            "point clouds are not supported"
        )
    triangles = parts[0] if len(parts) == 1 else np.concatenate(parts)
    keep = geometry.triangles_with_area(positions, triangles, where, short_polygons=short)
    if keep.all():
        return triangles, FaceCorners(places, polygons, counts)
    own = keep[: len(places)]
    return triangles[keep], FaceCorners(places[own], polygons[own], counts)


def _index_lists(columns: Columns) -> Lists | None:
    """Return the lists of vertex indices in an element, or None if it has none."""
    for name in _INDEX_NAMES:
        found = columns.get(name)
        if isinstance(found, Lists) and found.items.dtype.kind in "iu":
            return found
    return None


def _checked(lists: Lists, vertices: int, element: str, where: str) -> geometry.IntArray:
    """Return the items of `lists`. Raises EclatError if one is not a vertex index (or −1 in a strip)."""
    items = lists.items
    least = -1 if element == "tristrips" else 0
    if len(items) and (int(items.min()) < least or int(items.max()) >= vertices):
        place = int(np.argmax((items < least) | (items >= vertices)))
        row = int(np.searchsorted(np.cumsum(lists.counts), place, side="right"))
        raise EclatError(
            f"{where}, {element} {row}: expected vertex indices in {least}..{vertices - 1}, got {items[place]}"
        )
    # Small or unsigned types could not hold −1, or the sum of two.
    return items if items.dtype in (np.int32, np.int64) else items.astype(np.int64)


def _from_strips(indices: geometry.IntArray, counts: NDArray[np.int64]) -> geometry.IntArray:
    """Return the triangles (T, 3) of triangle strips. Every second triangle of a strip is reversed.

    A list of `counts[i]` indices contains one strip, or several strips that are separated by −1.
    """
    if len(indices) < 3:
        return np.zeros((0, 3), dtype=np.int64)
    # `number` is the position of each index in its strip, counted from the last separator or the start of the list.
    begins = np.zeros(len(indices), dtype=bool)
    starts = np.cumsum(counts) - counts
    begins[starts[counts > 0]] = True
    breaks = indices < 0
    begins[1:] |= breaks[:-1]
    begins |= breaks
    place = np.arange(len(indices))
    number = place - np.maximum.accumulate(np.where(begins, place, 0))
    last = np.flatnonzero((number >= 2) & ~breaks)
    a, b, c = indices[last - 2], indices[last - 1], indices[last]
    odd = number[last] % 2 == 1
    return np.stack([np.where(odd, b, a), np.where(odd, a, b), c], axis=1)
