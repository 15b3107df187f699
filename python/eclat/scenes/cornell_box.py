# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The Cornell box with the numbers of Mitsuba 3's `cornell_box()`: a room two metres wide, centred on the origin."""

from __future__ import annotations

import numpy as np

from eclat.scene import Camera, FloatArray, Material, Mesh, Scene, Value, rgb
from eclat.scenes.geometry import box

Matrix = tuple[tuple[float, float, float, float], ...]

WHITE = rgb(0.885809, 0.698859, 0.666422)
GREEN = rgb(0.105421, 0.37798, 0.076425)
RED = rgb(0.570068, 0.0430135, 0.0443706)
RADIANCE = rgb(18.387, 13.9873, 6.75357)

# Each matrix maps the square [−1, 1]² or the cube [−1, 1]³ to its place. The digits are those of Mitsuba 3, with its
# rounding errors.
A, B = 0.99999994, -4.37113883e-08
C, D = 0.189999998, -8.30516367e-09
LIGHT: Matrix = ((0.229999989, 0, 0, 0), (0, D, -C, 0.99), (0, C, D, 0.01))
FLOOR: Matrix = ((A, 0, 0, 0), (0, B, 1, -1), (0, -1, B, 0))
CEILING: Matrix = ((A, 0, 0, 0), (0, B, -1, 1), (0, 1, B, 0))
BACK: Matrix = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, -1))
GREEN_WALL: Matrix = ((B, 0, -1, 1), (0, A, 0, 0), (1, 0, B, 0))
RED_WALL: Matrix = ((B, 0, 1, -1), (0, A, 0, 0), (-1, 0, B, 0))
SMALL_BOX: Matrix = ((0.28689146, 0, -0.087711513, 0.335), (0, 0.3, 0, -0.7), (0.087711513, 0, 0.28689146, 0.38))
LARGE_BOX: Matrix = ((0.284909755, 0, 0.0939491391, -0.33), (0, 0.61, 0, -0.4), (-0.0939491391, 0, 0.284909755, -0.28))
CAMERA = ((1.0, 0, 0, 0), (0, A, 0, 0), (0, 0, A, 3.9), (0, 0, 0, 1))


def build() -> Scene:
    """Build the scene. All surfaces are diffuse; the camera has 512 × 512 pixels."""
    white = diffuse("white", WHITE)
    return room(floor=white, large_box=white, name="cornell-box")


def room(floor: Material, large_box: Material, name: str) -> Scene:
    """Build a Cornell box with the given materials of the floor and of the tall box; all other surfaces are
    one-sided."""
    white = diffuse("white", WHITE)
    meshes = (
        square("light", LIGHT, diffuse("light", WHITE, emission=RADIANCE)),
        square("floor", FLOOR, floor),
        square("ceiling", CEILING, white),
        square("back", BACK, white),
        square("green-wall", GREEN_WALL, diffuse("green", GREEN)),
        square("red-wall", RED_WALL, diffuse("red", RED)),
        cube("small-box", SMALL_BOX, white),
        cube("large-box", LARGE_BOX, large_box),
    )
    camera = Camera(np.array(CAMERA), fov=39.3077, fov_axis="smaller", size=(512, 512), name="camera")
    return Scene(meshes=meshes, cameras=(camera,), name=name)


def diffuse(name: str, reflectance: Value, emission: Value | None = None) -> Material:
    """Make a one-sided diffuse material."""
    return Material("diffuse", {"reflectance": reflectance}, name=name, two_sided=False, emission=emission)


def square(name: str, matrix: Matrix, material: Material) -> Mesh:
    """Make the square [−1, 1]² at z = 0, which faces +z, and transform it."""
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], dtype=np.float64)
    return Mesh(_transformed(corners, matrix), np.array([(0, 1, 2), (0, 2, 3)]), material, name=name)


def cube(name: str, matrix: Matrix, material: Material) -> Mesh:
    """Make the cube [−1, 1]³ and transform it."""
    solid = box((-1, -1, -1), (1, 1, 1))
    return Mesh(_transformed(solid.positions, matrix), solid.triangles, material, name=name)


def _transformed(points: FloatArray, matrix: Matrix) -> FloatArray:
    affine: FloatArray = np.array(matrix, dtype=np.float64)
    return points @ affine[:, :3].T + affine[:, 3]
