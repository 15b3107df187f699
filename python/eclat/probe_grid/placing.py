# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Where probes stand: the grid, the probes that lie inside solids, and what takes their place."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from eclat.bridge.compiled import compiled
from eclat.bridge.reach import FARTHEST
from eclat.errors import EclatError
from eclat.gltf_export.geometry import face_normals
from eclat.lightmap.solids import solid_triangles
from eclat.scene import FloatArray, Scene
from eclat.stage.framing import usual_bounds

Mask = NDArray[np.bool_]
Counts = tuple[int, int, int]
Bounds = tuple[float, float, float, float, float, float]

USUAL_PROBES = 512
"""Number of probes of a grid whose size is not given, about."""
MOST_PROBES = 1 << 20
"""Largest number of probes of a grid: 10⁸ bytes of coefficients."""

RAYS = 128
"""Number of rays of a probe that find whether it lies inside a solid."""
MAX_BACK_SHARE = 0.25
"""Share of a probe's rays that may hit the insides of solids, or backs of one-sided surfaces; above it, the probe counts as
inside. It is the share of [Majercik19]. Inside a closed solid it is 1, less where other objects stand inside; in front of a
two-sided wall it is 0."""
RAYS_AT_ONCE = 1 << 21
"""Number of rays that are traced in one call, which bounds the memory."""
GOLDEN_RATIO = (5**0.5 - 1) / 2
"""The inverse of the golden ratio; steps by this part of a turn spread directions evenly."""


def grid_bounds(scene: Scene, bounds: Bounds | None) -> tuple[FloatArray, FloatArray]:
    """Return the corners (3,) of the box that the grid fills: `bounds`, or those of the scene without stray parts.

    Raises EclatError if the box is not finite, has no extent, or the scene has none.
    """
    if bounds is None:
        found = usual_bounds(scene)
        if found is None:
            raise EclatError(
                "bounds: expected a scene with surfaces, or the box of the grid, because this scene has none"
            )
        return found
    low, high = np.asarray(bounds[:3], np.float64), np.asarray(bounds[3:], np.float64)
    shown = ", ".join(f"{value:g}" for value in bounds)
    if not (np.isfinite(bounds).all() and (low <= high).all() and (low < high).any()):
        raise EclatError(f"bounds: expected finite x0, y0, z0, x1, y1, z1 with x0 <= x1 and so on, got {shown}")
    if np.abs(bounds).max() > FARTHEST:
        raise EclatError(f"bounds: expected a box within ±{FARTHEST:g} m along each axis, got {shown}")
    return low, high


def grid_counts(extent: FloatArray, grid: Counts | None) -> Counts:
    """Return the numbers of probes along x, y and z: `grid`, or those of cells that are about cubes, `USUAL_PROBES` in all.

    Raises EclatError if a number is below 1, or there are more than `MOST_PROBES` probes.
    """
    if grid is None:
        side = max(float(extent.max()) / USUAL_PROBES, 1e-300)
        while np.prod(np.maximum(1, np.rint(extent / side))) > USUAL_PROBES:
            side *= 1.02
        x, y, z = (max(1, round(float(length) / side)) for length in extent)
        return x, y, z
    if min(grid) < 1 or np.prod(np.asarray(grid, object)) > MOST_PROBES:
        shown = ", ".join(map(str, grid))
        raise EclatError(
            f"grid: expected 3 numbers of at least 1, with a product of at most {MOST_PROBES}, got {shown}"
        )
    return grid


def in_solids(scene: Scene, positions: FloatArray, threads: int) -> Mask:
    """Return a mask (N,) of the positions (N, 3) inside solids or behind one-sided surfaces.

    More than `MAX_BACK_SHARE` of their rays, which are uniform on the sphere, hit surfaces from behind. `threads` is 0 for
    all processors.
    """
    behind = [
        solid | (not mesh.material.two_sided)
        for solid, mesh in zip(solid_triangles(scene, scene.meshes), scene.meshes, strict=True)
    ]
    # The last entry is for rays that hit nothing, whose triangle is −1.
    hidden = np.append(np.concatenate([np.zeros(0, bool), *behind]), False)
    faces = np.concatenate([*(face_normals(mesh) for mesh in scene.meshes), np.zeros((1, 3))])
    z = 1 - (2 * np.arange(RAYS) + 1) / RAYS
    prepared = compiled(scene)
    found = []
    at_once = RAYS_AT_ONCE // RAYS
    for first in range(0, len(positions), at_once):
        places = prepared.to_core(positions[first : first + at_once]).astype(np.float32)
        # The pattern is turned by a different angle at each probe; otherwise all would miss the same objects.
        turn = GOLDEN_RATIO * (np.arange(RAYS) + np.arange(first, first + len(places))[:, None])
        phi = 2 * np.pi * (turn % 1)
        radius = np.sqrt(1 - z**2)
        directions = np.stack([radius * np.cos(phi), radius * np.sin(phi), np.broadcast_to(z, phi.shape)], axis=-1)
        rays = np.ascontiguousarray(directions.reshape(-1, 3), np.float32)
        met = prepared.core.first_hits(np.repeat(places, RAYS, axis=0), rays, threads).reshape(phi.shape)
        from_behind = (faces[met] * directions).sum(axis=2) > 0
        found.append((from_behind & hidden[met]).mean(axis=1) > MAX_BACK_SHARE)
    return np.concatenate([np.zeros(0, bool), *found])


def filled(coefficients: FloatArray, inside: Mask, spacing: FloatArray) -> FloatArray:
    """Replace the coefficients (X, Y, Z, …) of the probes `inside` (X, Y, Z) by means of their neighbours.

    In each pass, every such probe that touches a probe with a value gets the mean of the values around it (up to 26),
    weighted by their inverse squared distances; `spacing` (3,) is in metres. Raises EclatError if all probes are inside.
    """
    if inside.all():
        raise EclatError(
            "grid: expected probes outside of solids, but all lie inside of solids or behind one-sided surfaces; "
            "give more probes or other bounds"
        )
    values, known = np.array(coefficients, np.float64), ~inside
    steps = [step for step in itertools.product((-1, 0, 1), repeat=3) if any(step)]
    squares = np.where(np.asarray(spacing) > 0, np.asarray(spacing, np.float64), 1.0) ** 2
    squares /= squares.max()
    while not known.all():
        total, weights = np.zeros_like(values), np.zeros(known.shape)
        for step in steps:
            here = tuple(slice(max(0, -s), n - max(0, s)) for s, n in zip(step, known.shape, strict=True))
            there = tuple(slice(max(0, s), n - max(0, -s)) for s, n in zip(step, known.shape, strict=True))
            weight = known[there] / float((np.abs(step) * squares).sum())
            weights[here] += weight
            total[here] += weight.reshape(weight.shape + (1,) * (values.ndim - 3)) * values[there]
        new = ~known & (weights > 0)
        values[new] = total[new] / weights[new].reshape((-1,) + (1,) * (values.ndim - 3))
        known = known | new
    return values
