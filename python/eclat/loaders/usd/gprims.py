# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Make triangles of the geometric primitives: cubes, planes, spheres, cylinders, cones and capsules [UsdGeomGprim]."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.loaders.mitsuba import primitives
from eclat.loaders.usd.stages import Stage, pxr

Floats = NDArray[np.float64]

SEGMENTS = 64
"""The number of segments around a round primitive. The distance of a chord from the circle is 0.12 % of the radius."""
TYPES = ("Cube", "Plane", "Sphere", "Cylinder", "Cylinder_1", "Cone", "Capsule", "Capsule_1")
"""The types that `read_gprim` knows."""

_AXES = {"X": (1, 2, 0), "Y": (2, 0, 1), "Z": (0, 1, 2)}
"""By the axis of a primitive: the coordinates that the x, y and z of a shape along z become."""


@dataclass(frozen=True)
class Shape:
    """Triangles (T, 3), positions and unit normals (V, 3) in the primitive's own coordinates, counter-clockwise from outside."""

    positions: Floats
    normals: Floats
    triangles: NDArray[np.int64]


def read_gprim(stage: Stage, prim: Any) -> Shape:
    """Tessellate a primitive of one of the `TYPES`. Raises EclatError if a length is invalid."""
    geometry, kind = pxr("UsdGeom"), str(prim.GetTypeName())
    schema = getattr(geometry, kind)(prim)

    def length(name: str, default: float) -> float:
        value = stage.number(getattr(schema, f"Get{name}Attr")(), default)
        if not value >= 0:
            raise EclatError(f"{stage.where(prim)}: expected a length of at least 0 as {name.lower()}, got {value:g}")
        return value

    if kind == "Cube":
        cube = primitives.cube()
        return Shape(cube.positions * length("Size", 2) / 2, cube.normals, cube.triangles)
    if kind == "Sphere":
        ball = primitives.sphere(SEGMENTS)
        return Shape(ball.positions * length("Radius", 1), ball.normals, ball.triangles)
    if kind == "Plane":
        square = primitives.rectangle()
        # The width is along x for the axes Y and Z, and along z for X; the length is along z for Y, and along y for X and Z.
        axis = str(stage.value(schema.GetAxisAttr(), "Z"))
        width, depth = length("Width", 2) / 2, length("Length", 2) / 2
        sides = {"X": (depth, width, 1), "Y": (depth, width, 1), "Z": (width, depth, 1)}[axis]
        return _turned(Shape(square.positions * sides, square.normals, square.triangles), axis)
    height = length("Height", 1 if kind.startswith("Capsule") else 2)
    if kind.endswith("_1"):
        bottom, top = length("RadiusBottom", 0.5), length("RadiusTop", 0.5)
    else:
        bottom = length("Radius", 0.5 if kind == "Capsule" else 1)
        top = 0.0 if kind == "Cone" else bottom
    outline = _capsule if kind.startswith("Capsule") else _frustum
    return _turned(_lathe(outline(bottom, top, height)), str(stage.value(schema.GetAxisAttr(), "Z")))


def _turned(shape: Shape, axis: str) -> Shape:
    """Turn a shape along z to another axis."""
    order = list(np.argsort(_AXES[axis]))
    return Shape(shape.positions[:, order], shape.normals[:, order], shape.triangles)


Outline = list[tuple[Floats, Floats]]
"""Smooth pieces of an outline, bottom to top: positions (N, 2) as radius and z, and normals (N, 2)."""


def _frustum(bottom: float, top: float, height: float) -> Outline:
    """The outline of a cylinder or a cone, with its caps."""
    half = height / 2
    side = np.array([height, bottom - top], dtype=np.float64)
    side /= max(float(np.linalg.norm(side)), 1e-300)
    return [
        (np.array([[0, -half], [bottom, -half]]), np.tile([0.0, -1.0], (2, 1))),
        (np.array([[bottom, -half], [top, half]]), np.tile(side, (2, 1))),
        (np.array([[top, half], [0, half]]), np.tile([0.0, 1.0], (2, 1))),
    ]


def _capsule(bottom: float, top: float, height: float) -> Outline:
    """The outline of a capsule: two caps that touch a cone or a cylinder of the given height between their centres."""
    if abs(bottom - top) >= height > 0:
        bottom = top = max(bottom, top)
    # Where the radii differ, the side that touches both spheres is inclined, and one cap is more than a half sphere.
    tilt = math.asin((bottom - top) / height) if height > 0 else 0.0
    half, count = height / 2, SEGMENTS // 4
    lower = np.linspace(-math.pi / 2, tilt, count + 1)
    upper = np.linspace(tilt, math.pi / 2, count + 1)
    normals = [np.stack([np.cos(angles), np.sin(angles)], axis=1) for angles in (lower, upper)]
    positions = np.concatenate([normals[0] * bottom - [0, half], normals[1] * top + [0, half]])
    return [(positions, np.concatenate(normals))]


def _lathe(outline: Outline) -> Shape:
    """Turn an outline around the z axis."""
    angle = np.arange(SEGMENTS + 1) * (2 * math.pi / SEGMENTS)
    cos, sin = np.cos(angle), np.sin(angle)
    positions: list[Floats] = []
    normals: list[Floats] = []
    triangles: list[NDArray[np.int64]] = []
    first = 0
    for places, directions in outline:
        for source, target in ((places, positions), (directions, normals)):
            rings = np.stack(
                [
                    source[:, :1] * cos,
                    source[:, :1] * sin,
                    np.broadcast_to(source[:, 1:], (len(source), len(angle))),
                ],
                axis=-1,
            )
            target.append(rings.reshape(-1, 3))
        row, column = (part.ravel() for part in np.mgrid[0 : len(places) - 1, 0:SEGMENTS])
        a = first + row * (SEGMENTS + 1) + column
        b, c, d = a + 1, a + SEGMENTS + 2, a + SEGMENTS + 1
        triangles += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
        first += len(places) * (SEGMENTS + 1)
    whole = Shape(np.concatenate(positions), np.concatenate(normals), np.concatenate(triangles))
    corners = whole.positions[whole.triangles]
    doubled = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    # At the axis, one of the two triangles of each cell has no area.
    return Shape(whole.positions, whole.normals, whole.triangles[doubled > 1e-12 * doubled.max(initial=0)])
