# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The core's frame: the choice of its origin, so that float32 suffices, and a check for triangles that round coarsely."""

from __future__ import annotations

import numpy as np

from eclat.errors import warn
from eclat.scene import FloatArray, Mesh, Scene

_WORTH = 4.0
"""Diagonals of the bounds that their middle must lie from the origin: nearer, positions keep their own digits."""
_WORTH_OF_MOST = 64.0
"""The same for the median of all corners, in median distances from it, where stray parts make the bounds huge: six of the
24 bits of float32 are then lost."""
_FAR = 1e3
"""Median distances from the median beyond which rounding is looked at: nearer, a step of float32 is below 1e-4 of it."""
_ENOUGH = 200_000
"""Triangles, evenly over all, of which a median is as good as that of millions, in 50 ms."""
_COARSE = 0.1
"""Steps of float32, of a triangle's longest edge, that bend it visibly."""


def center_of(scene: Scene) -> FloatArray:
    """(3,) world position, in double precision, of the origin of the core's frame.

    The middle of the bounds where the scene lies far from the origin. Where parts lie far from each other, such as a
    room in coordinates of a country and one triangle left at the origin, the median of the corners of all triangles:
    most of them are where people look. Else zero.
    """
    used = [np.asarray(m.positions, np.float64) for m in scene.meshes if len(m.positions)]
    if not used:
        return np.zeros(3)
    low = np.min([p.min(axis=0) for p in used], axis=0)
    high = np.max([p.max(axis=0) for p in used], axis=0)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return np.zeros(3)  # the core names the mesh and the vertex
    middle: FloatArray = (low + high) / 2
    diagonal = float(np.linalg.norm(high - low))
    if np.abs(middle).max() > _WORTH * diagonal:
        return middle
    most, spread = _median(scene)
    return most if np.abs(most).max() > _WORTH_OF_MOST * spread else np.zeros(3)


def warn_of_rounding(scene: Scene, center: FloatArray) -> None:
    """Warn of the first mesh whose triangles float32 deforms because they lie too far from the rest of the scene."""
    _, spread = _median(scene)
    for number, mesh in enumerate(scene.meshes):
        local = np.asarray(mesh.positions, np.float64) - center
        if not np.isfinite(local).all():
            return  # the core names the vertex
        far = np.abs(local).max(axis=1, initial=0.0) > _FAR * spread
        if not far.any() or not _has_valid_indices(mesh):
            continue
        triangles = np.asarray(mesh.triangles)[far[np.asarray(mesh.triangles)].any(axis=1)]
        corners = local[triangles]
        steps = np.spacing(np.abs(corners).max(axis=(1, 2), initial=0.0).astype(np.float32))
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1, initial=0.0)
        coarse = steps > _COARSE * edges
        if coarse.any():
            row = int(np.argmax(coarse))
            place = ", ".join(f"{x:g}" for x in (corners[row].mean(axis=0) + center))
            what = f"mesh {number}" + (f" {mesh.name!r}" if mesh.name else "")
            warn(
                f"{what}: {int(coarse.sum())} of {len(mesh.triangles)} triangles lie so far from most of the scene that "
                f"their corners round to {float(steps[row]):g} m; the first is at ({place})"
            )
            return


def _median(scene: Scene) -> tuple[FloatArray, float]:
    """The median (3,) of the corners of all triangles, along each axis, and their median distance from it."""
    meshes = [m for m in scene.meshes if _has_valid_indices(m)]
    if not meshes:
        return np.zeros(3), 0.0
    every = -(-sum(len(m.triangles) for m in meshes) // _ENOUGH)
    corners = [np.asarray(m.positions, np.float64)[np.asarray(m.triangles)[::every].ravel()] for m in meshes]
    table = np.concatenate(corners)
    most = np.median(table, axis=0)
    return most, float(np.median(np.linalg.norm(table - most, axis=1)))


def _has_valid_indices(mesh: Mesh) -> bool:
    index = np.asarray(mesh.triangles)
    return len(index) > 0 and index.min() >= 0 and index.max() < len(mesh.positions)
