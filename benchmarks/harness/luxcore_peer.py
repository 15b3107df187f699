# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""LuxCore's PhotonGI as a peer: paths that end, after the first diffuse bounce, in a cache made from photons."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eclat.scene import Camera, DirectionalLight, Mesh, Scene
from harness.entrant import Picture, Pixels, diffuse_reflectance, emitted, timed
from harness.unavailable import UnavailableError

NAME = "LuxCore"
POLL = 0.01
"""Seconds between two looks whether the picture is done."""


@dataclass(frozen=True)
class Level:
    """Photons at most, the cache's radius as part of the scene's size, samples a pixel."""

    photons: int
    radius: float
    samples: int


LEVELS = (Level(1_000_000, 0.05, 16), Level(4_000_000, 0.03, 64), Level(16_000_000, 0.02, 256))
HALT_THRESHOLD = 0.02
"""Estimated error of the cache at which fewer photons are enough."""


def start() -> Any:
    """The module `pyluxcore`, silent. Raises UnavailableError where it is missing or does not start."""
    try:
        import pyluxcore
    except ImportError as error:
        raise UnavailableError(f"LuxCore is not there: pip install '.[bench]' (PyPI pyluxcore; {error})") from error
    pyluxcore.Init(lambda message: None)
    return pyluxcore


def scene_properties(scene: Scene, size: tuple[int, int]) -> dict[str, list[Any]]:
    """Camera, materials, objects and lights by the names of LuxCore's scene language; meshes are shape0, shape1 …

    Raises UnavailableError for what has no counterpart.
    """
    properties = _camera(scene.cameras[0], size)
    for i, mesh in enumerate(scene.meshes):
        material, object_ = f"scene.materials.material{i}", f"scene.objects.object{i}"
        radiance = emitted(mesh, NAME)
        # An emitter that is not diffuse too hardly ever is here, and its reflection is kept where it is.
        properties |= {f"{material}.type": ["matte"], f"{material}.kd": list(diffuse_reflectance(mesh, NAME))}
        if radiance is not None:
            properties |= {f"{material}.emission": list(radiance), f"{material}.emission.gain": [1.0, 1.0, 1.0]}
        properties |= {f"{object_}.shape": [f"shape{i}"], f"{object_}.material": [f"material{i}"]}
    for i, light in enumerate(scene.lights):
        if not isinstance(light, DirectionalLight) or light.angular_radius != 0:
            raise UnavailableError(f"{NAME} is given directional lights without a disc only")
        sun = f"scene.lights.sun{i}"
        properties |= {
            f"{sun}.type": ["sharpdistant"], f"{sun}.direction": list(light.direction),
            f"{sun}.color": list(light.irradiance), f"{sun}.gain": [1.0, 1.0, 1.0],
        }  # fmt: skip
    if scene.environment is not None:
        if scene.environment.image.shape[:2] != (1, 1):
            raise UnavailableError(f"{NAME} is given a constant environment only")
        radiance = tuple(float(value) for value in scene.environment.image[0, 0])
        sky = "scene.lights.sky"
        properties |= {f"{sky}.type": ["constantinfinite"], f"{sky}.color": list(radiance), f"{sky}.gain": [1.0] * 3}
    return properties


def settings(level: Level, size: tuple[int, int], threads: int, extent: float, cached: bool) -> dict[str, list[Any]]:
    """How LuxCore renders. Without `cached` it is a plain path tracer."""
    photongi = "path.photongi"
    cache: dict[str, list[Any]] = {
        f"{photongi}.sampler.type": ["METROPOLIS"], f"{photongi}.photon.maxcount": [level.photons],
        f"{photongi}.photon.maxdepth": [16], f"{photongi}.indirect.enabled": [True],
        f"{photongi}.indirect.maxsize": [0], f"{photongi}.indirect.haltthreshold": [HALT_THRESHOLD],
        f"{photongi}.indirect.lookup.radius": [level.radius * extent],
        f"{photongi}.indirect.usagethresholdscale": [8.0], f"{photongi}.caustic.enabled": [False],
        f"{photongi}.debug.type": ["none"],
    }  # fmt: skip
    return {
        "renderengine.type": ["PATHCPU"], "sampler.type": ["SOBOL"], "sampler.sobol.adaptive.strength": [0.0],
        "path.pathdepth.total": [64], "path.pathdepth.diffuse": [64], "path.pathdepth.glossy": [64],
        "path.pathdepth.specular": [64], "path.clamping.variance.maxvalue": [0.0],
        "film.width": [size[0]], "film.height": [size[1]], "film.filter.type": ["NONE"],
        "film.imagepipelines.0.0.type": ["NOP"], "native.threads.count": [threads], "batch.haltspp": [level.samples],
    } | (cache if cached else {})  # fmt: skip


