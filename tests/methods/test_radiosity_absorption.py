# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Radiosity where light is lost: on black backs of one-sided sheets, and through holes in walls."""

from __future__ import annotations

import math

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, Material, Mesh, Scene, grey, look_at
from eclat.scenes.geometry import box

CAMERA = Camera(look_at((0.3, 1.3, 1.4), (0, 0.5, -0.3), (0, 1, 0)), fov=75.0, size=(16, 16))
BLACK = Material("diffuse", {"reflectance": grey(0.0)})


def diffuse(reflectance: float, two_sided: bool = False, back: Material | None = None) -> Material:
    return Material("diffuse", {"reflectance": grey(reflectance)}, two_sided=two_sided, back=back)


def emitting(radiance: float) -> Material:
    return Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(radiance))


def quad(corners: list[tuple[float, float, float]], material: Material) -> Mesh:
    return Mesh(np.array(corners, float), np.array([(0, 1, 2), (0, 2, 3)]), material)


def inner_sides(low: tuple[float, float, float], high: tuple[float, float, float], material: Material) -> Mesh:
    room = box(low, high).inside_out()
    return Mesh(room.positions, room.triangles, material, normals=room.normals)


def room_with_sheets(material: Material) -> Scene:
    """A white room of 3 × 2 × 3 m with four upright sheets whose fronts look along +z."""
    room = inner_sides((-1.5, 0, -1.5), (1.5, 2, 1.5), diffuse(0.8))
    lamp = quad([(-0.3, 1.9, -0.3), (0.3, 1.9, -0.3), (0.3, 1.9, 0.3), (-0.3, 1.9, 0.3)], emitting(10.0))
    sheets = [
        quad([(x, 0.2, z), (x + 0.8, 0.2, z), (x + 0.8, 1.4, z), (x, 1.4, z)], material)
        for x, z in ((-1.2, -0.9), (0.3, -0.7), (-0.4, 0.2), (-1.3, 0.5))
    ]
    return Scene(meshes=(room, lamp, *sheets), cameras=(CAMERA,))


def reflected(solution: eclat.RadiositySolution) -> float:
    """Power that arrives anywhere, W, but for black sides."""
    light = solution.irradiance.mean(axis=1) * solution.areas
    return float(light[solution.values[:, 6:9].mean(axis=1) > 0.1].sum())


def test_backs_of_one_sided_sheets_absorb_as_black_ones_do() -> None:
    options = eclat.Radiosity(patches=2000)
    one_sided = eclat.solve(room_with_sheets(diffuse(0.8)), options)
    black_backs = eclat.solve(room_with_sheets(diffuse(0.8, two_sided=True, back=BLACK)), options)
    assert reflected(one_sided) == pytest.approx(reflected(black_backs), rel=0.015)


@pytest.mark.parametrize("hole", [0.4, 0.1])
def test_light_through_a_keyhole_is_proportional_to_its_area(hole: float) -> None:
    """A room whose black walls emit radiance 1 shines through a thin hole of area A into a black room: π A arrives."""
    h = hole / 2
    bright = inner_sides((-2, -1, -1), (0, 1, 1), emitting(1.0))
    dark = inner_sides((0, -1, -1), (2, 1, 1), BLACK)
    # Both rooms lose their sides at x = 0; a frame of four parts around the hole stands there instead.
    walls = [
        Mesh(m.positions, m.triangles[np.abs(m.positions[m.triangles][..., 0]).max(axis=1) > 0], m.material)
        for m in (bright, dark)
    ]
    frame = [
        quad([(0, y0, z0), (0, y1, z0), (0, y1, z1), (0, y0, z1)], diffuse(0.0, two_sided=True))
        for y0, y1, z0, z1 in ((-1, -h, -1, 1), (h, 1, -1, 1), (-h, h, -1, -h), (-h, h, h, 1))
    ]
    solution = eclat.solve(Scene(meshes=(*walls, *frame), cameras=(CAMERA,)), eclat.Radiosity(patches=2000))
    behind = solution.corners[..., 0].mean(axis=1) > 1e-6
    arrives = float((solution.irradiance.mean(axis=1) * solution.areas)[behind].sum())
    assert arrives == pytest.approx(math.pi * hole**2, rel=0.03 if hole > 0.2 else 0.2)


def ball(radius: float, middle: tuple[float, float, float], material: Material) -> Mesh:
    """A ball of 960 triangles."""
    polar, around = np.meshgrid(np.linspace(0, math.pi, 17), np.linspace(0, 2 * math.pi, 33), indexing="ij")
    points = radius * np.stack(
        (np.sin(polar) * np.cos(around), np.cos(polar), -np.sin(polar) * np.sin(around)), axis=-1
    )
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    corners = np.concatenate([np.stack(t, axis=-2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))])
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    corners = corners[np.linalg.norm(normal, axis=1) > 1e-9] + np.array(middle)
    return Mesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), material)


def test_a_small_lamp_lights_a_room_by_a_hole_in_its_one_sided_ceiling() -> None:
    """Few rays of the lamp's small triangles go through the hole. A ball of area A and radiance L has the intensity A L / 4,
    and sends that times the solid angle of the hole into the room."""
    room = inner_sides((-1, -2, -1), (1, 0, 1), diffuse(0.0))
    top = room.positions[room.triangles][..., 1].min(axis=1) > -1e-6
    h, distance = 0.2, 0.5
    ceiling = [
        quad([(x0, 0, z0), (x1, 0, z0), (x1, 0, z1), (x0, 0, z1)], diffuse(0.0))
        for x0, x1, z0, z1 in ((-1, 1, -1, -h), (-1, 1, h, 1), (-1, -h, -h, h), (h, 1, -h, h))
    ]
    lamp = ball(0.1, (0.0, distance, 0.0), emitting(60.0))
    walls = Mesh(room.positions, room.triangles[~top], room.material)
    scene = Scene(meshes=(walls, *ceiling, lamp), cameras=(CAMERA,))
    corners = lamp.positions[lamp.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    solid_angle = 4 * math.asin(h * h / (h * h + distance * distance))
    solution = eclat.solve(scene, eclat.Radiosity(patches=1500), seed=1)
    inside = solution.corners[..., 1].max(axis=1) < 1e-6
    arrives = float((solution.irradiance[:, 0] * solution.areas)[inside].sum())
    assert arrives == pytest.approx(60.0 * area / 4 * solid_angle, rel=0.08)
