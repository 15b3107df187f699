# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""All times of the pictures of an animation, and the states that its scene is in at them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.frames.kept import fingerprint_of
from eclat.frames.motion_layers import Moment
from eclat.methods.work import Times
from eclat.scene import Camera, Scene

MOST_KEPT = 8_000_000
"""The number of triangles in all scenes that are kept at once, compiled: some two gigabytes."""

_ROUNDING = 1e-6
"""What changes by less than this share of its value only rounds differently."""

Numbers = NDArray[np.float64]


class Timeline:
    """The times of the pictures of an animation.

    Parameters
    ----------
    at : returns the scene and the camera at a time in seconds.
    seconds : the times in any order.
    fingerprint : returns the fingerprint of a scene.
    frames : the number of frames.
    """

    def __init__(
        self,
        at: Callable[[float], Moment],
        seconds: Iterable[float],
        size: tuple[int, int],
        fingerprint: Callable[[Scene], str],
        frames: int,
    ) -> None:
        self._at = at
        self._seconds = sorted(set(seconds))
        self._index = {time: i for i, time in enumerate(self._seconds)}
        self._scenes: dict[int, Scene] = {}
        states: list[int] = []
        names: list[str] = []
        cameras: list[Camera] = []
        courses: list[list[tuple[float, Numbers]]] = []
        moving: set[int] = set()
        last: Scene | None = None
        for time in self._seconds:
            moment = at(time)
            name = fingerprint(moment.scene)
            if not names or name != names[-1]:
                names.append(name)
            states.append(len(names) - 1)
            cameras.append(moment.camera)
            courses.append(_course(moment.scene))
            if last is not None:
                moving |= _moved(last, moment.scene)
            last = moment.scene
        self._states = states
        self.fingerprints = names
        self.times = Times(
            np.array(self._seconds), np.array(states, np.int64), self._scene, tuple(cameras), size,
            tuple(sorted(moving)), _in_units(courses), len(self._seconds) / frames,
        )  # fmt: skip

    def fingerprint(self, cameras: Callable[[Camera], str]) -> str:
        """Compute a hash of all scenes and cameras, given the fingerprint of a camera."""
        return fingerprint_of(
            {
                "scenes": self.fingerprints, "states": self._states, "seconds": self._seconds,
                "cameras": [cameras(camera) for camera in self.times.cameras],
            }
        )  # fmt: skip

    def index(self, seconds: float) -> int:
        """Return the index of a time."""
        return self._index[seconds]

    def scene(self, seconds: float) -> Scene:
        """Return the scene at a time, always the same object while it is kept."""
        return self.times.scene(self.index(seconds))

    def __getstate__(self) -> dict[str, Any]:
        """Return what travels to other machines: these make the scenes themselves."""
        return self.__dict__ | {"_scenes": {}}

    def _scene(self, state: int) -> Scene:
        if state not in self._scenes:
            scene = self._at(self._seconds[self._states.index(state)]).scene
            triangles = sum(len(mesh.triangles) for mesh in scene.meshes)
            while self._scenes and (len(self._scenes) + 1) * triangles > MOST_KEPT:
                del self._scenes[next(iter(self._scenes))]
            self._scenes[state] = scene
        return self._scenes[state]


def _course(scene: Scene) -> list[tuple[float, Numbers]]:
    """Return vectors that follow what moves and shines, each with the length that counts as a unit, or 0 for its own range:
    the centre of the vertices of each mesh, in units of its size, its emission, all numbers of lights, and the brightness of the
    environment. Turns on the spot, as those of a wheel, seldom change the light, and are left out.
    """
    found: list[tuple[float, Numbers]] = []
    for mesh in scene.meshes:
        positions = np.asarray(mesh.positions, np.float64)
        size = float(np.linalg.norm(np.ptp(positions, axis=0))) if len(positions) else 0.0
        found.append((size, positions.mean(axis=0) if len(positions) else np.zeros(3)))
        emission = mesh.material.emission
        found.append((0.0, np.array(emission.constant[:3] if emission is not None else (0.0,) * 3, np.float64)))
    for light in scene.lights:
        for part in fields(light):
            value = getattr(light, part.name)
            if isinstance(value, int | float | tuple | np.ndarray):
                found.append((0.0, np.asarray(value, np.float64).ravel()))
    image = None if scene.environment is None else np.asarray(scene.environment.image)
    found.append((0.0, np.array([0.0 if image is None else image.mean(dtype=np.float64)])))
    return found


def _in_units(courses: list[list[tuple[float, Numbers]]]) -> Numbers:
    """Return the courses of all times as numbers (S, K) in their units. What only rounding moves is left out."""
    columns = [np.zeros((len(courses), 1))]
    for vectors in zip(*courses, strict=True):
        values = np.array([vector for _, vector in vectors])
        moved = float(np.ptp(values, axis=0).max())
        if moved > _ROUNDING * float(np.abs(values).max()):
            columns.append(values / (max(size for size, _ in vectors) or moved))
    return np.concatenate(columns, axis=1)


def _moved(before: Scene, after: Scene) -> set[int]:
    """Return the numbers of the meshes whose vertices or triangles have changed."""
    pairs = enumerate(zip(before.meshes, after.meshes, strict=True))
    return {
        number
        for number, (a, b) in pairs
        if a is not b and not (np.array_equal(a.positions, b.positions) and np.array_equal(a.triangles, b.triangles))
    }
