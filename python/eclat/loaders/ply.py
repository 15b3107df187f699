# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""PLY: one mesh with polygons or triangle strips, vertex normals, colours and texture coordinates.

The file's space is world space, and lengths are in metres. Colours of integer type are sRGB, of floating type linear.
Textures are those that comments name (`comment TextureFile skin.png`). `ply_header` and `ply_data` read the format,
`ply_textures` the textures; this file knows which names mean what.
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
    """The scene in a PLY file: one mesh, grey, vertex-coloured or textured (one for each texture); no camera, no lights."""
    header, elements = _read(path)
    faces, mesh = _mesh(path, elements, face_normals=False, flip_v=True, textured=bool(header.textures))
    return Scene(meshes=tuple(textured(mesh, header.textures, faces, elements.get("face", {}), path)), name=path.stem)


def load_ply(path: Path, *, face_normals: bool = False, flip_v: bool = False) -> Mesh:
    """The mesh of a PLY file, with a diffuse material: grey 0.5, or its vertex colours alone.

    Parameters
    ----------
    face_normals : shade flat. Without it the file's normals are used, or smooth ones weighted by angle if it has none.
    flip_v : convert a v that grows upwards, as most programs write it, to one that grows downwards. Without it the
        numbers are kept, as in Mitsuba.

    Raises
    ------
    EclatError : unreadable or truncated files, indices out of range, coordinates that are not finite, no triangle.
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
        raise EclatError(f"{where}: expected vertices with coordinates x, y, z, got none")
    geometry.check_positions(positions, where)
    triangles, faces = _triangles(elements, positions, where)
    unread = elements.get("face", {}).keys() & (_FACE_ATTRIBUTES - (_TEXTURE_ATTRIBUTES if textured else set()))
    if unread:
        names = ", ".join(sorted(unread))
        warn(f"{where}: attributes of faces are ignored, only those of vertices are read: {names}")
    ignored = sorted(elements.keys() - {"vertex", "face", "tristrips"})
    if ignored:
        warn(f"{where}: elements that are not understood are ignored: {', '.join(map(repr, ignored[:8]))}")
    colors = _colors(vertex, where)
    reflectance = grey(0.5 if colors is None else 1.0)
    return faces, Mesh(
        positions=positions,
        triangles=triangles.astype(np.int32),
        material=Material(parameters={"reflectance": reflectance}, vertex_colors=colors is not None),
        normals=None
        if face_normals
        else geometry.vertex_normals(positions, triangles, _columns(vertex, ("nx", "ny", "nz")), where),
        uvs=_uvs(vertex, where, flip_v=flip_v),
        colors=colors,
        name=path.stem,
    )


def _columns(vertex: Columns, names: tuple[str, ...]) -> FloatArray | None:
    """(V, len(names)) of the properties of these names, None unless all are there; float32 where the file has that."""
    found = [vertex[name] for name in names if name in vertex]
    arrays = [column for column in found if not isinstance(column, Lists)]
    if len(arrays) < len(names):
        return None
    single = all(column.dtype == np.float32 for column in arrays)
    return np.stack(arrays, axis=1).astype(np.float32 if single else np.float64)


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
    """The vertex colours in linear RGBA, shape (V, 4)."""
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
    """The number of white: an integer type's largest, None for floating ones in 0..1; 255 where bytes came as others."""
    columns = [column for column in map(vertex.__getitem__, names) if not isinstance(column, Lists)]
    what = f"vertex colours ({', '.join(names)})"
    if any(column.dtype.kind == "f" for column in columns):
        white = geometry.white_of(values, what, where, linear=True)
        return None if white == 1 else white
    largest = float(max(np.iinfo(column.dtype).max for column in columns))
    if largest > 255 and 1 < values.max(initial=0) <= 255:
        warn(f"{where}: {what} are {columns[0].dtype} and reach {values.max():g}; they are taken for numbers of 0..255")
        return 255.0
    return largest


def _triangles(
    elements: dict[str, Columns], positions: FloatArray, where: str
) -> tuple[NDArray[np.int64], FaceCorners]:
    """(T, 3) from faces and strips, those without area dropped, and where in the faces they come from."""
    parts: list[NDArray[np.int64]] = []
    places, polygons, counts = np.zeros((0, 3), np.int64), np.zeros(0, np.int64), np.zeros(0, np.int64)
    short = 0
    faces = _index_lists(elements.get("face", {}))
    if faces is not None:
        indices = _checked(faces, len(positions), "face", where)
        counts = faces.counts
        short = int((counts < 3).sum())
        places, polygons = geometry.triangulate(positions, indices, counts, where)
        parts.append(indices[places])
    strips = _index_lists(elements.get("tristrips", {}))
    if strips is not None:
        parts.append(_from_strips(_checked(strips, len(positions), "tristrips", where), strips.counts))
    if not sum(map(len, parts)):
        raise EclatError(f"{where}: expected a mesh with faces or triangle strips, got {len(positions)} vertices alone")
    triangles = np.concatenate(parts)
    keep = geometry.drop_slivers(positions, triangles, where, short_polygons=short)
    own = keep[: len(places)]
    return triangles[keep], FaceCorners(places[own], polygons[own], counts)


def _index_lists(columns: Columns) -> Lists | None:
    """The vertex indices of an element, whether it has polygons of any size or (rarely) one column per corner."""
    for name in _INDEX_NAMES:
        found = columns.get(name)
        if isinstance(found, Lists) and found.items.dtype.kind in "iu":
            return found
    return None


def _checked(lists: Lists, vertices: int, element: str, where: str) -> NDArray[np.int64]:
    """The items as int64, which are vertices or, in strips, −1."""
    # Unsigned 64-bit indices beyond int64 would turn negative.
    items = (
        np.minimum(lists.items, np.array(vertices, lists.items.dtype))
        if lists.items.dtype == np.uint64
        else lists.items
    )
    indices = items.astype(np.int64)
    least = -1 if element == "tristrips" else 0
    wrong = (indices < least) | (indices >= vertices)
    if wrong.any():
        place = int(np.argmax(wrong))
        row = int(np.searchsorted(np.cumsum(lists.counts), place, side="right"))
        raise EclatError(
            f"{where}, {element} {row}: expected vertex indices in {least}..{vertices - 1}, got {lists.items[place]}"
        )
    return indices


def _from_strips(indices: NDArray[np.int64], counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """The triangles of strips. A list is one strip, or several separated by −1. Every second triangle is reversed."""
    if len(indices) < 3:
        return np.zeros((0, 3), dtype=np.int64)
    # Each index's number in its strip, counted from the last separator or beginning of a list.
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
