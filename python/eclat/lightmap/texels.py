# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The surface point that each texel represents, found by conservative rasterisation of the triangles into the atlas.

Bilinear filtering at a point reads up to four texels, whose centres are less than one texel away in u and in v. All
texels that are read anywhere on a triangle are drawn. A texel whose centre lies outside its triangle represents the
nearest point of the triangle.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from eclat.gltf_export.geometry import face_normals
from eclat.lightmap.atlas import Atlas
from eclat.scene import FloatArray, Mesh

Ints = NDArray[np.int64]

REACH = 1 - 1e-3
"""Largest distance, in texels along u and v, at which a bilinear lookup reads a texel; texels with a weight below 0.001
are neglected."""

INWARD = 0.02
"""Least distance, in texels, of sample points from the edges of their triangle; at the edge itself, in the corner of a
room, a ray would start inside the next wall."""

PAIRS_AT_ONCE = 1 << 20
"""Number of pairs of a triangle and a texel that are tested at a time, which bounds the memory."""


@dataclass(frozen=True, eq=False)
class Texels:
    """The N texels that surfaces use, row by row.

    `rows` and `columns` (N,) are their positions in the map; `triangles` (N,) are the indices of their triangles,
    counted over all meshes; `weights` (N, 3) are the barycentric coordinates of the sample points; `positions` (N, 3)
    are in metres; `normals` (N, 3) are unit shading normals and `face_normals` (N, 3) those of the triangles; `uvs` (N,
    2) are the positions of the sample points in the map, in texels. `shared` is the number of texels that two charts
    need; each such texel belongs to only one of them.
    """

    rows: Ints
    columns: Ints
    triangles: Ints
    weights: FloatArray
    positions: FloatArray
    normals: FloatArray
    face_normals: FloatArray
    uvs: FloatArray
    shared: int

    def chosen(self, which: Ints) -> Texels:
        """Return the texels with the indices `which`."""
        arrays = (field.name for field in fields(self) if field.name != "shared")
        return Texels(**{name: getattr(self, name)[which] for name in arrays}, shared=self.shared)

    def __len__(self) -> int:
        return len(self.rows)


@dataclass(frozen=True, eq=False)
class Corners:
    """The corners of the T triangles of an atlas.

    `uvs` (T, 3, 2) are in texels of the stack of pages, world `positions` (T, 3, 3) in metres; `normals` (T, 3, 3) are unit
    shading normals and `face_normals` (T, 3) unit normals of the triangles. `charts` (T,) are the indices of their charts,
    −1 for none.
    """

    uvs: FloatArray
    positions: FloatArray
    normals: FloatArray
    face_normals: FloatArray
    charts: Ints


def corners_of(meshes: Sequence[Mesh], atlas: Atlas) -> Corners:
    """Collect the corners of all triangles, mesh by mesh."""
    charts, before = [np.zeros(0, np.int64)], 0
    for unwrapped in atlas.meshes:
        own = unwrapped.charts[unwrapped.triangles]
        charts.append(np.where((own < 0).any(axis=1), -1, own[:, 0] + before))
        before += int(unwrapped.charts.max(initial=-1)) + 1

    def at_corners(name: str) -> FloatArray:
        found = [np.asarray(getattr(mesh, name), np.float64)[np.asarray(mesh.triangles)] for mesh in meshes]
        return np.concatenate([np.zeros((0, 3, 3)), *found])

    return Corners(
        uvs=np.concatenate([np.zeros((0, 3, 2)), *(atlas.stacked(u)[u.triangles] for u in atlas.meshes)]),
        positions=at_corners("positions"),
        normals=at_corners("normals"),
        face_normals=np.concatenate([np.zeros((0, 3)), *(face_normals(mesh) for mesh in meshes)]),
        charts=np.concatenate(charts),
    )


