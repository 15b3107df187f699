# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Two boxes on a plate in the open, under a point, a sun or a sky: what an open scene asks of a method."""

from __future__ import annotations

import numpy as np

from eclat.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Mesh,
    PointLight,
    Scene,
    Texture,
    Value,
    grey,
    look_at,
)
from eclat.scenes.geometry import box, mesh

LIGHTS = ("point", "sun", "sky", "textured")


def court(light: str) -> Scene:
    """The court under one of LIGHTS; "textured" is the sun over a plate with stripes much narrower than patches."""
    white = Material("diffuse", {"reflectance": grey(0.7)}, name="white")
    stripes = np.repeat(np.tile([[230, 30]], (1, 40)), 2, axis=0)[..., None].repeat(3, axis=2).astype(np.uint8)
    painted = Material("diffuse", {"reflectance": Value((1.0, 1.0, 1.0), Texture(stripes, filter="nearest"))})
    corners = np.array([(-2, 0, -2), (-2, 0, 2), (2, 0, 2), (2, 0, -2)], dtype=np.float64)
    uvs = np.array([(0, 0), (0, 1), (1, 1), (1, 0)], dtype=np.float64)
    triangles = np.array([(0, 1, 2), (0, 2, 3)])
    meshes = (
        Mesh(corners, triangles, painted if light == "textured" else white, uvs=uvs, name="plate"),
        mesh([box((-1, 0, -1), (-0.4, 1.2, 0.6)), box((0.3, 0, -0.7), (1, 0.6, 0.1))], white, "boxes"),
    )
    sun = DirectionalLight((0.5, -1.0, -0.4), (3.0, 2.5, 2.0), 2.0)
    lights: dict[str, tuple[PointLight | DirectionalLight, ...]] = {
        "point": (PointLight((0.1, 1.5, 1.0), (5.0, 4.0, 3.0)),),
        "sun": (sun,),
        "sky": (),
        "textured": (sun,),
    }
    sky = Environment(np.ascontiguousarray(np.linspace(1, 0.2, 8 * 16 * 3).reshape(8, 16, 3)))
    camera = Camera(look_at((0.6, 2.6, 3.4), (0, 0.2, 0)), fov=50)
    return Scene(meshes, lights[light], sky if light == "sky" else None, (camera,), name="court")
