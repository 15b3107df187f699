# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The animation of a scene: a loader's poses over time, applied to the scene as it is, with all changes of the user."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from eclat.scene import Animation, Camera, Environment, Light, Mesh, Scene

_OF_CAMERA = ("to_world", "fov", "aperture_radius", "focus_distance", "shift")
"""The properties of a camera that may change over time."""


@dataclass(frozen=True, eq=False)
class Pose:
    """What a file contains at one moment. The keys say which objects of two moments are the same one. An object that has
    not changed since the rest pose should be the same Python object."""

    meshes: Mapping[Hashable, Mesh] = field(default_factory=dict)
    lights: Mapping[Hashable, Light] = field(default_factory=dict)
    cameras: Mapping[Hashable, Camera] = field(default_factory=dict)
    environment: Environment | None = None


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of the objects of one file.

    Parameters
    ----------
    rest : the pose that the scene was loaded in.
    pose : a function from a time in seconds to the pose at that time.
    start, end : the times of the first and the last key in seconds.
    objects, lights, cameras : the names of what moves or changes.
    """

    rest: Pose
    pose: Callable[[float], Pose]
    start: float
    end: float
    objects: tuple[str, ...] = ()
    lights: tuple[str, ...] = ()
    cameras: tuple[str, ...] = ()

    def at(self, scene: Scene, time: float) -> Scene:
        """Return `scene`, which was loaded in the rest pose, as it is at a time in seconds.

        What was changed after loading stays: materials that were replaced, cameras that were placed elsewhere, lights that
        were removed. A mesh that the pose lacks, because it has no extent at that time, has no triangles.
        """
        pose = self.pose(time)
        meshes = list(scene.meshes)
        for index, (key, rest) in enumerate(self.rest.meshes.items()):
            # Changes after loading keep the order of the meshes and the arrays of positions.
            if index < len(meshes) and meshes[index].positions is rest.positions:
                meshes[index] = _moved_mesh(meshes[index], rest, pose.meshes.get(key))
        resting = {id(light): key for key, light in self.rest.lights.items()}
        lights = tuple(
            pose.lights.get(resting[id(light)], light) if id(light) in resting else light for light in scene.lights
        )
        known = {id(camera.to_world): key for key, camera in self.rest.cameras.items()}
        cameras = tuple(
            _moved_camera(c, self.rest.cameras[known[id(c.to_world)]], pose.cameras.get(known[id(c.to_world)]))
            if id(c.to_world) in known
            else c
            for c in scene.cameras
        )
        environment = scene.environment
        if environment is self.rest.environment and pose.environment is not None:
            environment = pose.environment
        return replace(
            scene, meshes=tuple(meshes), lights=lights, cameras=cameras, environment=environment, animation=None
        )


@dataclass(frozen=True, eq=False)
class Joined:
    """Two animations of one scene, such as that of a file and the path of a camera."""

    first: Animation
    second: Animation

    @property
    def start(self) -> float:
        return min(self.first.start, self.second.start)

    @property
    def end(self) -> float:
        return max(self.first.end, self.second.end)

    @property
    def objects(self) -> tuple[str, ...]:
        return (*self.first.objects, *self.second.objects)

    @property
    def lights(self) -> tuple[str, ...]:
        return (*self.first.lights, *self.second.lights)

    @property
    def cameras(self) -> tuple[str, ...]:
        return (*self.first.cameras, *self.second.cameras)

    def at(self, scene: Scene, time: float) -> Scene:
        return self.second.at(self.first.at(scene, time), time)


def _moved_mesh(current: Mesh, rest: Mesh, moved: Mesh | None) -> Mesh:
    if moved is rest:
        return current
    if moved is None:
        return replace(current, triangles=current.triangles[:0])
    material = moved.material if current.material is rest.material else current.material
    return replace(
        current, positions=moved.positions, triangles=moved.triangles, normals=moved.normals, tangents=moved.tangents,
        material=material,
    )  # fmt: skip


def _moved_camera(current: Camera, rest: Camera, moved: Camera | None) -> Camera:
    """Return the camera with what the animation changed, unless the user changed it first."""
    if moved is None or moved is rest:
        return current
    changes = {
        name: getattr(moved, name)
        for name in _OF_CAMERA
        if name == "to_world" or getattr(current, name) == getattr(rest, name)
    }
    changed = replace(current, **changes)
    same = all(getattr(changed, name) == getattr(current, name) for name in _OF_CAMERA if name != "to_world")
    return current if same and np.array_equal(changed.to_world, current.to_world) else changed
