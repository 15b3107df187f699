# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""POV-Ray's radiosity as a peer: an ambient cache after Ward, filled by a pretrace from coarse to fine.

An emitter is an area light of points that shine with a cosine (a spotlight of tightness 1) and fade with the square of
the distance, beside a mesh that shows its radiance and is hidden from shadow and radiosity rays, so that no light
counts twice; a black copy a little behind it stands for its back.
"""

from __future__ import annotations

import math
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from eclat.images.exr import decode_exr
from eclat.images.image import check_size
from eclat.scene import Camera, DirectionalLight, Mesh, Scene
from harness.entrant import Picture, diffuse_reflectance, emitted
from harness.lamps import Lamp, lamps
from harness.unavailable import UnavailableError

NAME = "POV-Ray"
FADE_DISTANCE = 1e-3
"""A light of colour C gives C · 2 / (1 + (d / FADE_DISTANCE)²) at distance d: an inverse square beyond millimetres."""

SPENT = re.compile(r"(Bounding|Radiosity|Trace) Time:[^(\n]*\(([0-9.]+) seconds\)")


@dataclass(frozen=True)
class Level:
    """How good a picture is: the first five are options of `radiosity` in POV-Ray's language."""

    count: int
    error_bound: float
    nearest_count: int
    pretrace_end: float
    recursion_limit: int
    side: int
    """Rays along each side of a pixel."""
    grid: int
    """Points along each side of an area light; they are jittered, so that a pixel's rays see different ones."""


LEVELS = (
    Level(100, 0.5, 5, 0.02, 3, 2, 3),
    Level(300, 0.3, 10, 0.01, 5, 2, 5),
    Level(800, 0.2, 15, 0.005, 7, 3, 5),
)


def describe(scene: Scene, size: tuple[int, int], level: Level, radiosity: bool = True) -> str:
    """The scene as POV-Ray reads it; without `radiosity`, direct light only.

    Raises UnavailableError for what has no counterpart.
    """
    parts = ["#version 3.7;", _settings(level, radiosity), _camera(scene.cameras[0], size)]
    for mesh in scene.meshes:
        radiance = emitted(mesh, NAME)
        if radiance is None:
            parts.append(
                _mesh(
                    mesh,
                    f"pigment {{ rgb {_vector(diffuse_reflectance(mesh, NAME))} }} finish {{ ambient 0 diffuse 1 }}",
                )
            )
            continue
        shown = f"pigment {{ rgb {_vector(radiance)} }} finish {{ ambient 0 emission 1 diffuse 0 }}"
        parts.append(_mesh(mesh, shown, "no_shadow no_radiosity"))
        parts += [_back(lamp) for lamp in lamps(mesh)]
        parts += [_area_light(lamp, radiance, level.grid) for lamp in lamps(mesh)]
    for light in scene.lights:
        if not isinstance(light, DirectionalLight) or light.angular_radius != 0:
            raise UnavailableError(f"{NAME} is given directional lights without a disc only")
        colour = [value / math.pi for value in light.irradiance]
        far = [-1e5 * value for value in light.direction]
        parts.append(f"light_source {{ {_vector(far)} rgb {_vector(colour)} parallel point_at <0,0,0> }}")
    if scene.environment is not None:
        if scene.environment.image.shape[:2] != (1, 1):
            raise UnavailableError(f"{NAME} is given a constant environment only")
        radiance = tuple(float(value) for value in scene.environment.image[0, 0])
        parts.append(f"background {{ rgb {_vector(radiance)} }}")
    return "\n".join(parts) + "\n"


class Entrant:
    """Times are POV-Ray's own for bounding boxes, radiosity and trace; what it spends on parsing does not count."""

    unbiased: ClassVar[bool] = False
    radiosity: ClassVar[bool] = True

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        if shutil.which("povray") is None:
            raise UnavailableError("POV-Ray is not installed: apt-get install povray")
        self.size, self.threads = size, threads
        self.levels = tuple(f"count {q.count}, error_bound {q.error_bound:g}, {q.side**2} rays a pixel" for q in LEVELS)
        self.folder = tempfile.TemporaryDirectory(prefix="povray-")
        for i, quality in enumerate(LEVELS):
            fine = (quality.side * size[0], quality.side * size[1])
            self._source(i).write_text(describe(scene, fine, quality, self.radiosity), encoding="ascii")
        said = subprocess.run(["povray", "--version"], capture_output=True, text=True)
        found = re.search(r"POV-Ray ([0-9.]+[0-9])", said.stdout + said.stderr)
        self.version = f"POV-Ray {found.group(1) if found else ''}".strip()

    def render(self, level: int) -> Picture:
        side = LEVELS[level].side
        (width, height), source = self.size, self._source(level)
        picture = source.with_suffix(".exr")
        done = subprocess.run(
            ["povray", f"+I{source}", f"+O{picture}", "+FE", f"+W{side * width}", f"+H{side * height}", "-D", "-A", "+Q9",
             f"+WT{self.threads}"],
            capture_output=True, text=True, cwd=self.folder.name,
        )  # fmt: skip
        if done.returncode != 0 or not picture.is_file():
            raise RuntimeError(f"povray ended with code {done.returncode}: {(done.stdout + done.stderr)[-300:]}")
        fine, _, _ = decode_exr(picture.read_bytes(), picture.name, check_size)
        boxes = fine.reshape(height, side, width, side, 3)
        seconds = sum(float(value) for _, value in SPENT.findall(done.stdout + done.stderr))
        return Picture(boxes.mean(axis=(1, 3), dtype=np.float64).astype(np.float32), seconds)

    def _source(self, level: int) -> Path:
        return Path(self.folder.name) / f"scene{level}.pov"


