# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The coordinate frame of the core: the choice of its origin, so that float32 suffices, and a check for triangles that
float32 deforms."""

from __future__ import annotations

import numpy as np

from eclat.errors import warn
from eclat.scene import FloatArray, Mesh, Scene

_SHIFT_DISTANCE = 4.0
"""Least distance of the middle of the bounds from the origin, in diagonals of the bounds, for which the origin is
moved; for nearer scenes the coordinates are kept exactly as they are."""
_MEDIAN_SHIFT_DISTANCE = 64.0
"""Least distance of the median of all corners from the origin, in median distances of corners from it, for which the
origin is moved to the median. It applies to scenes whose stray parts make the bounds huge. At this distance six of the
24 bits of float32 are lost."""
_ROUNDING_DISTANCE = 1e3
"""Distance from the median, in median distances, beyond which rounding is checked. For nearer corners a step of float32
is below 1e-4 of the median distance."""
_MEDIAN_TRIANGLES = 200_000
"""Largest number of triangles, evenly chosen among all, from which the median is computed; this takes about 50 ms."""
_COARSE_STEP = 0.1
"""Step of float32, relative to the longest edge of a triangle, above which rounding deforms the triangle visibly."""


def center_of(scene: Scene) -> FloatArray:
    """Choose the origin of the core's coordinates: a world position (3,) in double precision.

    If the scene lies far from the origin of the world, the middle of the scene's bounds is chosen. If parts of the
    scene lie far from each other, such as a room in the coordinates of a national grid and one stray triangle at the
    origin, the median of the corners of all triangles is chosen, since most of them belong to the part of interest.
    Otherwise the origin of the world is kept.
    """
    used = [np.asarray(m.positions, np.float64) for m in scene.meshes if len(m.positions)]
    if not used:
        return np.zeros(3)
    low = np.min([p.min(axis=0) for p in used], axis=0)
    high = np.max([p.max(axis=0) for p in used], axis=0)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return np.zeros(3)  # The core reports the mesh and the vertex.
    middle: FloatArray = (low + high) / 2
    diagonal = float(np.linalg.norm(high - low))
    if np.abs(middle).max() > _SHIFT_DISTANCE * diagonal:
        return middle
    median, spread = _median(scene)
    return median if np.abs(median).max() > _MEDIAN_SHIFT_DISTANCE * spread else np.zeros(3)


def warn_of_rounding(scene: Scene, center: FloatArray) -> None:
    """Warn about the first mesh with triangles that float32 deforms because they lie too far from the rest of the
    scene."""
    _, spread = _median(scene)
    for number, mesh in enumerate(scene.meshes):
        local = np.asarray(mesh.positions, np.float64) - center
        if not np.isfinite(local).all():
            return  # The core reports the vertex.
        far = np.abs(local).max(axis=1, initial=0.0) > _ROUNDING_DISTANCE * spread
        if not far.any() or not _has_valid_indices(mesh):
            continue
        triangles = np.asarray(mesh.triangles)[far[np.asarray(mesh.triangles)].any(axis=1)]
        corners = local[triangles]
        steps = np.spacing(np.abs(corners).max(axis=(1, 2), initial=0.0).astype(np.float32))
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1, initial=0.0)
        coarse = steps > _COARSE_STEP * edges
        if coarse.any():
            row = int(np.argmax(coarse))
            place = ", ".join(f"{x:g}" for x in (corners[row].mean(axis=0) + center))
            what = f"mesh {number}" + (f" {mesh.name!r}" if mesh.name else "")
            warn(
                f"{what}: {int(coarse.sum())} of {len(mesh.triangles)} triangles lie so far from most of the scene that "
                f"their corners are rounded to multiples of {float(steps[row]):g} m; the first is at ({place})"
            )
            return


def _median(scene: Scene) -> tuple[FloatArray, float]:
    """Compute the median (3,) of the corners of all triangles along each axis, and their median distance from it."""
    meshes = [m for m in scene.meshes if _has_valid_indices(m)]
    if not meshes:
        return np.zeros(3), 0.0
    every = -(-sum(len(m.triangles) for m in meshes) // _MEDIAN_TRIANGLES)
    corners = [np.asarray(m.positions, np.float64)[np.asarray(m.triangles)[::every].ravel()] for m in meshes]
    table = np.concatenate(corners)
    median = np.median(table, axis=0)
    return median, float(np.median(np.linalg.norm(table - median, axis=1)))


def _has_valid_indices(mesh: Mesh) -> bool:
    index = np.asarray(mesh.triangles)
    return len(index) > 0 and index.min() >= 0 and index.max() < len(mesh.positions)
