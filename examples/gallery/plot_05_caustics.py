# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""
Caustics of a glass ball, by photon mapping
===========================================

Light that is focused by glass is found by tracing it from the lamps. The scene is a dict in the words of Mitsuba, which
``load`` reads like a file.
"""

import numpy as np

import eclat
from eclat.scene import look_at


def square(place, half_width, turn, **more):
    """A square whose middle is at `place`; it faces +z, and `turn` tips it backwards, in degrees."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    to_world = np.eye(4)
    to_world[:3, :3] = half_width * np.array([[1, 0, 0], [0, c, s], [0, -s, c]])
    to_world[:3, 3] = place
    return {"type": "rectangle", "to_world": to_world, **more}


def rgb(*value):
    return {"type": "rgb", "value": value}


white = {"type": "diffuse", "reflectance": rgb(0.7, 0.7, 0.7)}
scene = eclat.load(
    {
        "type": "scene",
        "camera": {
            "type": "perspective",
            "fov": 40,
            "to_world": look_at((0, 1.6, 3.2), (0, 0.35, 0))
            @ np.diag([-1, 1, -1, 1]),  # Mitsuba's cameras look along +z
        },
        "floor": square([0, 0, 0], 2.5, 90, bsdf=white),
        "wall": square([0, 2.5, -1.5], 2.5, 0, bsdf=white),
        "lamp": square([0.9, 2.6, 0.4], 0.15, -90, emitter={"type": "area", "radiance": rgb(90, 80, 65)}),
        "ball": {"type": "sphere", "center": [0, 0.5, 0], "radius": 0.5, "bsdf": {"type": "dielectric"}},
    }
)
image = eclat.render(scene, eclat.PhotonMap(caustic_photons=300_000), samples=16, size=(320, 240), denoise=True)
image.save("caustic.png", exposure=0.5, tone_mapping="filmic")
