# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Load Wavefront OBJ files: triangles and polygons, with the materials of their MTL files.

The coordinates in the file are world coordinates in metres. A face corner with a normal (`vn`) keeps it, because the
format gives it precedence over smoothing groups. Other corners are shaded smoothly with the faces of their smoothing
group, or flat if they have no group. Curves, surfaces, lines and points are left out with a warning.

The module `obj_text` reads the statements, and `mtl` and `mtl_materials` read the materials. This module builds meshes
from both.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eclat.errors import warn
from eclat.loaders import triangles as geometry
from eclat.loaders.files import read_bytes
from eclat.loaders.mtl import Library, load_library
from eclat.loaders.mtl_materials import MtlMaterial, build_material
from eclat.loaders.obj_text import ObjText, read_obj_text
from eclat.loaders.sheets import bounding_triangles
from eclat.scene import FloatArray, Material, Mesh, Scene, Value, grey, triangle_areas

IntArray = NDArray[np.int64]

_FLAT_UV = 1e-12
"""The smallest ratio of area in texture coordinates to area in m² for which the width of the texture is computed. Below
it, the texture would be wider than a million metres."""


@dataclass(frozen=True, eq=False)
class _Vertices:
    """Vertices, each of which stands for all face corners with the same indices, and the triangles between them."""

    positions: FloatArray
    normals: NDArray[np.float32]
    """(V, 3), zero for vertices without a normal in the file."""
    uvs: NDArray[np.float32]
    has_uv: NDArray[np.bool_]
    """(V,) whether the file gives texture coordinates for the vertex."""
    colors: NDArray[np.float32] | None
    triangles: IntArray
    polygons: IntArray
    """(T,) the face that each triangle was cut from."""


def load_obj_scene(path: Path) -> Scene:
    """Load the scene in an OBJ file: its meshes with the materials of its MTL files.

    The scene has no camera, and no lights other than emissive meshes. Raises EclatError as `load_obj` does.
    """
    return Scene(meshes=tuple(load_obj(path)), name=path.stem)


def load_obj(
    path: Path, *, face_normals: bool = False, materials: bool = True, smooth: bool = False, flip_v: bool = True
) -> list[Mesh]:
    """Load the meshes of an OBJ file, one for each material, in the order of their first use.

    A glass material gives two meshes if some of its triangles form solids and others form thin sheets, because the two
    need different materials.

    Parameters
    ----------
    path : the file.
    face_normals : ignore the file's normals (`vn`) and use flat shading.
    materials : read the MTL files. If False, all triangles form one mesh with a default material.
    smooth : ignore smoothing groups. If the file has no normals, compute smooth normals at all vertices, as Mitsuba
        does. Vertices with different texture coordinates get separate normals.
    flip_v : replace v by 1 − v, because it grows upwards in OBJ files and downwards in Éclat. If False, v is kept.

    Raises
    ------
    EclatError : a file cannot be read, a line is malformed, an index is out of range, a coordinate is not finite, or
        there is no triangle with an area.
    """
    text = read_obj_text(read_bytes(path, where=path.name), path.name)
    if smooth:
        text = replace(text, face_smoothing=np.zeros_like(text.face_smoothing))
    if not materials:
        text = replace(text, face_materials=np.zeros_like(text.face_materials), material_names=[""])
    vertices = _merge_corners(text, path.name, face_normals=face_normals, flip_v=flip_v)
    if smooth and not face_normals and not vertices.normals.any():
        vertices = replace(vertices, normals=geometry.smooth_normals(vertices.positions, vertices.triangles))
    if not materials:
        mesh = _part(vertices, np.arange(len(vertices.triangles)), path.stem)
        return [_with_surface(mesh, _grey(mesh), path.name)]
    library = load_library(path, text.libraries)
    material_of = text.face_materials[vertices.polygons]
    meshes = []
    for which in _grouped(material_of):
        material = text.material_names[material_of[which[0]]]
        groups = np.unique(text.face_groups[vertices.polygons[which]])
        name = text.group_names[groups[0]] if len(groups) == 1 else ""
        name = name or material or path.stem
        mesh = _part(vertices, which, name)
        found = _find_material(library, material, mesh)
        if found.sheet is None:
            meshes.append(_with_surface(mesh, found.material, path.name))
            continue
        bodies = bounding_triangles(mesh)
        for part, surface in ((which[bodies], found.material), (which[~bodies], found.sheet)):
            if len(part):
                meshes.append(_with_surface(_part(vertices, part, name), surface, path.name))
    return meshes