class Entrant:
    """Times hold the tree, the photons, the cache and the picture; arrays are handed over before."""

    unbiased: ClassVar[bool] = False
    cached: ClassVar[bool] = True

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        self.luxcore = start()
        self.size, self.threads = size, threads
        points = np.concatenate([np.asarray(mesh.positions, np.float64) for mesh in scene.meshes])
        self.extent = float(np.ptp(points, axis=0).max())
        self.levels = tuple(
            f"{q.photons // 10**6} M photons, radius {100 * q.radius:g} % of the scene, {q.samples} samples"
            for q in LEVELS
        )
        self.version = f"LuxCore {self.luxcore.Version()}"
        self.scene = self.luxcore.Scene()
        for i, mesh in enumerate(scene.meshes):
            self.scene.DefineMesh(f"shape{i}", *_arrays(mesh), None, None, None)
        self.scene.Parse(self._properties(scene_properties(scene, size)))

    def render(self, level: int) -> Picture:
        return timed(lambda: self.draw(LEVELS[level]))

    def draw(self, level: Level) -> Pixels:
        """One picture at settings of one's own."""
        wanted = settings(level, self.size, self.threads, self.extent, self.cached)
        session = self.luxcore.RenderSession(self.luxcore.RenderConfig(self._properties(wanted), self.scene))
        session.Start()
        while not session.HasDone():
            time.sleep(POLL)
            session.UpdateStats()
        session.Stop()
        width, height = self.size
        buffer = np.zeros(width * height * 3, np.float32)
        session.GetFilm().GetOutputFloat(self.luxcore.FilmOutputType.RGB_IMAGEPIPELINE, buffer, 0)
        return buffer.reshape(height, width, 3)[::-1].copy()

    def _properties(self, values: dict[str, list[Any]]) -> Any:
        properties = self.luxcore.Properties()
        for name, value in values.items():
            properties.Set(self.luxcore.Property(name, value))
        return properties


def _arrays(mesh: Mesh) -> tuple[list[Any], list[Any], list[Any] | None]:
    """Points, triangles, and normals or None."""
    points = [tuple(map(float, p)) for p in np.asarray(mesh.positions, np.float64)]
    triangles = [tuple(map(int, t)) for t in np.asarray(mesh.triangles)]
    if mesh.normals is None:
        return points, triangles, None
    return points, triangles, [tuple(map(float, n)) for n in np.asarray(mesh.normals, np.float64)]


def _camera(camera: Camera, size: tuple[int, int]) -> dict[str, list[Any]]:
    matrix = np.asarray(camera.to_world, np.float64)
    if camera.projection != "perspective" or camera.aperture_radius or any(camera.shift):
        raise UnavailableError(f"{NAME} is given pinhole cameras only")
    if np.linalg.det(matrix[:3, :3]) < 0:
        raise UnavailableError(f"{NAME} is given no mirrored camera")
    half_width, half_height = camera.half_extent(size[0] / size[1])
    aspect = half_width / half_height
    name, origin = "scene.camera", matrix[:3, 3]
    return {
        f"{name}.type": ["perspective"], f"{name}.lookat.orig": origin.tolist(),
        f"{name}.lookat.target": (origin - matrix[:3, 2]).tolist(), f"{name}.up": matrix[:3, 1].tolist(),
        f"{name}.fieldofview": [float(2 * np.degrees(np.arctan(half_height)))],
        f"{name}.screenwindow": [-aspect, aspect, -1.0, 1.0], f"{name}.autofocus.enable": [False],
        f"{name}.lensradius": [0.0], f"{name}.cliphither": [1e-3], f"{name}.clipyon": [1e6],
    }  # fmt: skip
