# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Which triangles bound solids, so that nobody sees their backs from within.

A connected piece of a mesh is a solid if it is closed and its normals point outwards. It is closed if each edge joins
two triangles that run along it in opposite directions; its signed volume is then above 0. A two-sided piece might be a
room that people walk in, so it counts only if no camera, no light and no other vertex lies in its bounds. A one-sided
piece may have flat holes, like a box without its bottom, because its inside is black in any picture.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eclat.loaders.components import connected, edges_of
from eclat.scene import DirectionalLight, FloatArray, Mesh, Scene

Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

FLAT = 1e-4
"""Share of a piece's diameter: how far a hole's border may leave its plane, and the thickness below which a piece is no solid."""


def solid_triangles(scene: Scene, meshes: Sequence[Mesh]) -> list[Mask]:
    """For each mesh (T,): whether a triangle is part of the hull of a solid."""
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
    """The numbers of the triangles of each connected piece."""
    if not len(mesh.triangles):
        return []
    _, corners = np.unique(np.asarray(mesh.positions), axis=0, return_inverse=True)
    triangles = corners.reshape(-1)[np.asarray(mesh.triangles)]
    edges, owners = edges_of(triangles)
    same = (edges[1:] == edges[:-1]).all(axis=1)
    labels = connected(len(triangles), owners[:-1][same], owners[1:][same])
    order = np.argsort(labels, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(labels[order])) + 1)


def _is_hull(points: FloatArray, holes: bool) -> bool:
    """Whether triangles (T, 3, 3) enclose a volume, seen from outside; with `holes` up to one plane."""
    low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    diameter = float(np.linalg.norm(high - low))
    _, corners = np.unique(points.reshape(-1, 3), axis=0, return_inverse=True)
    triangles = corners.reshape(-1, 3)
    ends = np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2)
    # Each edge must be run along once in each direction. Otherwise the surface ends or branches there.
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
    # Seen from a point of the hole's plane, the missing lid adds nothing.
    a, b, c = (points[:, i] - origin for i in range(3))
    volume = float((np.cross(a, b) * c).sum()) / 6
    return volume > FLAT * diameter**3 * 1e-2


def _inside(points: FloatArray, low: FloatArray, high: FloatArray) -> bool:
    """Whether a point lies inside the box, away from its sides. Objects that stand on a floor only touch it."""
    margin = 1e-3 * (high - low)
    return bool(((points > low + margin) & (points < high - margin)).all(axis=1).any())


def _places_of(scene: Scene) -> FloatArray:
    """The positions of cameras and lights."""
    places = [np.asarray(camera.to_world, np.float64)[:3, 3] for camera in scene.cameras]
    places += [np.asarray(light.position) for light in scene.lights if not isinstance(light, DirectionalLight)]
    return np.array(places, np.float64).reshape(-1, 3)