def rasterize(corners: Corners, width: int, height: int) -> Texels:
    """Find the texels that bilinear filtering reads anywhere on the triangles; each represents the nearest point of its
    nearest triangle."""
    best = np.full(width * height, np.inf)
    owner = np.full(width * height, -1, np.int64)
    weights = np.zeros((width * height, 3))
    contested = np.zeros(width * height, bool)
    drawn = np.flatnonzero((corners.charts >= 0) & _has_area(corners))
    for triangle, column, row in _candidates(corners.uvs, drawn, width, height):
        centers = np.column_stack((column, row)) + 0.5
        uvs = corners.uvs[triangle]
        reached = _reaches(uvs, centers)
        triangle, centers, uvs = triangle[reached], centers[reached], uvs[reached]
        texel = row[reached] * width + column[reached]
        found, distance = nearest_in_triangle(uvs, centers)
        # The nearest triangle comes first; of equally near triangles, the one with the smaller index.
        order = np.lexsort((triangle, distance, texel))
        _, start, group = np.unique(texel[order], return_index=True, return_inverse=True)
        first = order[start]
        holder = np.where(owner[texel[order]] >= 0, owner[texel[order]], triangle[first][group])
        contested[texel[order][corners.charts[holder] != corners.charts[triangle[order]]]] = True
        better = first[distance[first] < best[texel[first]]]
        best[texel[better]], owner[texel[better]] = distance[better], triangle[better]
        weights[texel[better]] = found[better]
    used = np.flatnonzero(owner >= 0)
    return _sampled(corners, used // width, used % width, owner[used], weights[used], int(contested.sum()))


def at_texel_points(corners: Corners, texels: Texels, uvs: FloatArray) -> Texels:
    """Move the sample points of the texels to the points of their triangles that are nearest to `uvs` (N, 2), in
    texels."""
    weights, _ = nearest_in_triangle(corners.uvs[texels.triangles], uvs)
    return _sampled(corners, texels.rows, texels.columns, texels.triangles, weights, texels.shared)


def nearest_in_triangle(uvs: FloatArray, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Find the nearest point of each triangle (N, 3, 2): its barycentric coordinates (N, 3) and squared distance
    (N,)."""
    a, b, c = uvs[:, 0], uvs[:, 1], uvs[:, 2]
    area = _cross(b - a, c - a)
    with np.errstate(all="ignore"):
        inner = np.column_stack((_cross(b - points, c - points), _cross(c - points, a - points))) / area[:, None]
    weights = np.column_stack((inner, 1 - inner.sum(axis=1)))
    inside = np.isfinite(weights).all(axis=1) & (weights >= 0).all(axis=1)
    squared = np.where(inside, 0.0, np.inf)
    for i in range(3):
        start, edge = uvs[:, i], uvs[:, (i + 1) % 3] - uvs[:, i]
        length = np.maximum((edge**2).sum(axis=1), 1e-300)
        t = np.clip(((points - start) * edge).sum(axis=1) / length, 0, 1)
        distance = ((start + edge * t[:, None] - points) ** 2).sum(axis=1)
        nearer = ~inside & (distance < squared)
        on_edge = np.zeros((len(uvs), 3))
        on_edge[:, i], on_edge[:, (i + 1) % 3] = 1 - t, t
        weights = np.where(nearer[:, None], on_edge, weights)
        squared = np.where(nearer, distance, squared)
    return weights, squared


def _sampled(corners: Corners, rows: Ints, columns: Ints, triangles: Ints, weights: FloatArray, shared: int) -> Texels:
    """Make the sample points at the given barycentric coordinates, moved inward a little from the edges of the
    triangle."""
    uvs = corners.uvs[triangles]
    weights = _moved_inward(uvs, weights)

    def blend(values: FloatArray) -> FloatArray:
        blended: FloatArray = np.einsum("ni,nij->nj", weights, values[triangles])
        return blended

    faces = corners.face_normals[triangles]
    normals = blend(corners.normals)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(lengths > 1e-6, normals / np.where(lengths > 0, lengths, 1), faces)
    return Texels(
        rows=rows,
        columns=columns,
        triangles=triangles,
        weights=weights,
        positions=blend(corners.positions),
        normals=normals,
        face_normals=faces,
        uvs=blend(corners.uvs),
        shared=shared,
    )


def _moved_inward(uvs: FloatArray, weights: FloatArray) -> FloatArray:
    """Move points at least `INWARD` texels away from each edge, if the triangle is large enough; weights are
    barycentric."""
    area = np.abs(_cross(uvs[:, 1] - uvs[:, 0], uvs[:, 2] - uvs[:, 0]))
    opposite = np.linalg.norm(uvs[:, [2, 0, 1]] - uvs[:, [1, 2, 0]], axis=2)
    with np.errstate(all="ignore"):
        # A barycentric coordinate is the distance from the opposite edge divided by the height of the triangle over it.
        least = INWARD * opposite / area[:, None]
    least = np.minimum(np.nan_to_num(least, nan=0.1, posinf=0.1), 0.1)
    raised: FloatArray = np.maximum(weights, least)
    return np.asarray(raised / raised.sum(axis=1, keepdims=True))


def _candidates(uvs: FloatArray, drawn: Ints, width: int, height: int) -> Iterator[tuple[Ints, Ints, Ints]]:
    """Yield triangles with the texels of their bounding boxes, which are enlarged by `REACH`: indices, columns and
    rows."""
    low = np.ceil(uvs[drawn].min(axis=1) - REACH - 0.5).astype(np.int64)
    high = np.floor(uvs[drawn].max(axis=1) + REACH - 0.5).astype(np.int64)
    low, high = np.maximum(low, 0), np.minimum(high, (width - 1, height - 1))
    size = np.maximum(high - low + 1, 0)
    counts = size[:, 0] * size[:, 1]
    ends = np.cumsum(counts)
    first = 0
    while first < len(drawn):
        done = int(ends[first - 1]) if first else 0
        last = max(first + 1, int(np.searchsorted(ends, done + PAIRS_AT_ONCE, side="right")))
        which = np.repeat(np.arange(first, last), counts[first:last])
        within = np.arange(len(which)) - np.repeat(ends[first:last] - counts[first:last] - done, counts[first:last])
        wide = np.maximum(size[which, 0], 1)
        yield drawn[which], low[which, 0] + within % wide, low[which, 1] + within // wide
        first = last


def _reaches(uvs: FloatArray, centers: FloatArray) -> NDArray[np.bool_]:
    """Test whether the square of half width `REACH` about each centre overlaps its triangle, by separating axes.

    The bounding boxes overlap already, so only the normals of the triangle's edges are tested.
    """
    turn = np.sign(_cross(uvs[:, 1] - uvs[:, 0], uvs[:, 2] - uvs[:, 0]))
    meets = np.ones(len(uvs), bool)
    for i in range(3):
        edge = uvs[:, (i + 1) % 3] - uvs[:, i]
        outward = np.column_stack((edge[:, 1], -edge[:, 0])) * turn[:, None]
        distance = (outward * (centers - uvs[:, i])).sum(axis=1)
        meets &= distance <= REACH * np.abs(outward).sum(axis=1)
    return meets


def _has_area(corners: Corners) -> NDArray[np.bool_]:
    a, b, c = (corners.uvs[:, i] for i in range(3))
    found: NDArray[np.bool_] = np.abs(_cross(b - a, c - a)) > 1e-12
    return found


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    product: FloatArray = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return product
