# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tests, by rays over the hemispheres of points, whether the points lie inside a solid, behind a wall or in
darkness."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from eclat.bridge.compiled import compiled
from eclat.gltf_export.geometry import face_normals
from eclat.lightmap.solids import Mask
from eclat.lightmap.stages import Told
from eclat.scene import DirectionalLight, FloatArray, Scene

PROBE_RAYS = 32
"""Number of rays from one point, cosine-distributed over its hemisphere."""

MAX_INSIDE_SHARE = 0.5
"""Share of a point's rays that hit the insides of solids, above which the point counts as lying inside a solid."""

MAX_BACK_SHARE = 0.3
"""Share of a point's rays that hit insides of solids or backs of one-sided surfaces, above which the point may lie
behind a surface. For a point on a wall below a floor through which the wall passes, the share is one half."""

PLANE_TOLERANCE = 1e-5
"""Height above the plane of a point, relative to the scene's radius, up to which an object counts as lying in the
plane."""

OFFSET = 2.0**-18
"""Distance from its surface at which a ray starts, relative to the scene's radius."""

FIRST_OF = 4
"""A first look takes every fourth of the rays, which are spread over the whole hemisphere. Points that it clears get no more
rays: if 0.3 of the hemisphere is covered by backs, eight stratified rays hardly all miss it."""

RAYS_AT_ONCE = 1 << 21
"""Number of rays that are traced in one call, which bounds the memory."""

GOLDEN_RATIO = (5**0.5 - 1) / 2
"""The inverse of the golden ratio; steps by this part of a turn spread directions evenly."""


def inside_or_behind(
    scene: Scene,
    solid: Sequence[Mask],
    points: FloatArray,
    normals: FloatArray,
    threads: int | None = None,
    told: Told | None = None,
) -> tuple[Mask, Mask]:
    """Find the points that lie inside a solid, and those that may lie behind a surface; return two masks (N,).

    Most rays of a point of the first mask hit the insides of solids. Many rays of a point of the second mask hit
    insides of solids or backs of one-sided surfaces, which are not visible from there. `solid` marks the triangles of
    each mesh that bound solids. `normals` (N, 3) are the unit normals of the triangles.
    """
    if not len(points):
        return np.zeros(0, bool), np.zeros(0, bool)
    one_sided = [np.full(len(mesh.triangles), not mesh.material.two_sided) for mesh in scene.meshes]
    # The last entry is for rays that hit nothing, whose triangle is −1.
    inside, single = (np.append(np.concatenate(list(masks)), False) for masks in (solid, one_sided))
    faces = np.concatenate([*(face_normals(mesh) for mesh in scene.meshes), np.zeros((1, 3))])

    def shares(met: np.ndarray, directions: FloatArray) -> tuple[FloatArray, FloatArray]:
        from_behind = (faces[met] * directions).sum(axis=2) > 0
        return (from_behind & inside[met]).mean(axis=1), (from_behind & (inside | single)[met]).mean(axis=1)

    buried, behind = np.zeros(len(points), bool), np.zeros(len(points), bool)
    if not (inside | single).any():
        return buried, behind
    look = Look(scene, points, normals, threads, told)
    suspects = np.concatenate(
        [
            which[shares(met, directions)[1] > 0]
            for which, met, directions in look.hits(np.arange(len(points)), first=True)
        ]
    )
    for which, met, directions in look.hits(suspects):
        insides, backs = shares(met, directions)
        buried[which], behind[which] = insides > MAX_INSIDE_SHARE, backs > MAX_BACK_SHARE
    return buried, behind


