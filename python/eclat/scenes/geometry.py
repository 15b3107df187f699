# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Builders of closed solids: every solid is watertight, and its triangles face outwards.

Scenes join solids by letting them overlap by about a centimetre. Two faces never share a plane, because such faces
would flicker, and edges never merely touch, because light would leak between them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat.scene import FloatArray, Material, Mesh

IntArray = NDArray[np.int64]
Point2 = tuple[float, float]
Point3 = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Solid:
    """Triangles that enclose a volume: positions (V, 3), triangles (T, 3), and normals (V, 3) or None for flat
    faces."""

    positions: FloatArray
    triangles: IntArray
    normals: FloatArray | None = None

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Solid:
        """Move the solid by an offset."""
        return Solid(self.positions + np.array([x, y, z]), self.triangles, self.normals)

    def turned(self, degrees: float, axis: int = 1) -> Solid:
        """Rotate the solid about axis 0, 1 or 2, counter-clockwise as seen when the axis points at the viewer."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        matrix = np.eye(3)
        matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
        normals = None if self.normals is None else self.normals @ matrix.T
        return Solid(self.positions @ matrix.T, self.triangles, normals)

    def scaled(self, x: float, y: float, z: float) -> Solid:
        """Scale the solid along the axes by positive factors."""
        factors = np.array([x, y, z])
        normals = None
        if self.normals is not None:
            normals = self.normals / factors
            normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        return Solid(self.positions * factors, self.triangles, normals)

    def inside_out(self) -> Solid:
        """Flip all faces, which turns a solid into a room."""
        return Solid(self.positions, self.triangles[:, ::-1], None if self.normals is None else -self.normals)

    def smooth(self, crease: float = 35.0) -> Solid:
        """Add vertex normals, averaged over the faces whose angle is less than `crease` degrees; sharper edges stay
        sharp."""
        corners = self.positions[self.triangles]
        faces = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
        # The corners are sorted by vertex, so that the corners of a vertex are consecutive; then all pairs of corners
        # of the same vertex are formed.
        vertices = self.triangles.reshape(-1)
        order = np.argsort(vertices, kind="stable")
        first = np.searchsorted(vertices[order], vertices)
        count = np.bincount(vertices, minlength=len(self.positions))[vertices]
        starts = np.concatenate([[0], np.cumsum(count)[:-1]])
        mine = np.repeat(np.arange(len(vertices)), count)
        other = order[np.repeat(first - starts, count) + np.arange(int(count.sum()))]
        near = np.einsum("ij,ij->i", faces[mine // 3], faces[other // 3]) > math.cos(math.radians(crease))
        weight = np.where(near, _corner_angles(corners).reshape(-1)[other], 0.0)
        normals = _unit(np.add.reduceat(faces[other // 3] * weight[:, None], starts))
        keys = np.column_stack([vertices, np.round(normals * 1e5).astype(np.int64)])
        _, keep, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        return Solid(self.positions[vertices[keep]], inverse.reshape(-1, 3), normals[keep])


def join(solids: Iterable[Solid]) -> Solid:
    """Combine solids into one, with all their faces and normals."""
    parts = list(solids)
    if any(p.normals is not None for p in parts):
        parts = [p if p.normals is not None else p.smooth(1.0) for p in parts]
    offsets = np.cumsum([0] + [len(p.positions) for p in parts[:-1]])
    normals = [p.normals for p in parts if p.normals is not None]
    return Solid(
        np.concatenate([p.positions for p in parts]),
        np.concatenate([p.triangles + offset for p, offset in zip(parts, offsets, strict=True)]),
        np.concatenate(normals) if normals else None,
    )


def mesh(
    solids: Iterable[Solid], material: Material, name: str, uv: Callable[[FloatArray], FloatArray] | None = None
) -> Mesh:
    """Make one mesh of many solids; `uv` maps positions (V, 3) to texture coordinates (V, 2)."""
    solid = join(solids)
    uvs = None if uv is None else uv(solid.positions)
    return Mesh(solid.positions, solid.triangles, material, normals=solid.normals, uvs=uvs, name=name)


def loft(stations: ArrayLike, closed: bool = False) -> Solid:
    """Make a solid by connecting S consecutive loops of P points each, given as (S, P, 3).

    With `closed`, the last loop is connected to the first. Otherwise the first and the last loop, which must be flat
    polygons, are closed with caps.
    """
    loops = np.asarray(stations, dtype=np.float64)
    count, points = loops.shape[:2]
    s = np.arange(count if closed else count - 1)[:, None]
    p = np.arange(points)[None, :]
    t, q = (s + 1) % count, (p + 1) % points
    a, b, c, d = (i * points + j for i, j in ((s, p), (s, q), (t, q), (t, p)))
    quads = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    if not closed:
        cap = _flat_triangles(loops[0])
        quads = np.concatenate([quads, cap[:, ::-1], cap + (count - 1) * points])
    return _outward(Solid(loops.reshape(-1, 3), quads))


def extrude(outline: Sequence[Point2], depth: float) -> Solid:
    """Extrude a simple polygon in x and y from z = −depth/2 to z = +depth/2."""
    points = np.asarray(outline, dtype=np.float64)
    return loft([np.column_stack([points, np.full(len(points), z)]) for z in (-depth / 2, depth / 2)])


def box(low: Point3, high: Point3) -> Solid:
    """Make an axis-aligned box between two corners."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    return extrude([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], z1 - z0).moved(z=(z0 + z1) / 2)


