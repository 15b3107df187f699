# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read mesh primitives as triangles, and transform them to world space [glTF 2.0, 3.7.2]."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.budget import check, spend
from eclat.loaders.gltf.accessors import Accessors
from eclat.loaders.gltf.draco import decompressed
from eclat.loaders.gltf.element import Element
from eclat.loaders.gltf.skins import read_skinning
from eclat.loaders.gltf.topology import read_triangles
from eclat.loaders.sheets import bounding_triangles
from eclat.loaders.triangles import any_has_area
from eclat.scene import Material, Mesh

Floats = NDArray[np.float32]
_ROUNDING = 1e-3
"""The amount by which vertex colours may exceed 1 without a warning, since rounding may explain it."""
_VERTEX_SIZE = 36
"""The number of bytes that a position takes while a primitive is read, as float32 and float64."""
_CORNER_SIZE = 24
"""The number of bytes that an index takes while triangles are read, as int32 several times."""


@dataclass(frozen=True)
class Primitive:
    """A triangle mesh in local coordinates. Its arrays have the same shapes as those of `Mesh`.

    `where` is its location in the file, for messages.
    """

    where: str
    positions: NDArray[np.float64]
    triangles: NDArray[np.int32]
    normals: Floats | None
    tangents: Floats | None
    uvs: Floats | None
    uvs2: Floats | None
    colors: Floats | None
    joints: NDArray[np.int64] | None = None
    """(V, N) the joints of a skin that each vertex follows."""
    weights: NDArray[np.float64] | None = None
    """(V, N) how much it follows each of them; the sum is 1."""


def read_primitive(
    element: Element, accessors: Accessors, weights: Sequence[float], second_uv_set: int = 1, skinned: bool = False
) -> Primitive | None:
    """Read the triangles of a primitive, and apply its morph targets.

    Parameters
    ----------
    element : the element of the primitive.
    accessors : the accessors of the file.
    weights : the weights of the morph targets.
    second_uv_set : the number of the attribute TEXCOORD that becomes `uvs2`.
    skinned : whether joints and weights are read.

    Returns
    -------
    The primitive, or None, with a warning, if it has no triangles.

    Raises
    ------
    EclatError : an accessor is invalid, attributes have different counts, an index is out of range, a position is not
        finite, or compressed geometry cannot be decompressed.
    """
    attributes = element.child("attributes")
    if attributes is None or accessors.count(attributes, "POSITION") == 0:
        warn(f"{element.where}: the primitive has no positions and is left out")
        return None
    element, accessors = decompressed(element, attributes, accessors)
    reader = _Attributes(element, attributes, accessors, weights)
    corners = accessors.count(element, "indices") if "indices" in element.data else reader.count
    check(_VERTEX_SIZE * reader.count + _CORNER_SIZE * corners, element.where)
    triangles = read_triangles(element, accessors, reader.count)
    if triangles is None:
        return None
    if not any_has_area(reader.positions, triangles):
        warn(f"{element.where}: no triangle of the primitive has an area, so nothing of it is seen")
    normals = reader.read("NORMAL", ("VEC3",))
    # The specification requires that tangents are ignored if there are no normals.
    tangents = None if normals is None else reader.tangents()
    uvs, uvs2 = (reader.read(f"TEXCOORD_{number}", ("VEC2",)) for number in (0, second_uv_set))
    colors = reader.colors()
    if normals is not None:
        # This is the last step, because it takes long, and an invalid attribute above makes it useless.
        normals = _unit_normals(normals, reader.positions, triangles, element.where)
    skinning = read_skinning(element, accessors, reader.count) if skinned else (None, None)
    primitive = _compact(
        Primitive(element.where, reader.positions, triangles, normals, tangents, uvs, uvs2, colors, *skinning)
    )
    arrays = (primitive.positions, primitive.triangles, primitive.normals, primitive.tangents)
    others = (primitive.uvs, primitive.uvs2, primitive.colors, primitive.joints, primitive.weights)
    spend(sum(array.nbytes for array in (*arrays, *others) if array is not None), element.where)
    return primitive


Pieces = NDArray[np.bool_]


def solid_triangles(primitive: Primitive, material: Material) -> Pieces | None:
    """Return which triangles of a refractive primitive bound solids, or None if its material does not refract."""
    if material.thin_walled or "transmission" not in material.parameters:
        return None
    return bounding_triangles(Mesh(primitive.positions, primitive.triangles, material))


