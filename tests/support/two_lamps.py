# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The Cornell box with its lamp, a warm globe lamp, a point light and a sky that comes through the open front."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import eclat
from eclat.scene import Environment, Material, Mesh, PointLight, grey, rgb
from eclat.scenes import build
from eclat.scenes.geometry import icosphere


def lamps_of_all_kinds() -> eclat.Scene:
    """Groups: light (the Cornell box's lamp), globe, bulb and sky."""
    box = build("cornell-box")
    ball = icosphere(1)
    glow = Material("diffuse", {"reflectance": grey(0.3)}, emission=rgb(6, 3, 1), name="glow")
    globe = Mesh(ball.positions * 0.12 + (0.6, 0.2, 0.5), ball.triangles, glow, name="globe")
    bulb = PointLight((-0.6, 0.4, 0.6), (0.2, 0.3, 0.5), name="bulb")
    sky = Environment(np.full((1, 1, 3), 0.3, np.float32))
    return replace(box, meshes=(*box.meshes, globe), lights=(bulb,), environment=sky)
