# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Charts that are made without xatlas: flat pieces of surfaces, packed in rows without distortion.

Triangles that share an edge and a plane form one chart, so a chart overlaps itself only if the surface does. Each
triangle of a curved surface becomes a chart, which is correct but makes many seams. `bake` uses these charts if xatlas
fails.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.gltf_export.geometry import face_normals
from eclat.loaders.components import connected_components, triangle_edges
from eclat.scene import FloatArray, Mesh

Ints = NDArray[np.int64]
Arrays = tuple[Ints, Ints, FloatArray, Ints, Ints]

SAME_PLANE = 1e-4
"""Largest distance between the unit normals of two triangles that are treated as lying in one plane."""


@dataclass(frozen=True, eq=False)
class PlanarCharts:
    """Charts on `count` pages of `width` × `height` texels.

    `meshes` holds for each mesh the vertices, triangles, coordinates and charts, as the fields of `atlas.Unwrapped`, and
    the page of each vertex.
    """

    width: int
    height: int
    count: int
    meshes: list[Arrays]


def unwrap_planar(
    meshes: Sequence[Mesh], texel_size: float, apart: int, max_size: int, least_width: int = 0
) -> PlanarCharts:
    """Place all meshes on one page of at least the given width, or on several where `max_size` is too small for one, with at
    least `apart` texels between those that two charts use.

    Raises EclatError if a chart alone is larger than a page.
    """
    flat = [_charts_of(mesh, texel_size) for mesh in meshes]
    sizes: list[FloatArray] = []
    for _, _, uvs, charts in flat:
        sizes += [_extent(uvs, charts)]
    extents = np.concatenate(sizes) if sizes else np.zeros((0, 2))
    # Charts start 1.5 texels from the corner of their box, because bilinear filtering reads one texel around them.
    boxes = np.ceil(extents).astype(np.int64) + 1 + apart
    largest = int(boxes.max(initial=0))
    if largest > max_size:
        fits = texel_size * largest / max_size * 1.05
        raise EclatError(
            f"texel_size: at {texel_size:g} m per texel a chart has {largest} texels along a side, "
            f"more than a page of {max_size} x {max_size}; a texel size of {fits:.2g} m fits"
        )
    places, pages, width, height = _pack(boxes, least_width, max_size)
    first, results = 0, []
    for vertices, triangles, uvs, charts in flat:
        count = int(charts.max(initial=-1)) + 1
        own = slice(first, first + count)
        moved = uvs + (places[own] + 1.5)[charts] if count else uvs
        results.append((vertices, triangles, moved, charts, pages[own][charts] if count else charts))
        first += count
    return PlanarCharts(width, height, int(pages.max(initial=0)) + 1, results)


def _charts_of(mesh: Mesh, texel_size: float) -> tuple[Ints, Ints, FloatArray, Ints]:
    """Cut a mesh into charts, whose coordinates, in texels, start at 0."""
    positions, triangles = np.asarray(mesh.positions, np.float64), np.asarray(mesh.triangles, np.int64)
    if not len(triangles):
        empty = np.zeros(0, np.int64)
        return empty, np.zeros((0, 3), np.int64), np.zeros((0, 2)), empty
    normals = face_normals(mesh)
    labels = _connected(positions, triangles, normals)
    # A vertex is copied for each chart that it belongs to.
    keys = np.column_stack((np.repeat(labels, 3), triangles.ravel()))
    unique, inverse = np.unique(keys, axis=0, return_inverse=True)
    charts, vertices = unique[:, 0], unique[:, 1]
    leaders = np.zeros(int(labels.max()) + 1, np.int64)
    leaders[labels[::-1]] = np.arange(len(labels))[::-1]
    u, v = _axes(positions, triangles, normals, leaders)
    uvs = np.column_stack([(positions[vertices] * axis[charts]).sum(axis=1) for axis in (u, v)]) / texel_size
    low = np.full((len(leaders), 2), np.inf)
    np.minimum.at(low, charts, uvs)
    return vertices, inverse.reshape(-1, 3), uvs - low[charts], charts


def _axes(positions: FloatArray, triangles: Ints, normals: FloatArray, leaders: Ints) -> tuple[FloatArray, FloatArray]:
    """Compute two axes u and v in the plane of each chart: u is along the longest edge of the chart's first triangle,
    and u × v = −n, because v points down in the image."""
    corners = positions[triangles[leaders]]
    edges = np.roll(corners, -1, axis=1) - corners
    longest = np.argmax((edges**2).sum(axis=2), axis=1)
    along = edges[np.arange(len(leaders)), longest]
    n = normals[leaders]
    along = along - n * (along * n).sum(axis=1, keepdims=True)
    lengths = np.linalg.norm(along, axis=1, keepdims=True)
    fallback = np.cross(n, np.eye(3)[np.argmin(np.abs(n), axis=1)])
    u = np.where(lengths > 0, along / np.where(lengths > 0, lengths, 1), fallback)
    return u, -np.cross(n, u)


def _connected(positions: FloatArray, triangles: Ints, normals: FloatArray) -> Ints:
    """Number the charts of the triangles, (T,): two triangles share a chart if they share an edge, by position, and a
    plane."""
    places = np.unique(positions, axis=0, return_inverse=True)[1].reshape(-1)
    edges, owners = triangle_edges(places[triangles])
    shared = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1))
    a, b = owners[shared], owners[shared + 1]
    agree = (np.linalg.norm(normals[a] - normals[b], axis=1) < SAME_PLANE) & (a != b)
    labels = connected_components(len(triangles), a[agree], b[agree])
    return np.unique(labels, return_inverse=True)[1].reshape(-1)


def _extent(uvs: FloatArray, charts: Ints) -> FloatArray:
    high = np.zeros((int(charts.max(initial=-1)) + 1, 2))
    np.maximum.at(high, charts, uvs)
    return high


def _pack(boxes: Ints, least_width: int, max_size: int) -> tuple[Ints, Ints, int, int]:
    """Pack boxes into rows from left to right, the tallest first; return their positions, their pages, and the width and
    height of all pages."""
    places, pages = np.zeros_like(boxes), np.zeros(len(boxes), np.int64)
    if not len(boxes):
        return places, pages, 1, 1
    total = float((boxes[:, 0] * boxes[:, 1]).sum())
    width = min(max_size, max(least_width, int(boxes[:, 0].max()), math.ceil(math.sqrt(total * 1.1))))
    x = y = row = page = height = 0
    for i in np.lexsort((np.arange(len(boxes)), -boxes[:, 0], -boxes[:, 1])):
        w, h = (int(n) for n in boxes[i])
        if x + w > width:
            x, y, row = 0, y + row, 0
        if y + h > max_size:
            x, y, row, page = 0, 0, 0, page + 1
        places[i], pages[i] = (x, y), page
        x, row = x + w, max(row, h)
        height = max(height, y + row)
    return places, pages, width, height
