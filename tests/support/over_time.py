# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A small scene that moves, and its times, for tests of records over time."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import eclat
from eclat.bridge.compiled import fingerprint
from eclat.frames.motion_layers import Moment
from eclat.frames.timeline import Timeline
from eclat.methods.work import Times
from eclat.motion.animation import Motion, Pose
from eclat.scene import Material, Mesh, Scene, grey
from eclat.scenes.geometry import icosphere
from eclat.scenes.geometry import mesh as made

SIZE = (32, 24)
BALL, RADIUS = 8, 0.12
"""The number of the mesh of the ball that rolls, and its radius in metres."""


def times_of(scene: Scene, count: int, backwards: bool = False) -> Times:
    """The times 0, 1, … of a scene, whose camera is the first."""

    def at(time: float) -> Moment:
        found = scene.at(count - 1 - time if backwards else time)
        return Moment(found, found.cameras[0])

    return Timeline(at, map(float, range(count)), SIZE, fingerprint, count).times


def rolling(count: int) -> Scene:
    """The Cornell box, through which a ball rolls along the front."""
    scene = eclat.load("cornell-box")
    sphere = made([icosphere(2)], Material("diffuse", {"reflectance": grey(0.7)}), "ball")
    fixed: dict[Any, Mesh] = dict(enumerate(scene.meshes))

    def pose(time: float) -> Pose:
        x = -0.8 + 1.6 * time / (count - 1)
        c, s = np.cos(-x / RADIUS), np.sin(-x / RADIUS)
        turned = np.asarray(sphere.positions) @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        return Pose(fixed | {"ball": replace(sphere, positions=RADIUS * turned + [x, RADIUS - 0.999, 0.87])})

    rest = pose(0)
    return replace(scene, meshes=tuple(rest.meshes.values()), animation=Motion(rest, pose, 0, count, ("ball",)))
