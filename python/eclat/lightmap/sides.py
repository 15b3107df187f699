# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The choice of the triangles, and of their sides, that get texels in the light map.

The two sides of a thin wall have different light. Where a viewer can see both sides, the back becomes a separate sheet,
and both materials become one-sided. The inside of a solid needs no texels, and neither do surfaces that are certainly
dark, such as the outside of a room in empty space. All of these share one black texel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from eclat.gltf_export import Part, back_side, sides_differ
from eclat.gltf_export.geometry import face_normals, with_flat_normals
from eclat.gltf_export.textures import constant_of
from eclat.lightmap.probes import certainly_dark
from eclat.lightmap.solids import Mask
from eclat.lightmap.stages import Told
from eclat.scene import DEFAULTS, FloatArray, Material, Mesh, Scene

SidesChoice = Literal["auto", "front", "both"]

PROBE_POSITION = 0.9
"""Position of the test points of a triangle, as a share of the way from its centroid to its corners."""


@dataclass(frozen=True, eq=False)
class Side:
    """A part, which has normals at all vertices, with a mask `lit` (T,) of its triangles that get texels."""

    part: Part
    lit: Mask


def lit_sides(
    scene: Scene,
    choice: SidesChoice,
    solid: Sequence[Mask],
    threads: int | None = None,
    told: Told | None = None,
) -> list[Side]:
    """List the sides of all meshes of `scene` that get texels; `solid` marks the triangles of each mesh that bound
    solids.

    With the `choice` "auto", the front and the back of a two-sided sheet get separate texels. With "front", both sides
    show the light of the front. With "both", the two sides of every two-sided triangle get separate texels.
    """
    sides: list[Side] = []
    for mesh, hull in zip(scene.meshes, solid, strict=True):
        if not len(mesh.triangles):
            continue
        material = mesh.material
        behind = np.zeros(len(hull), bool)
        if material.two_sided and (choice != "front" or sides_differ(material)):
            behind = np.ones(len(hull), bool) if choice == "both" else ~hull
        sides.append(_side(Part(mesh, one_of_two=bool(behind.any()))))
        if behind.any():
            back = back_side(replace(mesh, triangles=np.asarray(mesh.triangles)[behind]))
            sides.append(_side(Part(back, one_of_two=True, back=True)))
    return _without_dark(scene, sides, threads, told)


def reflects_diffusely(material: Material) -> bool:
    """Return whether the material reflects light diffusely, so that its brightness depends on irradiance."""

    def largest(name: str) -> float:
        return max(constant_of(material.parameters.get(name, DEFAULTS[name])))

    def full(name: str) -> bool:
        value = material.parameters.get(name, DEFAULTS[name])
        return value.texture is None and value.constant[0] >= 1

    if material.kind == "blend":
        return any(reflects_diffusely(child) for child in material.children)
    if material.kind == "diffuse":
        return largest("reflectance") > 0
    if material.kind in ("phong", "ward", "plastic"):
        return largest("diffuse_reflectance") > 0
    if material.kind == "metallic_roughness":
        return largest("base_color") > 0 and not full("metallic") and not full("transmission")
    return False


def _side(part: Part) -> Side:
    mesh = with_flat_normals(part.mesh)
    return Side(replace(part, mesh=mesh), np.full(len(mesh.triangles), reflects_diffusely(mesh.material)))


def _without_dark(scene: Scene, sides: list[Side], threads: int | None, told: Told | None) -> list[Side]:
    """Remove from the masks the triangles that are certainly dark, both at their centroids and near their corners."""
    points, normals = [], []
    for side in sides:
        places, faces = _probe_points(side.part.mesh)
        points.append(places[side.lit].reshape(-1, 3))
        normals.append(np.repeat(faces[side.lit], places.shape[1], axis=0))
    if not sum(map(len, points)):
        return sides
    dark = certainly_dark(scene, np.concatenate(points), np.concatenate(normals), threads, told)
    dark = np.asarray(dark.reshape(-1, 4).all(axis=1))
    found, first = [], 0
    for side in sides:
        count = int(side.lit.sum())
        lit = side.lit.copy()
        lit[side.lit] = ~dark[first : first + count]
        found.append(replace(side, lit=lit))
        first += count
    return found


def _probe_points(mesh: Mesh) -> tuple[FloatArray, FloatArray]:
    """Return four test points of each triangle, (T, 4, 3), and the triangles' unit normals (T, 3)."""
    corners = np.asarray(mesh.positions, np.float64)[np.asarray(mesh.triangles)]
    middle = corners.mean(axis=1, keepdims=True)
    return np.concatenate((middle, middle + PROBE_POSITION * (corners - middle)), axis=1), face_normals(mesh)