def _settings(level: Level, radiosity: bool) -> str:
    cache = (
        "radiosity { pretrace_start 0.08 "
        f"pretrace_end {level.pretrace_end:g} count {level.count} error_bound {level.error_bound:g} "
        f"nearest_count {level.nearest_count} recursion_limit {level.recursion_limit} low_error_factor 0.5 "
        "gray_threshold 0 minimum_reuse 0.004 maximum_reuse 0.2 brightness 1 adc_bailout 0.001 always_sample off }"
    )
    return f"global_settings {{ assumed_gamma 1 max_trace_level 20 {cache if radiosity else ''} }}"


def _camera(camera: Camera, size: tuple[int, int]) -> str:
    if camera.projection != "perspective" or camera.aperture_radius or any(camera.shift):
        raise UnavailableError(f"{NAME} is given pinhole cameras only")
    matrix = np.asarray(camera.to_world, np.float64)
    half_width, half_height = camera.half_extent(size[0] / size[1])
    right, up = 2 * half_width * matrix[:3, 0], 2 * half_height * matrix[:3, 1]
    return (
        f"camera {{ location {_vector(matrix[:3, 3])} direction {_vector(-matrix[:3, 2])} "
        f"right {_vector(right)} up {_vector(up)} }}"
    )


def _mesh(mesh: Mesh, texture: str, flags: str = "") -> str:
    positions = np.asarray(mesh.positions, np.float64)
    lists = [f"vertex_vectors {{ {len(positions)}, {', '.join(_vector(p) for p in positions)} }}"]
    if mesh.normals is not None:
        normals = np.asarray(mesh.normals, np.float64)
        lists.append(f"normal_vectors {{ {len(normals)}, {', '.join(_vector(n) for n in normals)} }}")
    faces = ", ".join(f"<{a},{b},{c}>" for a, b, c in np.asarray(mesh.triangles))
    lists.append(f"face_indices {{ {len(mesh.triangles)}, {faces} }}")
    return f"mesh2 {{ {' '.join(lists)} texture {{ {texture} }} {flags} }}"


def _back(lamp: Lamp) -> str:
    """The black back of a lamp, a ten-thousandth of its size behind it."""
    centre = lamp.centre - 1e-4 * math.sqrt(lamp.area) * lamp.normal
    black = "texture { pigment { rgb 0 } finish { ambient 0 diffuse 0 } } no_shadow no_image"
    if lamp.circular:
        return f"disc {{ {_vector(centre)}, {_vector(lamp.normal)}, {math.sqrt(lamp.area / math.pi):.9g} {black} }}"
    corners = lamp.corners() + (centre - lamp.centre)
    return f"polygon {{ 5, {', '.join(_vector(c) for c in [*corners, corners[0]])} {black} }}"


def _area_light(lamp: Lamp, radiance: tuple[float, float, float], grid: int) -> str:
    """Its colour C is such that the surface's radiance ρ · C · 2 (FADE_DISTANCE / d)² cos cos is ρ / π · E.

    POV-Ray puts the outer points of its grid on the lamp's edges and jitters all by half a step; drawn in by half a
    cell, jittered points cover the lamp evenly.
    """
    colour = [value * lamp.area / (2 * math.pi * FADE_DISTANCE**2) for value in radiance]
    across, along = (edge * (grid - 1) / grid for edge in (lamp.across, lamp.along))
    return (
        f"light_source {{ {_vector(lamp.centre)} rgb {_vector(colour)} "
        f"spotlight radius 90 falloff 90 tightness 1 point_at {_vector(lamp.centre + lamp.normal)} "
        f"fade_distance {FADE_DISTANCE} fade_power 2 area_light {_vector(across)}, {_vector(along)}, "
        f"{grid}, {grid} {'circular ' if lamp.circular else ''}adaptive 0 jitter area_illumination on }}"
    )


def _vector(values: object) -> str:
    return "<" + ",".join(f"{float(value):.9g}" for value in np.asarray(values).ravel()) + ">"