def certainly_dark(
    scene: Scene, points: FloatArray, normals: FloatArray, threads: int | None = None, told: Told | None = None
) -> Mask:
    """Return a mask (N,) of the points that have no surface, no sky and no light in front of them, and so are dark."""
    if scene.environment is not None or not len(points):
        return np.zeros(len(points), bool)
    dark, look = np.zeros(len(points), bool), Look(scene, points, normals, threads, told)
    lonely = [which[(met < 0).all(axis=1)] for which, met, _ in look.hits(np.arange(len(points)), first=True)]
    for which, met, _ in look.hits(np.concatenate(lonely)):
        dark[which] = (met < 0).all(axis=1)
    # Rays may miss small objects. This matters only for objects that emit light.
    for corners in _bounds_of_emitters(scene):
        above = ((corners - points[:, None]) * normals[:, None]).sum(axis=2).max(axis=1)
        dark &= above <= PLANE_TOLERANCE * compiled(scene).core.radius
    for light in scene.lights:
        towards = (
            -np.broadcast_to(np.asarray(light.direction, np.float64), points.shape)
            if isinstance(light, DirectionalLight)
            else np.asarray(light.position, np.float64) - points
        )
        # A part of the disc of a sun may be above the horizon while its centre is below.
        wide = np.sin(np.radians(light.angular_radius)) if isinstance(light, DirectionalLight) else 0.0
        dark &= (towards * normals).sum(axis=1) <= -wide * np.linalg.norm(towards, axis=1)
    return dark


def _bounds_of_emitters(scene: Scene) -> Iterator[FloatArray]:
    """Iterate over the corners (8, 3) of the bounds of each mesh that emits light."""
    for mesh in scene.meshes:
        sides = (mesh.material, mesh.material.back)
        if any(side is not None and side.emission is not None for side in sides) and len(mesh.positions):
            positions = np.asarray(mesh.positions, np.float64)
            ends = np.stack((positions.min(axis=0), positions.max(axis=0)))
            yield np.stack(np.meshgrid(*ends.T, indexing="ij"), axis=-1).reshape(-1, 3)


@dataclass(frozen=True, eq=False)
class Look:
    """Rays over the hemispheres of points, which tell what surrounds them.

    `points` and unit `normals` are (N, 3).
    """

    scene: Scene
    points: FloatArray
    normals: FloatArray
    threads: int | None = None
    told: Told | None = None

    def hits(self, which: np.ndarray, *, first: bool = False) -> Iterator[tuple[np.ndarray, np.ndarray, FloatArray]]:
        """Trace `PROBE_RAYS` rays, or only every `FIRST_OF`th of them, from the points with the indices `which`.

        Yields, for n points at a time, their indices (n,), the triangles that their rays hit, (n, rays), −1 for none, and
        the directions, (n, rays, 3).
        """
        prepared = compiled(self.scene)
        i = np.arange(0, PROBE_RAYS, FIRST_OF if first else 1) + 0.5
        radius, turn = np.sqrt(i / PROBE_RAYS), 2 * np.pi * GOLDEN_RATIO * i
        at_once = RAYS_AT_ONCE // len(i)
        for begin in range(0, len(which), at_once):
            chosen = which[begin : begin + at_once]
            n = np.asarray(self.normals[chosen], np.float64)
            u = np.cross(n, np.eye(3)[np.argmin(np.abs(n), axis=1)])
            u /= np.linalg.norm(u, axis=1, keepdims=True)
            # The pattern of directions is rotated by a different angle at each point; otherwise all points would miss the
            # same objects.
            phi = turn + 2 * np.pi * ((chosen * GOLDEN_RATIO) % 1)[:, None]
            x, y, z = radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1 - radius**2)
            directions = x[..., None] * u[:, None] + y[..., None] * np.cross(n, u)[:, None] + z[:, None] * n[:, None]
            starts = prepared.to_core(self.points[chosen]) + OFFSET * prepared.core.radius * n
            origins = np.repeat(starts.astype(np.float32), len(i), axis=0)
            rays = np.ascontiguousarray(directions.reshape(-1, 3), np.float32)
            met = prepared.core.first_hits(origins, rays, 0 if self.threads is None else self.threads)
            yield chosen, met.reshape(len(n), len(i)), directions
            if self.told is not None:
                self.told(min(1.0, (begin + at_once) / len(which)))
