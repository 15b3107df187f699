# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Scenes of 60 frames in which something moves: a ball, a door, a lamp, or the camera. Frame n is at the time n."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

import eclat
from eclat.motion.animation import Motion, Pose
from eclat.scene import Material, Mesh, Scene, grey
from eclat.scenes.geometry import icosphere
from eclat.scenes.geometry import mesh as made
from harness.scenes import BenchmarkScene

FRAMES = 60
DOOR = ("door", "door_hinge1", "door_hinge2", "door_hinge3", "door_knob")
HINGE = np.array([61.9, 0.0, -72.3])
"""A point of the axis about which the door of `veach-door` turns, along y, in the units of its file."""


def _animated(scene: Scene, name: str, posed: Callable[[float], dict[Any, Mesh]]) -> Scene:
    """The scene with meshes that follow `posed`, a function of a share 0..1 of the time of all frames."""
    fixed: dict[Any, Mesh] = dict(enumerate(scene.meshes))

    def pose(time: float) -> Pose:
        return Pose(fixed | posed(time / (FRAMES - 1)))

    rest = pose(0)
    return replace(scene, meshes=tuple(rest.meshes.values()), animation=Motion(rest, pose, 0, FRAMES, (name,)))


def with_ball(scene: Scene, radius: float = 0.12) -> Scene:
    """A ball that rolls along the front of the Cornell box."""
    sphere = made([icosphere(3)], Material("diffuse", {"reflectance": grey(0.7)}), "ball")

    def posed(t: float) -> dict[Any, Mesh]:
        x = -0.8 + 1.6 * t
        c, s = np.cos(-x / radius), np.sin(-x / radius)
        turned = np.asarray(sphere.positions) @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        return {"ball": replace(sphere, positions=radius * turned + [x, radius - 0.999, 0.87])}

    return _animated(scene, "ball", posed)


def with_opening_door(scene: Scene, degrees: float = 40.0) -> Scene:
    """The door of `veach-door`, which opens further by some degrees, with its hinges and its knob."""
    moved = {number: mesh for number, mesh in enumerate(scene.meshes) if mesh.name in DOOR}

    def turned(mesh: Mesh, angle: float) -> Mesh:
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        normals = None if mesh.normals is None else np.asarray(mesh.normals) @ turn.T
        return replace(mesh, positions=(np.asarray(mesh.positions) - HINGE) @ turn.T + HINGE, normals=normals)

    return _animated(scene, "door", lambda t: {n: turned(mesh, -np.radians(degrees) * t) for n, mesh in moved.items()})


def with_swinging_lamp(scene: Scene, length: float = 1.6, degrees: float = 25.0) -> Scene:
    """A lamp that hangs in the southern walk of the atrium, by night, and swings once to and fro."""
    hook, light = np.array([-1.6, 3.4, 9.2]), Material("diffuse", {"reflectance": grey(0)}, emission=grey(40.0))
    sphere = made([icosphere(2)], light, "lamp")

    def posed(t: float) -> dict[Any, Mesh]:
        angle = np.radians(degrees) * np.cos(2 * np.pi * t)
        place = hook + length * np.array([np.sin(angle), -np.cos(angle), 0])
        return {"lamp": replace(sphere, positions=0.12 * np.asarray(sphere.positions) + place)}

    return _animated(replace(scene, lights=(), environment=None), "lamp", posed)


def with_walk(scene: Scene, metres: float = 0.8, aside: float = 0.3) -> Scene:
    """A camera that walks ahead and to the right."""
    matrix = np.asarray(scene.cameras[0].to_world, np.float64)
    right, ahead, start = matrix[:3, 0], -matrix[:3, 2], matrix[:3, 3]
    along = np.array([ahead[0], 0, ahead[2]]) / np.hypot(ahead[0], ahead[2])
    end = start + metres * along + aside * right
    keys = [
        {"time": time, "from": place.tolist(), "to": (place + ahead).tolist()}
        for time, place in ((0, start), (FRAMES - 1, end))
    ]
    return eclat.with_camera_path(scene, {"keys": keys})


MOVING: dict[str, BenchmarkScene] = {
    "ball": BenchmarkScene("cornell-box", (128, 72), change=with_ball),
    "door": BenchmarkScene("veach-door/scene.xml", (128, 72), change=with_opening_door),
    "lamp": BenchmarkScene("atrium", (128, 72), change=with_swinging_lamp),
    "box-walk": BenchmarkScene("cornell-box", (128, 72), change=lambda scene: with_walk(scene, 1.2, 0.5)),
    "walk": BenchmarkScene("living-room/scene.xml", (128, 72), change=with_walk),
}
