# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read polygon meshes and their primvars as triangles [UsdGeomMesh; UsdGeomPrimvar]."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.budget import check
from eclat.loaders.gltf.primitives import Primitive, unit_vectors
from eclat.loaders.triangles import check_positions, smooth_normals, triangles_with_area, triangulate
from eclat.loaders.usd import gprims
from eclat.loaders.usd.materials import UNPAINTED
from eclat.loaders.usd.stages import Stage, pxr

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

_CORNER_SIZE = 100
"""The number of bytes that a corner takes while a mesh is read."""


@dataclass(frozen=True)
class Attribute:
    """Values (N, width) at the corners of polygons: each corner has the row `rows` (C,)."""

    values: Floats
    rows: Ints


@dataclass(frozen=True, eq=False)
class Polygons:
    """The triangles of a prim before they are given materials.

    `corners` (T, 3) are numbers of corners, `polygons` (T,) the polygon that each triangle was cut from, `vertices` (C,) the
    vertex of each corner, and `counts` (P,) the number of corners of each polygon.
    """

    prim: Any
    where: str
    positions: Floats
    corners: Ints
    polygons: Ints
    vertices: Ints
    counts: Ints
    normals: Attribute | None


def read_polygons(stage: Stage, prim: Any) -> Polygons:
    """Read a mesh or another geometric primitive.

    Raises
    ------
    EclatError : the polygons are invalid, a position is not finite, or no triangle has an area.
    """
    if prim.GetTypeName() in gprims.TYPES:
        shape = gprims.read_gprim(stage, prim)
        corners, where = shape.triangles.ravel(), stage.where(prim)
        check_positions(shape.positions, where)
        triangles = np.arange(len(corners)).reshape(-1, 3)
        keep = triangles_with_area(shape.positions, shape.triangles, where)
        return Polygons(
            prim,
            where,
            shape.positions,
            triangles[keep],
            np.zeros(int(keep.sum()), np.int64),
            corners,
            np.full(len(triangles), 3),
            Attribute(shape.normals, corners),
        )
    return _read_mesh(stage, prim)


def _read_mesh(stage: Stage, prim: Any) -> Polygons:
    mesh, where = pxr("UsdGeom").Mesh(prim), stage.where(prim)
    positions = _array(stage, mesh.GetPointsAttr(), 3, where)
    counts = _array(stage, mesh.GetFaceVertexCountsAttr(), 1, where).ravel().astype(np.int64)
    vertices = _array(stage, mesh.GetFaceVertexIndicesAttr(), 1, where).ravel().astype(np.int64)
    check(_CORNER_SIZE * len(vertices), where)
    if not len(positions) or not len(vertices):
        raise EclatError(f"{where}: expected points and faces, got {len(positions)} points and {len(vertices)} corners")
    if counts.min(initial=0) < 0 or counts.sum() != len(vertices):
        raise EclatError(
            f"{where}: expected {len(vertices)} corners of faces, as faceVertexIndices has, got {counts.sum()} "
            "(faceVertexCounts)"
        )
    if vertices.min() < 0 or vertices.max() >= len(positions):
        wrong = vertices[(vertices < 0) | (vertices >= len(positions))][0]
        raise EclatError(f"{where}: expected indices below {len(positions)}, the number of points, got {wrong}")
    check_positions(positions, where)
    corners, polygons = triangulate(positions, vertices, counts, where)
    if not len(corners):
        raise EclatError(f"{where}: expected faces of at least three corners, got none")
    holes = _array(stage, mesh.GetHoleIndicesAttr(), 1, where).ravel()
    solid = ~np.isin(polygons, holes)
    corners, polygons = corners[solid], polygons[solid]
    keep = triangles_with_area(positions, vertices[corners], where, short_polygons=int((counts < 3).sum()))
    corners = corners[keep]
    if str(stage.value(mesh.GetOrientationAttr(), "rightHanded")) == "leftHanded":
        corners = corners[:, [0, 2, 1]]
    bare = Polygons(prim, where, positions, corners, polygons[keep], vertices, counts, None)
    return replace(bare, normals=_normals(stage, mesh, bare))


def _is_subdivided(stage: Stage, mesh: Any) -> bool:
    return str(stage.value(mesh.GetSubdivisionSchemeAttr(), "catmullClark")) != "none"


def _normals(stage: Stage, mesh: Any, polygons: Polygons) -> Attribute | None:
    """Return the normals of the file; without them, smooth ones of a subdivision surface, and none of other meshes."""
    subdivided = _is_subdivided(stage, mesh)
    if subdivided:
        stage.once(
            "subdivision",
            "subdivision surfaces are not refined: their control meshes are shown, with smooth normals (scheme "
            f"{stage.value(mesh.GetSubdivisionSchemeAttr(), 'catmullClark')} of {mesh.GetPath()}, for example)",
        )
    primvar = pxr("UsdGeom").PrimvarsAPI(mesh.GetPrim()).GetPrimvar("normals")
    if primvar and primvar.HasAuthoredValue():
        found = attribute_of(stage, primvar, 3, polygons)
    else:
        values = _array(stage, mesh.GetNormalsAttr(), 3, polygons.where)
        found = _spread(values, None, str(mesh.GetNormalsInterpolation()), polygons, "normals") if len(values) else None
    if found is not None:
        return Attribute(unit_vectors(found.values).astype(np.float64), found.rows)
    if not subdivided:
        return None
    return Attribute(
        smooth_normals(polygons.positions, polygons.vertices[polygons.corners]).astype(np.float64), polygons.vertices
    )