def revolve(profile: Sequence[Point2], segments: int, crease: float = 40.0) -> Solid:
    """Revolve a profile of points (radius, height), from the bottom up, about the y axis. Open ends are closed by
    discs."""
    inner = [(r, y) for r, y in profile if r > 0]
    bottom, top = profile[0][1], profile[-1][1]
    angles = np.arange(segments) * (2 * math.pi / segments)
    rows = [np.column_stack([r * np.sin(angles), np.full(segments, y), r * np.cos(angles)]) for r, y in inner]
    positions = np.concatenate([*rows, [[0.0, bottom, 0.0], [0.0, top, 0.0]]])
    i = np.arange(segments)
    j = (i + 1) % segments
    triangles = []
    for row in range(len(inner) - 1):
        a, b, c, d = row * segments + i, row * segments + j, (row + 1) * segments + j, (row + 1) * segments + i
        triangles += [np.column_stack([a, b, c]), np.column_stack([a, c, d])]
    last = (len(inner) - 1) * segments
    triangles += [
        np.column_stack([j, i, np.full(segments, len(positions) - 2)]),
        np.column_stack([last + i, last + j, np.full(segments, len(positions) - 1)]),
    ]
    return _outward(Solid(positions, np.concatenate(triangles))).smooth(crease)


def ring(profile: Sequence[Point2]) -> Solid:
    """Sweep a profile of points (distance from the centre, height) around a square court, mitred at the four
    corners."""
    d, y = np.asarray(profile, dtype=np.float64).T
    return loft([np.column_stack([d * x, y, d * z]) for x, z in ((1, 1), (1, -1), (-1, -1), (-1, 1))], closed=True)


def arch(profile: Sequence[Point2], foot: float, segments: int) -> Solid:
    """Sweep a profile of points (radius, z) along a half circle in x and y, whose ends continue straight down to y =
    −foot."""
    r, z = np.asarray(profile, dtype=np.float64).T
    loops = [np.column_stack([r, np.full(len(r), -foot), z])]
    for angle in np.linspace(0.0, math.pi, segments + 1):
        loops.append(np.column_stack([r * math.cos(angle), r * max(0.0, math.sin(angle)), z]))
    loops.append(np.column_stack([-r, np.full(len(r), -foot), z]))
    return loft(loops).smooth(20.0)


def half_circle(center: float, radius: float, segments: int) -> list[Point2]:
    """Make the points of a semicircular arch, from left to right, for an outline; the arch begins at height 0."""
    angles = np.linspace(math.pi, 0.0, segments + 1)
    return [(center + radius * math.cos(a), radius * max(0.0, math.sin(a))) for a in angles]