def split_solids_and_sheets(
    primitive: Primitive, material: Material, bodies: Pieces | None
) -> list[tuple[Primitive, Material]]:
    """Split a refractive primitive into the solids, which `bodies` marks, and the thin sheets among its pieces.

    KHR_materials_volume requires a closed mesh. Pieces that enclose no volume get a thin-walled material instead, with a
    warning. A primitive whose material does not refract is not split.
    """
    if bodies is None or bodies.all():
        return [(primitive, material)]
    warn(
        f"{primitive.where}: KHR_materials_volume requires a closed mesh, but parts of this one enclose no volume; they "
        "become thin panes"
    )
    choices = ((bodies, material), (~bodies, replace(material, thin_walled=True)))
    return [
        (_compact(replace(primitive, triangles=primitive.triangles[which])), surface)
        for which, surface in choices
        if which.any()
    ]


def transform_primitive(primitive: Primitive, to_world: NDArray[np.float64], material: Material, name: str) -> Mesh:
    """Transform a primitive to world space and make a mesh of it.

    `to_world` is a 4×4 affine matrix, which may contain a reflection. Raises EclatError if positions overflow float32.
    """
    linear = to_world[:3, :3]
    with np.errstate(all="ignore"):
        positions = primitive.positions @ linear.T + to_world[:3, 3]
        if not np.isfinite(positions.astype(np.float32)).all():
            raise EclatError(
                f"{primitive.where}: expected finite positions in world space, but the transform of a node makes them "
                "overflow float32"
            )
    shape = linear / np.abs(linear).max()
    mirrored = bool(np.linalg.det(shape) < 0)
    normals, tangents = primitive.normals, primitive.tangents
    if normals is not None:
        # The cofactor matrix is the inverse transpose times the determinant. It exists for singular matrices too.
        cofactors = np.column_stack([np.cross(shape[:, (i + 1) % 3], shape[:, (i + 2) % 3]) for i in range(3)])
        normals = unit_vectors(normals @ cofactors.T * (-1 if mirrored else 1))
    if tangents is not None:
        # The sign w orients the bitangent w · normal × tangent. A reflection reverses it.
        turned = unit_vectors(tangents[:, :3] @ shape.T)
        tangents = np.column_stack((turned, tangents[:, 3] * (-1 if mirrored else 1))).astype(np.float32)
    return Mesh(
        positions=positions,
        triangles=primitive.triangles[:, [0, 2, 1]] if mirrored else primitive.triangles,
        material=material,
        normals=normals,
        uvs=primitive.uvs,
        uvs2=primitive.uvs2,
        colors=primitive.colors,
        tangents=tangents,
        name=name,
    )


class _Attributes:
    """The validated vertex attributes of one primitive, with morph targets applied."""

    def __init__(self, element: Element, attributes: Element, accessors: Accessors, weights: Sequence[float]) -> None:
        self._element, self._attributes, self._accessors = element, attributes, accessors
        targets = element.children("targets")
        if len(weights) > len(targets):
            warn(
                f"{element.where}: expected at most {len(targets)} weights, one for each morph target, "
                f"got {len(weights)}; the rest are ignored"
            )
        self._targets = [(t, w) for t, w in zip(targets, weights, strict=False) if w != 0]
        positions = accessors.floats(attributes, "POSITION", ("VEC3",))
        assert positions is not None, "the caller has checked that there are positions"
        self.count = len(positions)
        with np.errstate(invalid="ignore"):  # NaN, which is refused below
            self.positions = self._morphed(positions, "POSITION").astype(np.float64)
        _check_finite(self.positions, element.where)

    def read(self, name: str, types: tuple[str, ...]) -> Floats | None:
        """Return the attribute `name` as finite numbers, shape (V, width), or None if it is absent.

        Values that are not finite become 0, with a warning.
        """
        values = self._accessors.floats(self._attributes, name, types)
        if values is None:
            return None
        if len(values) != self.count:
            raise EclatError(
                f"{self._element.where}: expected {self.count} elements of {name}, as many as of POSITION, "
                f"got {len(values)}"
            )
        values = self._morphed(values, name)
        bad = ~np.isfinite(values)
        if bad.any():
            warn(
                f"{self._element.where}: {int(bad.any(axis=1).sum())} elements of {name} are not finite; 0 is used instead"
            )
            values = np.where(bad, np.float32(0), values)
        return values

    def tangents(self) -> Floats | None:
        """Return the tangents (V, 4), with unit vectors xyz and w = ±1, or None if they are absent or one has length 0."""
        values = self.read("TANGENT", ("VEC4",))
        if values is None:
            return None
        if not (_lengths(values[:, :3]) > 0).all():
            warn(
                f"{self._element.where}: some tangents have length 0; all tangents are computed from texture coordinates "
                "instead"
            )
            return None
        return np.column_stack((unit_vectors(values[:, :3]), np.where(values[:, 3] < 0, -1, 1))).astype(np.float32)

    def colors(self) -> Floats | None:
        """Return the linear RGBA vertex colours (V, 4), or None if they are absent [glTF 2.0, 3.7.2.1].

        They are clamped to 0..1, as the specification requires. Without alpha in the file, alpha is 1.
        """
        values = self.read("COLOR_0", ("VEC3", "VEC4"))
        if values is None:
            return None
        if values.shape[1] == 3:
            values = np.column_stack((values, np.ones(len(values), np.float32)))
        if values.max(initial=0) > 1 + _ROUNDING:
            warn(f"{self._element.where}: expected COLOR_0 in 0..1, got up to {values.max():g}; it is clamped to 1")
        return np.clip(values, np.float32(0), np.float32(1))

    def _morphed(self, values: Floats, name: str) -> Floats:
        for target, weight in self._targets:
            delta = self._accessors.floats(target, name, ("VEC2", "VEC3", "VEC4"))
            if delta is None:
                continue
            if len(delta) != len(values) or delta.shape[1] > values.shape[1]:
                raise EclatError(
                    f"{target.where}: expected {name} of the shape {values.shape}, as in the primitive, got {delta.shape}"
                )
            values = values.copy()
            with np.errstate(all="ignore"):
                values[:, : delta.shape[1]] += np.float32(weight) * delta
        return values


