# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Radiance's ambient cache as a peer: what `rpict` does to a view, through `rtrace`, which does it on all cores.

`rpict` traces one view on one core and writes 8-bit mantissas; `vwrays | rtrace` traces the same rays with the same
ambient calculation on all cores and writes floats. Processes share ambient values through a file (`-af`), which a
small overture picture fills first, as Radiance's own `rad` does.
"""

from __future__ import annotations

import importlib.util
import math
import os
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from eclat.scene import Camera, DirectionalLight, Mesh, Scene
from harness.entrant import Picture, Pixels, diffuse_reflectance, emitted
from harness.lamps import lamps
from harness.unavailable import UnavailableError

NAME = "Radiance"
SUN_DEGREES = 0.05
"""Diameter of the sun that stands for a delta light: Radiance's sources have a size. Its penumbra is invisible here."""

OVERTURE = 8
"""The overture's picture is this many times smaller in each direction."""


@dataclass(frozen=True)
class Level:
    """Bounces; ambient accuracy, resolution, divisions and super-samples; rays a pixel's side; sources' substructure."""

    bounces: int
    accuracy: float
    resolution: int
    divisions: int
    supersamples: int
    side: int
    substructuring: float

    def arguments(self) -> list[str]:
        """As rtrace takes them; roulette ends what matters little."""
        return [
            "-ab", str(self.bounces), "-aa", f"{self.accuracy:g}", "-ar", str(self.resolution),
            "-ad", str(self.divisions), "-as", str(self.supersamples), "-ds", f"{self.substructuring:g}", "-dj", "0.9",
            "-dt", "0", "-dc", "1", "-lr", "-14", "-lw", f"{1 / self.divisions:.3g}",
        ]  # fmt: skip


LEVELS = (
    Level(4, 0.3, 32, 256, 64, 2, 0.1),
    Level(6, 0.2, 64, 512, 128, 2, 0.1),
    Level(8, 0.15, 128, 1024, 256, 3, 0.05),
)


def programs() -> Path:
    """The folder of oconv, rtrace and their kin. Raises UnavailableError where the package is missing."""
    spec = importlib.util.find_spec("pyradiance")
    if spec is None or spec.origin is None:
        raise UnavailableError(
            "Radiance is not installed: pip install '.[bench]' (PyPI pyradiance carries its programs)"
        )
    return Path(spec.origin).parent / "bin"


def describe(scene: Scene) -> str:
    """The scene as Radiance reads it. Raises UnavailableError for what has no counterpart."""
    parts: list[str] = []
    for index, mesh in enumerate(scene.meshes):
        parts.append(_modifier(mesh, index))
        parts.append(_polygons(mesh, index) if mesh.material.emission is None else _sources(mesh, index))
    for index, light in enumerate(scene.lights):
        if not isinstance(light, DirectionalLight):
            raise UnavailableError(f"{NAME} is given suns only, not {type(light).__name__}")
        degrees = 2 * light.angular_radius or SUN_DEGREES
        solid_angle = 2 * math.pi * (1 - math.cos(math.radians(degrees / 2)))
        radiance = [value / solid_angle for value in light.irradiance]
        towards = [-value for value in light.direction]
        parts.append(f"void light sun{index}\n0\n0\n3 {_numbers(radiance)}\n")
        parts.append(f"sun{index} source disc{index}\n0\n0\n4 {_numbers(towards)} {degrees:.9g}\n")
    if scene.environment is not None:
        if scene.environment.image.shape[:2] != (1, 1):
            raise UnavailableError(f"{NAME} is given a constant environment only")
        radiance = [float(value) for value in scene.environment.image[0, 0]]
        parts.append(f"void glow sky\n0\n0\n4 {_numbers(radiance)} 0\nsky source everywhere\n0\n0\n4 0 1 0 360\n")
    return "\n".join(parts)


def view(camera: Camera, size: tuple[int, int]) -> list[str]:
    """The options of vwrays. Raises UnavailableError for lenses and mirrored cameras."""
    matrix = np.asarray(camera.to_world, np.float64)
    if camera.projection != "perspective" or camera.aperture_radius or any(camera.shift):
        raise UnavailableError(f"{NAME} is given pinhole cameras only")
    if np.linalg.det(matrix[:3, :3]) < 0:
        raise UnavailableError(f"{NAME} has no mirrored camera")
    half_width, half_height = camera.half_extent(size[0] / size[1])
    return [
        "-vtv", "-vp", *_words(matrix[:3, 3]), "-vd", *_words(-matrix[:3, 2]), "-vu", *_words(matrix[:3, 1]),
        "-vh", f"{2 * math.degrees(math.atan(half_width)):.9g}",
        "-vv", f"{2 * math.degrees(math.atan(half_height)):.9g}",
    ]  # fmt: skip