def groin_vault(radius: float, flange: float, top: float, segments: int) -> Solid:
    """Make the intersection of two barrel vaults over a square bay: a block that is vaulted below and flat at height
    `top`.

    The barrels have the given `radius` and begin at height 0. The block extends `flange` beyond them, into the walls.
    Each barrel has `segments` facets, an even number.
    """
    curve = radius * np.cos(np.linspace(math.pi, 0.0, segments + 1))
    nodes = np.concatenate([[-radius - flange], curve, [radius + flange]])
    n = len(nodes)
    rise = np.sqrt(np.maximum(radius**2 - nodes**2, 0.0))
    x, z = np.meshgrid(nodes, nodes, indexing="ij")
    below = np.column_stack([x.ravel(), np.maximum(rise[:, None], rise[None, :]).ravel(), z.ravel()])
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij"))
    a, b, c, d = i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1
    # The groins are the diagonals of the bay; each cell is split along the diagonal that is parallel to its groin.
    falling = ((i < n // 2) != (j < n // 2))[:, None]
    first = np.where(falling, np.column_stack([a, b, d]), np.column_stack([a, b, c]))
    second = np.where(falling, np.column_stack([b, c, d]), np.column_stack([a, c, d]))
    k = np.arange(n)
    rim = np.concatenate([k * n, (n - 1) * n + k[1:], (k[::-1] * n + n - 1)[1:], k[::-1][1:-1]])
    above = below[rim] * (1, 0, 1) + (0, top, 0)
    up, lap = len(below) + np.arange(len(rim)), np.roll(np.arange(len(rim)), -1)
    centre = np.full(len(rim), len(below) + len(rim))
    sides = [np.column_stack([rim, up, up[lap]]), np.column_stack([rim, up[lap], rim[lap]])]
    triangles = np.concatenate([first, second, *sides, np.column_stack([up, centre, up[lap]])])
    return _outward(Solid(np.concatenate([below, above, [[0.0, top, 0.0]]]), triangles)).smooth(30.0)


def icosphere(subdivisions: int) -> Solid:
    """Make the unit sphere with flat faces, as an icosahedron whose triangles are split into four, `subdivisions`
    times."""
    g = (1 + math.sqrt(5)) / 2
    corners = [(s * a, t * b) for s in (-1, 1) for t in (-1, 1) for a, b in ((1, g),)]
    points = [(0, a, b) for a, b in corners] + [(a, b, 0) for a, b in corners] + [(b, 0, a) for a, b in corners]
    positions = _unit(np.array(points, dtype=np.float64))
    near = np.linalg.norm(positions[:, None] - positions[None], axis=2) < 1.1
    triangles = np.array(
        [(i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[i, k]]
    )
    corner = positions[triangles]
    facing = np.einsum("ij,ij->i", np.cross(corner[:, 1], corner[:, 2]), corner[:, 0]) > 0
    triangles = np.where(facing[:, None], triangles, triangles[:, ::-1])
    for _ in range(subdivisions):
        edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        unique, inverse = np.unique(edges, axis=0, return_inverse=True)
        middle = inverse.reshape(-1, 3) + len(positions)
        positions = np.concatenate([positions, _unit(positions[unique].sum(axis=1))])
        (a, b, c), (ab, bc, ca) = triangles.T, middle.T
        triangles = np.concatenate([np.column_stack(t) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return Solid(positions, triangles)


def _outward(solid: Solid) -> Solid:
    a, b, c = (solid.positions[solid.triangles[:, k]] for k in range(3))
    volume = float(np.einsum("ij,ij->", np.cross(a, b), c))
    return solid if volume > 0 else solid.inside_out()


def _unit(vectors: FloatArray) -> FloatArray:
    unit: FloatArray = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return unit


def _corner_angles(corners: FloatArray) -> FloatArray:
    forward = np.roll(corners, -1, axis=1) - corners
    backward = np.roll(corners, 1, axis=1) - corners
    sine = np.linalg.norm(np.cross(forward, backward), axis=2)
    angles: FloatArray = np.arctan2(sine, np.einsum("ijk,ijk->ij", forward, backward))
    return angles


def _flat_triangles(loop: FloatArray) -> IntArray:
    """Triangulate a simple flat polygon by ear clipping, into (P − 2, 3) triangles."""
    normal = np.cross(loop, np.roll(loop, -1, axis=0)).sum(axis=0)
    drop = int(np.argmax(np.abs(normal)))
    points = loop[:, [(drop + 1) % 3, (drop + 2) % 3]] * (1.0, np.sign(normal[drop]))
    left = list(range(len(points)))
    quality = [_ear_quality(points, left, k) for k in range(len(left))]
    ears = []
    while len(left) > 3:
        # The ear of the best shape is cut first; otherwise the outline of an arch would produce needle-shaped
        # triangles.
        at = max(range(len(left)), key=quality.__getitem__)
        ears.append((left[at - 1], left[at], left[(at + 1) % len(left)]))
        del left[at], quality[at]
        for k in (at - 1, at % len(left)):
            quality[k] = _ear_quality(points, left, k)
        if max(quality) < 0:
            quality = [_ear_quality(points, left, k) for k in range(len(left))]
    ears.append((left[0], left[1], left[2]))
    return np.array(ears, dtype=np.int64)


def _ear_quality(points: FloatArray, left: list[int], at: int) -> float:
    """Rate the shape of the ear at the vertex `left[at]`: twice its area divided by its longest side squared, or −1 if
    cutting it off there is not possible."""
    ear = (left[at - 1], left[at], left[(at + 1) % len(left)])
    a, b, c = points[list(ear)]
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    longest = max(float(np.sum((p - q) ** 2)) for p, q in ((a, b), (b, c), (c, a)))
    if area <= 1e-9 * longest:
        return -1.0
    others = points[[k for k in left if k not in ear]]
    inside = np.ones(len(others), dtype=bool)
    for p, q in ((a, b), (b, c), (c, a)):
        side = (q[0] - p[0]) * (others[:, 1] - p[1]) - (q[1] - p[1]) * (others[:, 0] - p[0])
        inside &= side >= -1e-12
    return -1.0 if inside.any() else float(area / longest)
