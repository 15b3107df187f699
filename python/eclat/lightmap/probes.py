# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tests by rays of what points see: whether they lie in a solid or behind a wall, or face empty space."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from eclat.bridge.compiled import compiled
from eclat.gltf_export.geometry import face_normals
from eclat.lightmap.solids import Mask
from eclat.scene import DirectionalLight, FloatArray, Scene

RAYS = 32
"""Rays from one point, spread over its hemisphere with the density of the cosine."""

BURIED = 0.5
"""Share of the rays that may meet the insides of solids."""

BEHIND = 0.3
"""Share that may meet the backs of one-sided surfaces: half meet them below a floor that a wall passes through."""

GRAZING = 1e-5
"""Share of the scene's radius: whatever is no higher above a point's plane counts as lying in the plane."""

OFFSET = 2.0**-18
"""Share of the scene's radius: the distance from their surface at which rays start."""

RAYS_AT_ONCE = 1 << 21

GOLDEN = (5**0.5 - 1) / 2


def buried_or_behind(
    scene: Scene, solid: Sequence[Mask], points: FloatArray, normals: FloatArray, threads: int | None = None
) -> tuple[Mask, Mask]:
    """(N,) each: whether points see mostly the insides of solids, of which `solid` marks the triangles in each mesh, and
    whether they see much of the backs of one-sided surfaces. The first lie in a solid; the second may, or behind a wall
    that is none from there. `normals` are unit and geometric."""
    if not len(points):
        return np.zeros(0, bool), np.zeros(0, bool)
    one_sided = [np.full(len(mesh.triangles), not mesh.material.two_sided) for mesh in scene.meshes]
    # The last entry is for rays that meet nothing.
    inside, single = (np.append(np.concatenate(list(masks)), False) for masks in (solid, one_sided))
    faces = np.concatenate([*(face_normals(mesh) for mesh in scene.meshes), np.zeros((1, 3))])

    def shares(met: np.ndarray, directions: FloatArray) -> tuple[FloatArray, FloatArray]:
        from_behind = (faces[met] * directions).sum(axis=2) > 0
        return (from_behind & inside[met]).mean(axis=1), (from_behind & (inside | single)[met]).mean(axis=1)

    found = [shares(*part) for part in _looks(scene, points, normals, RAYS, threads)]
    insides, backs = (np.concatenate(part) for part in zip(*found, strict=True))
    return insides > BURIED, backs > BEHIND


def sees_nothing(scene: Scene, points: FloatArray, normals: FloatArray, threads: int | None = None) -> Mask:
    """(N,) whether no surface, no sky and no light is in front of points, so that they are dark for certain."""
    if scene.environment is not None or not len(points):
        return np.zeros(len(points), bool)
    missed = [(met < 0).all(axis=1) for met, _ in _looks(scene, points, normals, RAYS, threads)]
    dark = np.concatenate(missed)
    # Rays may miss small objects, which matters if these emit light.
    for corners in _bounds_of_emitters(scene):
        above = ((corners - points[:, None]) * normals[:, None]).sum(axis=2).max(axis=1)
        dark &= above <= GRAZING * compiled(scene).core.radius
    for light in scene.lights:
        towards = (
            -np.broadcast_to(np.asarray(light.direction, np.float64), points.shape)
            if isinstance(light, DirectionalLight)
            else np.asarray(light.position, np.float64) - points
        )
        # The disc of a sun may rise above the horizon although its centre does not.
        wide = np.sin(np.radians(light.angular_radius)) if isinstance(light, DirectionalLight) else 0.0
        dark &= (towards * normals).sum(axis=1) <= -wide * np.linalg.norm(towards, axis=1)
    return dark


def _bounds_of_emitters(scene: Scene) -> Iterator[FloatArray]:
    """The (8, 3) corners of the bounds of each mesh that emits light."""
    for mesh in scene.meshes:
        sides = (mesh.material, mesh.material.back)
        if any(side is not None and side.emission is not None for side in sides) and len(mesh.positions):
            positions = np.asarray(mesh.positions, np.float64)
            ends = np.stack((positions.min(axis=0), positions.max(axis=0)))
            yield np.stack(np.meshgrid(*ends.T, indexing="ij"), axis=-1).reshape(-1, 3)


def _looks(
    scene: Scene, points: FloatArray, normals: FloatArray, count: int, threads: int | None
) -> Iterator[tuple[np.ndarray, FloatArray]]:
    """The hits of `count` rays from each point, for some points at a time: triangles (n, count), −1 for none, and
    directions (n, count, 3)."""
    prepared = compiled(scene)
    i = np.arange(count) + 0.5
    radius, turn = np.sqrt(i / count), 2 * np.pi * GOLDEN * i
    at_once = RAYS_AT_ONCE // count
    for first in range(0, len(points), at_once):
        n = np.asarray(normals[first : first + at_once], np.float64)
        u = np.cross(n, np.eye(3)[np.argmin(np.abs(n), axis=1)])
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        # The pattern is turned differently for each point. Otherwise all points would miss the same objects.
        phi = turn + 2 * np.pi * ((np.arange(first, first + len(n)) * GOLDEN) % 1)[:, None]
        x, y, z = radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1 - radius**2)
        directions = x[..., None] * u[:, None] + y[..., None] * np.cross(n, u)[:, None] + z[:, None] * n[:, None]
        starts = prepared.to_core(points[first : first + at_once]) + OFFSET * prepared.core.radius * n
        origins = np.repeat(starts.astype(np.float32), count, axis=0)
        rays = np.ascontiguousarray(directions.reshape(-1, 3), np.float32)
        met = prepared.core.first_hits(origins, rays, 0 if threads is None else threads)
        yield met.reshape(len(n), count), directions
