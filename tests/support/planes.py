# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A square in the plane z = 0 under one parallel light, seen from straight above: what it shines is known exactly."""

from __future__ import annotations

import numpy as np

import eclat
from eclat.scene import Camera, DirectionalLight, FloatArray, Material, Mesh, Scene, look_at

IRRADIANCE = 3.0

CORNERS = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float64)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
# The image lies on the square upright: u grows along +x, v (downwards in the image) along −y.
UPRIGHT = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], dtype=np.float64)


def unit(*v: float) -> FloatArray:
    a = np.array(v, dtype=np.float64)
    return a / np.linalg.norm(a)


def rotation_to(normal: FloatArray) -> FloatArray:
    """The 3×3 rotation about a horizontal axis that takes +z to `normal`."""
    axis = np.cross([0, 0, 1], normal)
    sine, cosine = float(np.linalg.norm(axis)), float(normal[2])
    if sine == 0:
        return np.eye(3)
    x, y, z = axis / sine
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sine * k + (1 - cosine) * k @ k


def square(material: Material, *, uvs: FloatArray = UPRIGHT, **arrays: FloatArray) -> Mesh:
    """The square [−1, 1]², facing +z; `arrays` are further fields of `Mesh`."""
    return Mesh(CORNERS, TRIANGLES, material, uvs=uvs, **arrays)


def seen_from_above(mesh: Mesh, towards_light: FloatArray, *, width: float = 0.02, side: float = 1.0) -> Scene:
    """`mesh` under a parallel light of IRRADIANCE, an orthographic camera above the origin (below with `side` −1)."""
    x, y, z = (-np.asarray(towards_light)).tolist()
    camera = Camera(look_at((0, 0, 5 * side), (0, 0, 0)), fov=width, projection="orthographic")
    return Scene((mesh,), (DirectionalLight((x, y, z), (IRRADIANCE,) * 3),), None, (camera,))


def shine(scene: Scene, size: tuple[int, int] = (1, 1), samples: int = 1) -> np.ndarray:
    """Direct light, (H, W, 3)."""
    return eclat.render(scene, eclat.Direct(), size=size, samples=samples).pixels