def _merge_corners(text: ObjText, where: str, *, face_normals: bool, flip_v: bool) -> _Vertices:
    cut, polygons = geometry.triangulate(text.positions, text.corners[:, 0], text.counts, where)
    short = int((text.counts < 3).sum())
    keep = geometry.triangles_with_area(text.positions, text.corners[:, 0][cut], where, short_polygons=short)
    cut, polygons = cut[keep], polygons[keep]
    corners = text.corners[cut.ravel()]
    normals: FloatArray = geometry.normalized(text.normals)
    if face_normals:
        corners[:, 2] = -1
    else:
        corners[:, 2], normals = _complete_normals(text, corners, polygons, normals)
    pair = np.unique((corners[:, 1] + 1) * (len(normals) + 1) + corners[:, 2] + 1, return_inverse=True)[1].ravel()
    key = corners[:, 0] * (int(pair.max()) + 1) + pair
    first, inverse = np.unique(key, return_index=True, return_inverse=True)[1:]
    v, t, n = corners[first].T
    uvs = np.vstack([text.uvs, np.zeros((1, 2), np.float32)])[t]
    if flip_v:
        uvs[:, 1] = np.where(t >= 0, 1 - uvs[:, 1], 0)
    return _Vertices(
        positions=text.positions[v],
        normals=np.vstack([normals, np.zeros((1, 3))])[n].astype(np.float32),
        uvs=uvs,
        has_uv=t >= 0,
        colors=None if text.colors is None else _linear_colors(text.colors, where)[v],
        triangles=inverse.reshape(-1, 3),
        polygons=polygons,
    )


