# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Finding the triangles that bound solids, whose backs no viewer sees.

A connected piece of a mesh is a solid if it is closed and its normals point outwards: each edge belongs to two
triangles that traverse it in opposite directions, and the signed volume is positive. A two-sided piece might be a room
with people in it, so it counts as a solid only if no camera, no light and no other vertex lies within its bounds. A
one-sided piece may have flat holes, like a box without its bottom, because its inside is black in any picture.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eclat.loaders.components import connected_components, triangle_edges
from eclat.scene import DirectionalLight, FloatArray, Mesh, Scene

Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

FLAT = 1e-4
"""Length relative to the diameter of a piece: the largest distance of a hole's border from a plane, and the thickness
below which a piece is not a solid."""


def solid_triangles(scene: Scene, meshes: Sequence[Mesh]) -> list[Mask]:
    """Return a mask (T,) for each mesh of the triangles that bound a solid."""
    places = [_places_of(scene), *(np.asarray(mesh.positions, np.float64) for mesh in meshes)]
    owners = np.repeat(np.arange(len(places)) - 1, [len(p) for p in places])
    everything = np.concatenate(places)
    order = np.argsort(everything[:, 0], kind="stable")
    everything, owners = everything[order], owners[order]
    found = []
    for i, mesh in enumerate(meshes):
        solid = np.zeros(len(mesh.triangles), bool)
        for piece in _pieces(mesh):
            points = places[i + 1][np.asarray(mesh.triangles)[piece]]
            if not _is_hull(points, holes=not mesh.material.two_sided):
                continue
            if mesh.material.two_sided:
                low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
                near = slice(*np.searchsorted(everything[:, 0], (low[0], high[0])))
                if _inside(everything[near][owners[near] != i], low, high):
                    continue
            solid[piece] = True
        found.append(solid)
    return found


def _pieces(mesh: Mesh) -> list[Ints]:
    """Return the indices of the triangles of each connected piece."""
    if not len(mesh.triangles):
        return []
    _, corners = np.unique(np.asarray(mesh.positions), axis=0, return_inverse=True)
    triangles = corners.reshape(-1)[np.asarray(mesh.triangles)]
    edges, owners = triangle_edges(triangles)
    same = (edges[1:] == edges[:-1]).all(axis=1)
    labels = connected_components(len(triangles), owners[:-1][same], owners[1:][same])
    order = np.argsort(labels, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(labels[order])) + 1)


def _is_hull(points: FloatArray, holes: bool) -> bool:
    """Return whether triangles (T, 3, 3) enclose a volume and face outwards; with `holes`, one plane may close it."""
    low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    diameter = float(np.linalg.norm(high - low))
    _, corners = np.unique(points.reshape(-1, 3), axis=0, return_inverse=True)
    triangles = corners.reshape(-1, 3)
    ends = np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2)
    # Each edge must be traversed once in each direction. Otherwise the surface ends or branches there.
    ways, counts = np.unique(ends, axis=0, return_counts=True)
    back = {(int(b), int(a)) for a, b in ways}
    open_ends = np.array([(int(a), int(b)) not in back for a, b in ways])
    if (counts > 1).any() or (open_ends.any() and not holes):
        return False
    unique = np.unique(points.reshape(-1, 3), axis=0)
    origin = low
    if open_ends.any():
        border = unique[np.unique(ways[open_ends])]
        origin = border.mean(axis=0)
        normal = np.linalg.svd(border - origin)[2][2]
        if np.abs((border - origin) @ normal).max() > FLAT * diameter:
            return False
    # With the origin in the plane of the hole, the missing lid would add nothing to the volume.
    a, b, c = (points[:, i] - origin for i in range(3))
    volume = float((np.cross(a, b) * c).sum()) / 6
    return volume > FLAT * diameter**3 * 1e-2


def _inside(points: FloatArray, low: FloatArray, high: FloatArray) -> bool:
    """Return whether any point lies well inside the box; objects that merely touch the box, such as a floor, do not
    count."""
    margin = 1e-3 * (high - low)
    return bool(((points > low + margin) & (points < high - margin)).all(axis=1).any())


def _places_of(scene: Scene) -> FloatArray:
    """Return the positions (N, 3) of the cameras and of the lights that have one."""
    places = [np.asarray(camera.to_world, np.float64)[:3, 3] for camera in scene.cameras]
    places += [np.asarray(light.position) for light in scene.lights if not isinstance(light, DirectionalLight)]
    return np.array(places, np.float64).reshape(-1, 3)
