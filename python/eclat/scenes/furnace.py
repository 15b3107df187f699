# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A closed room whose walls emit and reflect uniformly: the radiance is emission / (1 − rho) everywhere and in all
directions."""

from __future__ import annotations

import math

from eclat.errors import EclatError
from eclat.scene import Camera, Material, Scene, grey, look_at
from eclat.scenes.geometry import box, icosphere, mesh


def build(rho: float = 0.5, emission: float = 1.0, shape: str = "sphere") -> Scene:
    """Build the scene. The camera is inside, away from the centre.

    Parameters
    ----------
    rho
        Diffuse albedo, 0 ≤ rho < 1.
    emission
        Emitted radiance in W·sr⁻¹·m⁻².
    shape
        "sphere", a sphere of 320 flat triangles with a radius of 1 m, or "box", a cube 2 m wide.
    """
    if not 0 <= rho < 1:
        raise EclatError(f"built-in scene furnace: expected rho of at least 0 and below 1, got {rho}")
    if not math.isfinite(emission) or emission < 0:
        raise EclatError(f"built-in scene furnace: expected a finite emission of at least 0, got {emission}")
    if shape not in ("sphere", "box"):
        raise EclatError(f"built-in scene furnace: expected shape 'sphere' or 'box', got {shape!r}")
    solid = icosphere(2) if shape == "sphere" else box((-1, -1, -1), (1, 1, 1))
    wall = Material("diffuse", {"reflectance": grey(rho)}, name="wall", two_sided=False, emission=grey(emission))
    camera = Camera(look_at((0.2, -0.1, 0.5), (-0.1, 0.05, -0.6)), fov=70, size=(256, 256), name="camera")
    return Scene(meshes=(mesh([solid.inside_out()], wall, "wall"),), cameras=(camera,), name="furnace")
