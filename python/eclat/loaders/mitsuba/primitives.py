# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tessellate Mitsuba's primitives to triangles with normals, texture coordinates and tangents, in local coordinates.

The circumference of a round shape is divided into `SEGMENTS` segments, or fewer if a scene has very many round shapes
(see `tessellation`). With `SEGMENTS` segments, the distance of a chord from its arc is at most 1 − cos(π / 128) = 3.0e-4
of the radius. The distance of the centre of a sphere's cell is about twice as large. The vertices are about half this
distance outside the true surface, so that the area is exactly that of the true shape. Therefore, an emitter of a given
radiance also has the exact power.

Texture coordinates are those of Mitsuba. v = 0 is the first row of the image.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from eclat.scene import triangle_areas

SEGMENTS = 128
"""The default number of segments around a round shape (see the module docstring for the error)."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Surface:
    """A tessellated shape: positions, normals and tangents (V, 3), uvs (V, 2), and triangles (T, 3).

    The corners of triangles are counter-clockwise as seen from outside.
    """

    positions: Floats
    normals: Floats
    tangents: Floats
    uvs: Floats
    triangles: NDArray[np.int64]


def rectangle() -> Surface:
    """The square [−1, 1]² at z = 0 with the normal +z."""
    positions = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float64)
    uvs = (positions[:, :2] + 1) / 2
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    return Surface(positions, _all((0, 0, 1), 4), _all((1, 0, 0), 4), uvs, triangles)


def cube() -> Surface:
    """The cube [−1, 1]³. The texture covers each of its faces."""
    corners = np.array([[0, 0], [0, 1], [1, 1], [1, 0]], dtype=np.float64)
    positions, normals, tangents, triangles = [], [], [], []
    for index, (normal, across, down) in enumerate(_CUBE_SIDES):
        n, u, v = (np.array(axis, dtype=np.float64) for axis in (normal, across, down))
        positions.append(n - u - v + 2 * (corners[:, :1] * u + corners[:, 1:] * v))
        normals.append(_all(normal, 4))
        tangents.append(_all(across, 4))
        triangles.append(np.array([[0, 1, 2], [0, 2, 3]]) + 4 * index)
    uvs = np.tile(corners, (6, 1))
    sides = [np.concatenate(part) for part in (positions, normals, tangents)]
    return Surface(sides[0], sides[1], sides[2], uvs, np.concatenate(triangles))


@lru_cache(maxsize=64)
def disk(segments: int = SEGMENTS) -> Surface:
    """The unit disk at z = 0 with the normal +z. u is the radius, and v is the angle as a fraction of a turn."""
    angle = np.arange(segments + 1) * (2 * math.pi / segments)
    # n isosceles triangles with two sides of length R have the area n / 2 · R² sin(2π / n) together.
    radius = math.sqrt(2 * math.pi / segments / math.sin(2 * math.pi / segments))
    middle = angle[:-1] + math.pi / segments
    outward = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    inner = np.stack([np.cos(middle), np.sin(middle), 0 * middle], axis=1)
    positions = np.concatenate([outward * radius, 0 * inner])
    uvs = np.concatenate([_columns(1.0, angle / (2 * math.pi)), _columns(0.0, middle / (2 * math.pi))])
    first = np.arange(segments)
    triangles = np.stack([first, first + 1, first + segments + 1], axis=1)
    return Surface(positions, _all((0, 0, 1), len(positions)), np.concatenate([outward, inner]), uvs, triangles)


@lru_cache(maxsize=64)
def cylinder(segments: int = SEGMENTS) -> Surface:
    """The lateral surface of the unit cylinder from z = 0 to 1, without caps. u runs around the axis, and v along it."""
    angle = np.arange(segments + 1) * (2 * math.pi / segments)
    radius = math.pi / segments / math.sin(math.pi / segments)  # so that the perimeter 2 n R sin(π / n) equals 2π
    normals = np.tile(np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1), (2, 1))
    tangents = np.tile(np.stack([-np.sin(angle), np.cos(angle), 0 * angle], axis=1), (2, 1))
    height = np.repeat([0.0, 1.0], segments + 1)
    positions = normals * radius
    positions[:, 2] = height
    uvs = np.stack([np.tile(angle / (2 * math.pi), 2), height], axis=1)
    return Surface(positions, normals, tangents, uvs, _grid(2, segments + 1)[:, ::-1])


@lru_cache(maxsize=64)
def sphere(segments: int = SEGMENTS) -> Surface:
    """The unit sphere. u runs around the z axis, and v from +z to −z."""
    angle = np.arange(segments + 1) * (2 * math.pi / segments)
    polar = np.arange(segments // 2 + 1) * (2 * math.pi / segments)
    theta, phi = (part.ravel() for part in np.meshgrid(polar, angle, indexing="ij"))
    normals = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1)
    tangents = np.stack([-np.sin(phi), np.cos(phi), 0 * phi], axis=1)
    uvs = np.stack([phi / (2 * math.pi), theta / math.pi], axis=1)
    triangles = _grid(len(polar), len(angle))
    area = triangle_areas(normals[triangles])
    triangles = triangles[area > 1e-9]  # at the poles, one of the two triangles of each cell has no area
    radius = math.sqrt(4 * math.pi / area.sum())
    # At a pole, each triangle has its own vertex. Its u is that of the centre of the cell.
    polar_rows = (theta == polar[0]) | (theta == polar[-1])
    uvs[polar_rows, 0] += np.where(theta[polar_rows] == polar[0], 0.5, -0.5) / segments
    return Surface(normals * radius, normals, tangents, uvs, triangles)


# The normal, the direction of increasing u and the direction of increasing v of each face
_CUBE_SIDES = (
    ((0, -1, 0), (0, 0, 1), (1, 0, 0)),
    ((0, 1, 0), (-1, 0, 0), (0, 0, -1)),
    ((1, 0, 0), (0, 1, 0), (0, 0, -1)),
    ((0, 0, 1), (0, 1, 0), (1, 0, 0)),
    ((-1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((0, 0, -1), (0, -1, 0), (1, 0, 0)),
)


def _all(vector: tuple[float, float, float], count: int) -> Floats:
    return np.tile(np.array(vector, dtype=np.float64), (count, 1))


def _columns(u: float, v: NDArray[np.floating]) -> Floats:
    return np.stack([np.full_like(v, u), v], axis=1)


def _grid(rows: int, columns: int) -> NDArray[np.int64]:
    """Two triangles for each cell of a grid of vertices.

    Seen from outside, rows run downwards and columns to the right, so that the triangles are counter-clockwise.
    """
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    a, b, c, d = first, first + columns, first + columns + 1, first + 1
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