def primvar_of(stage: Stage, polygons: Polygons, name: str, width: int) -> Attribute | None:
    """Return the primvar `name`, which may be inherited; None if the prim has none or it is invalid, with a warning."""
    primvar = pxr("UsdGeom").PrimvarsAPI(polygons.prim).FindPrimvarWithInheritance(name)
    return attribute_of(stage, primvar, width, polygons) if primvar and primvar.HasAuthoredValue() else None


def attribute_of(stage: Stage, primvar: Any, width: int, polygons: Polygons) -> Attribute | None:
    """Return the values of a primvar at the corners; None, with a warning, if they are not as expected."""
    name = str(primvar.GetPrimvarName())
    try:
        values = _array(stage, primvar, width, polygons.where, name)
    except EclatError as error:
        warn(f"{error}; it is ignored")
        return None
    if not len(values):
        return None
    indices = np.array(primvar.GetIndices(stage.time) or [], dtype=np.int64) if primvar.IsIndexed() else None
    if not np.isfinite(values).all():
        warn(f"{polygons.where}: {name} has values that are not finite; 0 is used instead")
        values = np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
    return _spread(values, indices, str(primvar.GetInterpolation()), polygons, name)


def _spread(
    values: Floats, indices: Ints | None, interpolation: str, polygons: Polygons, name: str
) -> Attribute | None:
    """Give each corner its row of `values`, by way of `indices` if there are any."""
    total = len(polygons.vertices)
    if interpolation == "constant":
        element = np.zeros(total, np.int64)
    elif interpolation == "uniform":
        element = np.repeat(np.arange(len(polygons.counts)), polygons.counts)
    elif interpolation == "faceVarying":
        element = np.arange(total)
    else:  # "vertex" and "varying" are the same for polygons
        element = polygons.vertices
    available = len(values) if indices is None else len(indices)
    needed = int(element.max(initial=0)) + 1
    if needed > available:
        warn(
            f"{polygons.where}: expected at least {needed} {interpolation} values of {name}, got {available}; it is ignored"
        )
        return None
    rows = element if indices is None else indices[element]
    if rows.min(initial=0) < 0 or rows.max(initial=0) >= len(values):
        warn(f"{polygons.where}: expected indices of {name} below {len(values)}, got {rows.max()}; it is ignored")
        return None
    return Attribute(values, rows)


def _array(stage: Stage, attribute: Any, width: int, where: str, name: str = "") -> Floats:
    """Return the values of an attribute, shape (N, width), which are none if it has no value."""
    value = stage.value(attribute)
    values = np.array([] if value is None else value, dtype=np.float64)
    if values.ndim == 0 or values.size == width:
        values = values.reshape(1, -1)
    if not values.size:
        return np.zeros((0, width))
    values = values.reshape(len(values), -1) if values.ndim > 1 else values.reshape(-1, 1)
    if values.shape[1] != width:
        raise EclatError(
            f"{where}: expected {width} numbers for each value of {name or attribute.GetName()}, got {values.shape[1]}"
        )
    return values


def primitive_of(
    stage: Stage, polygons: Polygons, chosen: NDArray[np.bool_], uv_sets: tuple[str, ...], colors: str | None
) -> Primitive:
    """Make a primitive of the triangles that `chosen` (T,) marks.

    Parameters
    ----------
    uv_sets : the primvars that become `uvs` and `uvs2`.
    colors : the primvar that becomes the vertex colours, which have the alpha of displayOpacity; None for no colours.
    """
    attributes: dict[str, Attribute] = {}
    if polygons.normals is not None:
        attributes["normals"] = polygons.normals
    for member, name in zip(("uvs", "uvs2"), uv_sets, strict=False):
        found = primvar_of(stage, polygons, name, 2)
        if found is None:
            warn(
                f"{polygons.where}: the material uses the primvar {name!r}, which the prim does not have; (0, 0) is used"
            )
        else:
            attributes[member] = found
    if colors is not None:
        for member, name, width in (("colors", colors, 3), ("alphas", "displayOpacity", 1)):
            found = primvar_of(stage, polygons, name, width)
            if found is not None:
                attributes[member] = found
    corners = polygons.corners[chosen]
    columns = [polygons.vertices, *(attribute.rows for attribute in attributes.values())]
    keys = np.stack([column[corners.ravel()] for column in columns], axis=1)
    unique, triangles = np.unique(keys, axis=0, return_inverse=True)
    arrays = {
        name: attribute.values[unique[:, number + 1]] for number, (name, attribute) in enumerate(attributes.items())
    }
    return Primitive(
        where=polygons.where,
        positions=polygons.positions[unique[:, 0]],
        triangles=triangles.reshape(-1, 3).astype(np.int32),
        normals=_float32(arrays.get("normals")),
        tangents=None,
        uvs=_turned_over(arrays.get("uvs")),
        uvs2=_turned_over(arrays.get("uvs2")),
        colors=_rgba(arrays, len(unique)) if colors is not None else None,
    )


def _float32(values: Floats | None) -> NDArray[np.float32] | None:
    return None if values is None else values.astype(np.float32)


def _turned_over(values: Floats | None) -> NDArray[np.float32] | None:
    """Return texture coordinates whose (0, 0) is the top left of the image, which USD has at the bottom left."""
    return None if values is None else np.column_stack((values[:, 0], 1 - values[:, 1])).astype(np.float32)


def _rgba(arrays: dict[str, Floats], count: int) -> NDArray[np.float32]:
    """Return vertex colours (V, 4). Without a display colour they are the grey of an unpainted prim."""
    colors = arrays.get("colors", np.full((count, 3), UNPAINTED))
    alphas = arrays.get("alphas", np.ones((count, 1)))
    rgba: NDArray[np.float32] = np.clip(np.column_stack((colors, alphas)), 0, 1).astype(np.float32)
    return rgba