def _check_finite(positions: NDArray[np.float64], where: str) -> None:
    bad = ~np.isfinite(positions).all(axis=1)
    if bad.any():
        first = int(np.argmax(bad))
        raise EclatError(
            f"{where}: expected finite positions, got {positions[first].tolist()} for vertex {first} "
            f"({int(bad.sum())} of {len(positions)} positions are not finite)"
        )


def _compact(primitive: Primitive) -> Primitive:
    """Remove the unused vertices of a primitive if at least half of its vertices are unused.

    Many primitives may share one set of vertices.
    """
    used = np.zeros(len(primitive.positions), bool)
    used[primitive.triangles] = True
    count = int(used.sum())
    if 2 * count > len(used):
        return primitive
    renumbered = np.cumsum(used, dtype=np.int32) - 1

    def kept(values: NDArray[Any] | None) -> Any:
        return None if values is None else values[used]

    return replace(
        primitive,
        positions=primitive.positions[used],
        triangles=renumbered[primitive.triangles],
        normals=kept(primitive.normals),
        tangents=kept(primitive.tangents),
        uvs=kept(primitive.uvs),
        uvs2=kept(primitive.uvs2),
        colors=kept(primitive.colors),
        joints=kept(primitive.joints),
        weights=kept(primitive.weights),
    )


def _unit_normals(normals: Floats, positions: NDArray[np.float64], triangles: NDArray[np.int32], where: str) -> Floats:
    """Normalise the normals. Those of length 0 become the mean of the triangles' normals, weighted by area.

    A warning counts the normals of length 0.
    """
    bad = ~(_lengths(normals) > 1e-12)
    if not bad.any():
        return unit_vectors(normals)
    warn(f"{where}: {int(bad.sum())} normals have length 0; they are computed from the adjacent triangles instead")
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    with np.errstate(all="ignore"):
        faces = np.nan_to_num(np.cross(b - a, c - a))
    sums = np.zeros_like(positions)
    for corner in range(3):
        np.add.at(sums, triangles[:, corner], faces)
    sums[~(_lengths(sums) > 0)] = (0, 0, 1)
    return unit_vectors(np.where(bad[:, None], sums, normals))


def _lengths(vectors: NDArray[np.floating]) -> NDArray[np.float64]:
    with np.errstate(all="ignore"):
        lengths: NDArray[np.float64] = np.linalg.norm(vectors.astype(np.float64), axis=1)
    return lengths


def unit_vectors(vectors: NDArray[np.floating]) -> Floats:
    """Normalise vectors (N, 3), as float32. Those of length 0 become +z."""
    lengths = _lengths(vectors)
    with np.errstate(all="ignore"):
        result = vectors / lengths[:, None]
    result[~(lengths > 0) | ~np.isfinite(result).all(axis=1)] = (0, 0, 1)
    return result.astype(np.float32)