class Entrant:
    """Times are those of rtrace's processes, less that of a picture of one pixel without any bounce."""

    unbiased: ClassVar[bool] = False

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        self.bin = programs()
        self.size, self.threads = size, threads
        self.levels = tuple(
            f"-ab {q.bounces} -aa {q.accuracy:g} -ad {q.divisions}, {q.side**2} rays a pixel" for q in LEVELS
        )
        self.view = view(scene.cameras[0], size)
        self.folder = tempfile.TemporaryDirectory(prefix="radiance-")
        self.octree = Path(self.folder.name) / "scene.oct"
        source = self.octree.with_suffix(".rad")
        source.write_text(describe(scene), encoding="ascii")
        self.octree.write_bytes(self._run(["oconv", str(source)]))
        self.version = self._run(["rtrace", "-version"]).decode().split("(")[0].strip()
        self.start_up = self._start_up()

    def render(self, level: int) -> Picture:
        quality = LEVELS[level]
        ambient = self.octree.with_suffix(".amb")
        ambient.unlink(missing_ok=True)
        arguments = [*quality.arguments(), "-af", str(ambient)]
        small = (max(1, self.size[0] // OVERTURE), max(1, self.size[1] // OVERTURE))
        before = time.perf_counter()
        self._trace(small, arguments)
        fine = self._trace((quality.side * self.size[0], quality.side * self.size[1]), arguments)
        seconds = time.perf_counter() - before - 2 * self.start_up
        width, height = self.size
        boxes = fine.reshape(height, quality.side, width, quality.side, 3)
        return Picture(boxes.mean(axis=(1, 3), dtype=np.float64).astype(np.float32), max(seconds, 0.0))

    def trace(self, arguments: list[str]) -> Pixels:
        """One ray a pixel, with options of one's own: for tests."""
        return self._trace(self.size, arguments)

    def _trace(self, size: tuple[int, int], arguments: list[str]) -> Pixels:
        rays = ["vwrays", "-ff", "-pa", "0", "-pj", "1", "-x", str(size[0]), "-y", str(size[1]), *self.view]
        trace = ["rtrace", "-n", str(self.threads), "-h-", "-w-", "-ff", *arguments, str(self.octree)]
        data = self._run(trace, self._run(rays))
        return np.frombuffer(data, np.float32).reshape(size[1], size[0], 3)

    def _start_up(self) -> float:
        times = []
        for _ in range(3):
            before = time.perf_counter()
            self._trace((1, 1), ["-ab", "0"])
            times.append(time.perf_counter() - before)
        return min(times)

    def _run(self, command: list[str], given: bytes | None = None) -> bytes:
        """What a program of Radiance wrote. Raises RuntimeError with its complaint where it fails."""
        environment = {**os.environ, "RAYPATH": f".:{self.bin.parent / 'lib'}"}
        done = subprocess.run(
            [str(self.bin / command[0]), *command[1:]], input=given, capture_output=True, env=environment
        )
        if done.returncode != 0:
            complaint = done.stderr.decode(errors="replace").strip()
            raise RuntimeError(f"{command[0]} ended with code {done.returncode}: {complaint[-300:]}")
        return done.stdout


def _modifier(mesh: Mesh, index: int) -> str:
    radiance = emitted(mesh, NAME)
    if radiance is not None:
        return f"void light m{index}\n0\n0\n3 {_numbers(radiance)}\n"
    return f"void plastic m{index}\n0\n0\n5 {_numbers(diffuse_reflectance(mesh, NAME))} 0 0\n"


def _polygons(mesh: Mesh, index: int) -> str:
    corners = np.asarray(mesh.positions, np.float64)[mesh.triangles]
    return "".join(
        f"m{index} polygon t{index}.{i}\n0\n0\n9 {_numbers(triangle.ravel())}\n" for i, triangle in enumerate(corners)
    )


def _sources(mesh: Mesh, index: int) -> str:
    """Whole parallelograms and rings where a lamp is made of such: Radiance samples them better than triangles."""
    try:
        faces = lamps(mesh)
    except UnavailableError:
        return _polygons(mesh, index)
    lines = []
    for i, lamp in enumerate(faces):
        if lamp.circular:
            radius = math.sqrt(lamp.area / math.pi)
            lines.append(f"m{index} ring t{index}.{i}\n0\n0\n8 {_numbers([*lamp.centre, *lamp.normal, 0, radius])}\n")
            continue
        corners = lamp.corners()
        lines.append(f"m{index} polygon t{index}.{i}\n0\n0\n12 {_numbers(corners)}\n")
    return "".join(lines)


def _numbers(values: object) -> str:
    return " ".join(_words(values))


def _words(values: object) -> list[str]:
    return [f"{float(value):.9g}" for value in np.asarray(values).ravel()]
