# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Points that are tied to the surfaces of meshes, so that they are found again when the surfaces have moved.

All scenes of one animation have the same meshes in the same order, with the same triangles unless one has no extent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eclat.bridge.compiled import compiled
from eclat.scene import Scene

Numbers = NDArray[np.float64]
Indices = NDArray[np.int64]

NEARNESS = 1e-3
"""The height above the surface, relative to the given length, from which the surface under a point is searched; the point
must lie on it within that length."""
SAME_SIDE = 0.99
"""The least cosine between the normal of a point and that of its triangle."""


@dataclass(frozen=True, eq=False)
class Anchors:
    """Points on triangles.

    `meshes` (N,) are the numbers of the meshes, or −1 for points that are on no surface; `triangles` (N,) those of the
    triangles in their meshes; `shares` (N, 3) the barycentric coordinates; `sides` (N,) +1 on the side of the triangle's
    normal, −1 on the other. `places` and `normals`, (N, 3) each, are the world positions and normals of points that are on
    no surface; those of the others are not used.
    """

    meshes: Indices
    triangles: Indices
    shares: Numbers
    sides: Numbers
    places: Numbers
    normals: Numbers

    def __len__(self) -> int:
        return len(self.meshes)

    def joined(self, other: Anchors) -> Anchors:
        """Return these points and the others after them."""
        return Anchors(*(np.concatenate([getattr(self, n), getattr(other, n)]) for n in self.__dataclass_fields__))

    def taken(self, which: NDArray[np.generic]) -> Anchors:
        """Return some of the points."""
        return Anchors(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    def posed(self, scene: Scene) -> Posed:
        """Return where the points are in a scene."""
        positions, normals, shading = self.places.copy(), self.normals.copy(), self.normals.copy()
        along = np.zeros_like(positions)
        for number in np.unique(self.meshes[self.meshes >= 0]):
            which = self.meshes == number
            mesh = scene.meshes[number]
            if not len(mesh.triangles):
                positions[which] = np.nan
                continue
            vertices = np.asarray(mesh.triangles)[self.triangles[which]]
            corners = np.asarray(mesh.positions, np.float64)[vertices]
            shares, sides = self.shares[which], self.sides[which, None]
            positions[which] = np.einsum("nc,nci->ni", shares, corners)
            along[which] = corners[:, 1] - corners[:, 0]
            normals[which] = shading[which] = sides * unit(
                np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            )
            if mesh.normals is not None:
                smooth = np.einsum("nc,nci->ni", shares, np.asarray(mesh.normals, np.float64)[vertices])
                smooth *= np.sign(np.einsum("ni,ni->n", smooth, normals[which]))[:, None]
                good = np.linalg.norm(smooth, axis=1) > 0
                shading[which] = np.where(good[:, None], unit(smooth), normals[which])
        return Posed(positions, normals, shading, _frames(normals, along))


@dataclass(frozen=True, eq=False)
class Posed:
    """Where anchored points are in one scene: world positions, normals and shading normals (N, 3), and frames (N, 3, 3)
    whose columns turn with the surface. All are NaN where the surface has no extent."""

    positions: Numbers
    normals: Numbers
    shading_normals: Numbers
    frames: Numbers

    @property
    def valid(self) -> NDArray[np.bool_]:
        return np.asarray(np.isfinite(self.positions).all(axis=1) & np.isfinite(self.normals).all(axis=1))

    def taken(self, which: NDArray[np.generic]) -> Posed:
        """Return some of the points."""
        return Posed(*(getattr(self, name)[which] for name in self.__dataclass_fields__))


def anchors_of(scene: Scene, positions: Numbers, normals: Numbers, lengths: Numbers, threads: int = 0) -> Anchors:
    """Find the surfaces under points.

    Parameters
    ----------
    positions, normals : the world positions of the points, and unit normals on their sides of the surfaces, (N, 3) each.
    lengths : (N,) for each point, the length in metres within which details do not matter.
    """
    height = NEARNESS * lengths[:, None]
    hit = first_triangles(scene, positions + height * normals, -normals, threads)
    meshes, triangles = meshes_of(scene, hit)
    corners = corners_of(scene, scene, meshes, triangles)
    shares = barycentric(corners, positions, normals)
    with np.errstate(all="ignore"):
        across = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
        facing = np.einsum("ni,ni->n", across, normals)
        off = np.linalg.norm(np.einsum("nc,nci->ni", shares, corners) - positions, axis=1)
        found = (np.abs(facing) > SAME_SIDE) & (off < lengths)
    sides = np.where(facing < 0, -1.0, 1.0)
    return Anchors(
        np.where(found, meshes, -1), np.where(found, triangles, -1), np.where(found[:, None], shares, 0.0), sides,
        np.asarray(positions, np.float64), np.asarray(normals, np.float64),
    )  # fmt: skip


def first_triangles(
    scene: Scene, origins: Numbers, directions: Numbers, threads: int, *, from_camera: bool = False
) -> Indices:
    """Return the triangle (N,) that each ray meets first, counted over all meshes, and −1 for none. With `from_camera`,
    surfaces that are hidden from the camera are passed."""
    prepared = compiled(scene)
    local, along = prepared.to_core(origins), np.ascontiguousarray(directions, np.float32)
    return np.asarray(prepared.core.first_hits(local, along, threads, from_camera=from_camera), np.int64)


def meshes_of(scene: Scene, hit: Indices) -> tuple[Indices, Indices]:
    """Return the mesh of each triangle, counted over all meshes, and its number in that mesh; −1 for no triangle."""
    ends = np.cumsum([len(mesh.triangles) for mesh in scene.meshes]) if scene.meshes else np.zeros(1, np.int64)
    starts = np.concatenate([[0], ends[:-1]])
    mesh = np.where(hit >= 0, np.searchsorted(ends, hit, side="right"), -1)
    return mesh, np.where(hit >= 0, hit - starts[np.maximum(mesh, 0)], -1)


def corners_of(now: Scene, other: Scene, meshes: Indices, triangles: Indices) -> Numbers:
    """Return where the corners (N, 3, 3) of triangles of the scene `now` are in `other`; NaN without a triangle."""
    corners = np.full((len(meshes), 3, 3), np.nan)
    for number in np.unique(meshes[meshes >= 0]):
        which = meshes == number
        vertices = np.asarray(now.meshes[number].triangles)[triangles[which]]
        positions = np.asarray(other.meshes[number].positions, np.float64)
        if len(positions) == len(now.meshes[number].positions):
            corners[which] = positions[vertices]
    return corners


def barycentric(corners: Numbers, origins: Numbers, directions: Numbers) -> Numbers:
    """Return the shares (N, 3) of the corners in the point in which a line meets the plane of its triangle."""
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    with np.errstate(all="ignore"):
        normal = np.cross(u, v)
        distance = np.einsum("ni,ni->n", a - origins, normal) / np.einsum("ni,ni->n", directions, normal)
        inside = origins + distance[:, None] * directions - a
        area = np.einsum("ni,ni->n", normal, normal)
        second = np.einsum("ni,ni->n", np.cross(inside, v), normal) / area
        third = np.einsum("ni,ni->n", np.cross(u, inside), normal) / area
    return np.column_stack([1 - second - third, second, third])


def unit(vectors: Numbers) -> Numbers:
    """Return vectors (N, 3) of length 1 in the same directions; NaN for 0."""
    with np.errstate(all="ignore"):
        found: Numbers = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return found


def _frames(normals: Numbers, along: Numbers) -> Numbers:
    """Return frames with the columns: along an edge, across it, normal. Those of points on no surface are the identity."""
    free = ~along.any(axis=1)
    u = unit(along)
    frames = np.stack([u, np.cross(normals, u), normals], axis=-1)
    frames[free] = np.eye(3)
    return frames
