# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Scenes scaled, turned and moved as a whole, with their lights and cameras: their pictures must not change."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from eclat.scene import Camera, DirectionalLight, FloatArray, Mesh, PointLight, Scene, SpotLight


def rotation(axis: tuple[float, float, float], degrees: float) -> FloatArray:
    """3×3, about `axis` by the right-hand rule."""
    x, y, z = np.asarray(axis, np.float64) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


@dataclass(frozen=True, eq=False)
class Similarity:
    """p → scale · turn · p + shift."""

    scale: float = 1.0
    turn: FloatArray = field(default_factory=lambda: np.eye(3))
    shift: FloatArray = field(default_factory=lambda: np.zeros(3))

    def point(self, p: FloatArray) -> FloatArray:
        return self.scale * np.asarray(p, np.float64) @ self.turn.T + self.shift

    def direction(self, d: FloatArray) -> FloatArray:
        return np.asarray(d, np.float64) @ self.turn.T

    def scene(self, scene: Scene) -> Scene:
        """`scene` elsewhere: intensities grow with the square of lengths, so that irradiance stays."""
        if scene.environment is not None:
            environment = replace(scene.environment, to_world=self.turn @ scene.environment.to_world)
        else:
            environment = None
        return replace(
            scene,
            meshes=tuple(self._mesh(m) for m in scene.meshes),
            lights=tuple(self._light(light) for light in scene.lights),
            cameras=tuple(self._camera(c) for c in scene.cameras),
            environment=environment,
        )

    def _mesh(self, mesh: Mesh) -> Mesh:
        tangents = mesh.tangents
        if tangents is not None:
            tangents = np.column_stack((self.direction(tangents[:, :3]), tangents[:, 3]))
        normals = None if mesh.normals is None else self.direction(mesh.normals)
        return replace(mesh, positions=self.point(mesh.positions), normals=normals, tangents=tangents)

    def _light(self, light: PointLight | SpotLight | DirectionalLight) -> PointLight | SpotLight | DirectionalLight:
        if isinstance(light, DirectionalLight):
            return replace(light, direction=_triple(self.direction(light.direction)))
        moved = {
            "position": _triple(self.point(light.position)),
            "intensity": _triple(np.array(light.intensity) * self.scale**2),
        }
        if isinstance(light, SpotLight):
            moved["direction"] = _triple(self.direction(light.direction))
        return replace(light, **moved)

    def _camera(self, camera: Camera) -> Camera:
        matrix = np.array(camera.to_world, np.float64)
        matrix[:3, :3] = self.turn @ matrix[:3, :3]
        matrix[:3, 3] = self.point(matrix[:3, 3])
        return replace(
            camera,
            to_world=matrix,
            aperture_radius=camera.aperture_radius * self.scale,
            focus_distance=camera.focus_distance * self.scale,
        )


def _triple(v: FloatArray) -> tuple[float, float, float]:
    x, y, z = map(float, v)
    return x, y, z
