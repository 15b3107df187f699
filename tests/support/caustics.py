# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Rooms in which light is focused."""

from __future__ import annotations

import numpy as np

from eclat.scene import Material, Mesh, Scene, grey
from eclat.scenes import build
from eclat.scenes.geometry import icosphere, mesh

GLASS = Material("dielectric", {"ior": grey(1.5)}, name="glass")


def sphere(center: tuple[float, float, float], radius: float, material: Material, subdivisions: int = 4) -> Mesh:
    """A sphere with smooth normals."""
    solid = icosphere(subdivisions)
    solid = type(solid)(solid.positions, solid.triangles, solid.positions)
    return mesh([solid.scaled(radius, radius, radius).moved(*center)], material, "sphere")


def glass_sphere_box(light_scale: float = 1.0) -> Scene:
    """The Cornell box with a glass sphere instead of the small box; its light is scaled about its centre, of equal flux."""
    box = build("cornell-box")
    meshes = [m for m in box.meshes if m.name not in ("small-box", "light")]
    light = next(m for m in box.meshes if m.name == "light")
    positions = np.asarray(light.positions, np.float64)
    center = positions.mean(axis=0)
    emission = grey(1.0) if light.material.emission is None else light.material.emission
    radiance = tuple(c / light_scale**2 for c in emission.constant)
    material = Material(
        "diffuse", light.material.parameters, name="light", two_sided=False, emission=type(emission)(radiance)
    )
    scaled = Mesh(center + light_scale * (positions - center), light.triangles, material, name="light")
    meshes += [scaled, sphere((0.4, -0.62, 0.35), 0.35, GLASS)]
    return Scene(meshes=tuple(meshes), cameras=box.cameras, name="glass-sphere-box")