def _complete_normals(
    text: ObjText, corners: IntArray, polygons: IntArray, normals: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Find normals for the corners that have none, or one of length zero.

    A corner of a face in a smoothing group gets the smooth normal of that group. Any other corner gets the normal of
    its face if other corners with the same material have normals, since a mesh has normals at all vertices or at none.

    Parameters
    ----------
    corners : (3 T, 3) the corners of the triangles, as in `ObjText.corners`.
    polygons : (T,) the face that each triangle was cut from.
    normals : (N, 3) the unit normals of the file, or zero.

    Returns
    -------
    (3 T,) the index of each corner's normal, and the normals with the new ones appended.
    """
    index = corners[:, 2].copy()
    index[index >= 0] = np.where(normals[index[index >= 0]].any(axis=1), index[index >= 0], -1)
    index, normals = _smooth_groups(text, corners, polygons, index, normals)
    material = np.repeat(text.face_materials[polygons], 3)
    wanted = np.zeros(len(text.material_names), dtype=bool)
    wanted[material[index >= 0]] = True
    missing = wanted[material] & (index < 0)
    if not missing.any():
        return index, normals
    p = text.positions[corners[:, 0].reshape(-1, 3)]
    crosses = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    # The normals of a polygon's triangles are summed, so that they share one normal. If the sum is zero, because the
    # polygon is folded, the normal of one triangle is used.
    areas, fallback = np.zeros((len(text.counts), 3)), np.zeros((len(text.counts), 3))
    np.add.at(areas, polygons, crosses)
    fallback[polygons] = crosses
    areas = np.where(areas.any(axis=1, keepdims=True), areas, fallback)
    index[missing] = len(normals) + np.repeat(polygons, 3)[missing]
    return index, np.vstack([normals, geometry.normalized(areas)])


def _smooth_groups(
    text: ObjText, corners: IntArray, polygons: IntArray, index: IntArray, normals: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Give corners without a normal the mean normal at their vertex over the faces of their smoothing group.

    Faces meet at a vertex if they have the same vertex index, even if their materials or texture coordinates differ.

    Returns
    -------
    (3 T,) the index of each corner's normal, or −1, and the normals with the new ones appended.
    """
    group = np.repeat(text.face_smoothing[polygons], 3)
    if not ((group > 0) & (index < 0)).any():
        return index, normals
    count = int(group.max()) + 1
    smoothed = group > 0
    keys, places = np.unique(corners[smoothed, 0] * count + group[smoothed], return_inverse=True)
    means = geometry.smooth_normals(text.positions[keys // count], places.reshape(-1, 3))
    own = np.full(len(group), -1)
    own[smoothed] = len(normals) + places.ravel()
    return np.where(index < 0, own, index), np.vstack([normals, means])


def _linear_colors(colors: FloatArray, where: str) -> NDArray[np.float32]:
    """Convert the file's sRGB vertex colours (V, 3) to linear RGBA (V, 4). Vertices without a colour become white."""
    known = np.isfinite(colors.sum(axis=1))
    white = geometry.white_level(colors[known], "vertex colours", where)
    return np.column_stack(
        [geometry.linear_from_srgb(np.where(known[:, None], colors / white, 1)), np.ones(len(colors), np.float32)]
    )


def _grouped(values: IntArray) -> list[IntArray]:
    """Return the ascending indices at which each distinct value occurs, in the order of the first appearance."""
    order = np.argsort(values, kind="stable")
    pieces = np.split(order, np.flatnonzero(np.diff(values[order])) + 1)
    return sorted(pieces, key=lambda piece: int(piece[0]))


def _part(vertices: _Vertices, which: IntArray, name: str) -> Mesh:
    """Return a mesh of the triangles with the indices `which`, with Éclat's default material."""
    used, inverse = np.unique(vertices.triangles[which], return_inverse=True)
    normals = vertices.normals[used]
    return Mesh(
        positions=vertices.positions[used],
        triangles=inverse.reshape(-1, 3).astype(np.int32),
        material=Material(),
        normals=normals if normals.any() else None,
        uvs=vertices.uvs[used] if vertices.has_uv[used].any() else None,
        colors=None if vertices.colors is None else vertices.colors[used],
        name=name,
    )


def _grey(mesh: Mesh, name: str = "") -> Material:
    """Return the material of triangles without one: a diffuse reflectance of 0.5, or the vertex colours."""
    return Material(parameters={"reflectance": grey(0.5 if mesh.colors is None else 1.0)}, name=name)


def _find_material(library: Library, name: str, mesh: Mesh) -> MtlMaterial:
    found = build_material(library, name) if name else None
    return found or MtlMaterial(_grey(mesh, name))


def _with_surface(mesh: Mesh, material: Material, where: str) -> Mesh:
    """Assign `material` to `mesh`, and set the properties of the material that depend on the mesh.

    These are the height of a bump map in metres and the use of vertex colours.
    """
    if material.normal_map is not None and material.normal_map.kind == "bump":
        scale = material.normal_map.scale * _texture_width(mesh, material.normal_map.value)
        material = replace(material, normal_map=replace(material.normal_map, scale=scale))
    if mesh.colors is not None:
        material = replace(material, vertex_colors=True)
    if mesh.uvs is None and _is_textured(material):
        warn(
            f"{where}, material {material.name!r}: the material has textures, but its faces have no texture "
            "coordinates (vt)"
        )
    return replace(mesh, material=material, lamp=material.name)


def _is_textured(material: Material) -> bool:
    values = [*material.parameters.values(), material.opacity, material.emission]
    values += [material.normal_map.value] if material.normal_map else []
    return any(value and value.texture for value in values) or any(map(_is_textured, material.children))


def _texture_width(mesh: Mesh, value: Value) -> float:
    """Return the width of the texture on the mesh in metres, on average over the area of the mesh, or 1 if it is
    unknown.
    """
    if mesh.uvs is None:
        return 1.0
    corners = np.asarray(mesh.positions, dtype=np.float64)[mesh.triangles]
    area = 2 * triangle_areas(corners).sum()
    (a, b, _), (c, d, _) = value.uv_transform
    flat = np.asarray(mesh.uvs, dtype=np.float64)[mesh.triangles]
    e, f = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    uv_area = np.abs(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]).sum() * abs(a * d - b * c)
    # If all texture coordinates are nearly equal, the texture has no width on the mesh.
    return float(np.sqrt(area / uv_area)) if uv_area > _FLAT_UV * area else 1.0
