# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lamps as Éclat's lights.

Blender gives the power P in watts as if every lamp sent it all over the sphere or, for areas, over the hemisphere. A point
or spot lamp has the intensity P / 4π on its axis; as a sphere of radius r, the radiance P / (4π² r²). An area A has the
radiance P / (π A). The strength of a sun is the irradiance that it causes. Measured with Cycles of Blender 5.0.1: a white
surface facing each lamp agrees within 0.1 %.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from eclat.scene import DirectionalLight, Material, Mesh, PointLight, SpotLight, Value, grey

from .notices import Notices

Light = PointLight | SpotLight | DirectionalLight

LAMP_SIDES, LAMP_RINGS = 32, 16
"""Meridians and rings of the sphere, and corners of the disc, that glow as lamps with a radius: its area is 1.3 % below that
of a sphere, which the radiance makes good."""

RAMP = 0.75
"""Width of Éclat's edge of a spot relative to Blender's. Over a ramp in the cosine, Blender's x² (3 − 2x) has the mean 1/2
and Éclat's x² the mean 1/3, counted from the outer edge. With 3/4 of the width both send the same light: 1 − 2/3 · 3/4 =
1 − 1/2."""


def lamp(light: Any, to_world: np.ndarray, name: str, notices: Notices) -> Light | Mesh | None:
    """Make the light of a lamp at `to_world` (4×4); lamps with a size become meshes that glow. None is a dark lamp."""
    where = f"light {name!r}"
    r, g, b = _color(light, where, notices)
    power = float(light.energy) * 2.0 ** float(getattr(light, "exposure", 0.0))
    if power * max(r, g, b) <= 0:
        return None
    if not getattr(light, "normalize", True):
        power *= _area(light, to_world)
    if not light.use_shadow:
        notices.add(where, "it casts shadows, although they are switched off")
    watts = np.array((r, g, b)) * power
    x, y, z = (float(v) for v in to_world[:3, 3])
    kind = light.type
    if kind == "SUN":
        return DirectionalLight(_axis(to_world), _triple(watts), math.degrees(light.angle) / 2)
    if kind == "POINT" and light.shadow_soft_size > 0:
        return _sphere(watts, (x, y, z), float(light.shadow_soft_size), name)
    if kind == "POINT":
        return PointLight((x, y, z), _triple(watts / (4 * math.pi)))
    if kind == "SPOT":
        if light.shadow_soft_size > 0:
            notices.add(where, "its radius is not supported, so that its shadows are sharp")
        inner, outer = spot_angles(light.spot_size, light.spot_blend)
        return SpotLight((x, y, z), _axis(to_world), _triple(watts / (4 * math.pi)), inner, outer, "smooth")
    if light.spread < math.pi - 1e-4:
        notices.add(where, "its spread is not supported; it emits in all directions of its front")
    return _rectangle(light, watts, to_world, name)


def spot_angles(size: float, blend: float) -> tuple[float, float]:
    """Compute the inner and the outer angle in degrees of a spot lamp whose cone is `size` radians wide, and whose edge
    takes the share `blend` of 1 − cos(size / 2)."""
    outer = size / 2
    width = RAMP * blend * (1 - math.cos(outer))
    inner = math.acos(min(1.0, math.cos(outer) + width))
    return math.degrees(inner), math.degrees(outer)


def _color(light: Any, where: str, notices: Notices) -> tuple[float, float, float]:
    color = np.array(light.color[:3], float)
    if getattr(light, "use_temperature", False):
        color = color * np.array(light.temperature_color[:3], float)
    tree = light.node_tree if getattr(light, "use_nodes", False) else None
    if tree is not None:
        color = color * _emission(tree, where, notices)
    r, g, b = (float(v) for v in color)
    return r, g, b


def _emission(tree: Any, where: str, notices: Notices) -> np.ndarray:
    """The colour times the strength of the Emission node of a lamp, if both are constant."""
    node = next((node for node in tree.nodes if node.type == "EMISSION"), None)
    if node is None:
        return np.ones(3)
    if any(node.inputs[name].is_linked for name in ("Color", "Strength")):
        notices.add(where, "its nodes are not supported; colour and power alone are used")
        return np.ones(3)
    return np.array(node.inputs["Color"].default_value[:3]) * node.inputs["Strength"].default_value


def _area(light: Any, to_world: np.ndarray) -> float:
    if light.type == "AREA":
        width, height, round_ = _extent(light)
        scale = np.linalg.norm(to_world[:3, :2], axis=0)
        return float(width * height * scale[0] * scale[1] * (math.pi / 4 if round_ else 1))
    if light.type in ("POINT", "SPOT"):
        radius = float(light.shadow_soft_size)
        return 4 * math.pi * radius**2 if radius > 0 else 1.0
    return math.pi * math.tan(light.angle / 2) ** 2 if light.angle > 0 else 1.0


def _extent(light: Any) -> tuple[float, float, bool]:
    both = light.shape in ("RECTANGLE", "ELLIPSE")
    return float(light.size), float(light.size_y if both else light.size), light.shape in ("DISK", "ELLIPSE")


def _glow(radiance: np.ndarray, name: str) -> Material:
    """A black surface that emits on its front, and that is not there from behind."""
    return Material(
        "diffuse", {"reflectance": grey(0)}, name, two_sided=False, back_culled=True, emission=Value(_triple(radiance))
    )


def _rectangle(light: Any, watts: np.ndarray, to_world: np.ndarray, name: str) -> Mesh | None:
    width, height, is_round = _extent(light)
    if is_round:
        turn = 2 * math.pi * np.arange(LAMP_SIDES) / LAMP_SIDES
        edge = np.column_stack((np.cos(turn) * width / 2, np.sin(turn) * height / 2, 0 * turn))
    else:
        edge = np.array([(sx * width / 2, sy * height / 2, 0) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    world = edge @ to_world[:3, :3].T + to_world[:3, 3]
    fan = np.array([(0, k + 1, k) for k in range(1, len(edge) - 1)])  # Lamps look along −z.
    if np.linalg.det(to_world[:3, :3]) < 0:
        fan = fan[:, ::-1]
    a, b, c = (world[fan[:, k]] for k in range(3))
    area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
    if area <= 0:
        return None
    return Mesh(world, fan, _glow(watts / (math.pi * area), name), name=name)


def _sphere(watts: np.ndarray, center: tuple[float, float, float], radius: float, name: str) -> Mesh:
    polar = math.pi * np.arange(LAMP_RINGS + 1) / LAMP_RINGS
    turn = 2 * math.pi * np.arange(LAMP_SIDES) / LAMP_SIDES
    p, t = np.meshgrid(polar, turn, indexing="ij")
    ring = np.stack((np.sin(p) * np.cos(t), np.sin(p) * np.sin(t), np.cos(p)), axis=-1).reshape(-1, 3)
    triangles = []
    for i in range(LAMP_RINGS):
        for k in range(LAMP_SIDES):
            a, b = i * LAMP_SIDES + k, i * LAMP_SIDES + (k + 1) % LAMP_SIDES
            c, d = a + LAMP_SIDES, b + LAMP_SIDES
            triangles += [(a, c, d)] if i == 0 else [(a, c, b)] if i == LAMP_RINGS - 1 else [(a, c, d), (a, d, b)]
    faces = np.array(triangles)
    positions = np.array(center) + radius * ring
    corners = positions[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    return Mesh(positions, faces, _glow(watts / (math.pi * area), name), name=name)


def _axis(to_world: np.ndarray) -> tuple[float, float, float]:
    axis = -to_world[:3, 2]
    return _triple(axis / np.linalg.norm(axis))


def _triple(values: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z
