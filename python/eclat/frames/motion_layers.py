# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Layers for compositors: which object each pixel shows, and where its place on that object is in the next and in the
previous frame.

They hold for the first surface behind the centre of a pixel, also if it is glass or a mirror, seen through a pinhole.
Symbol   name here    meaning                                                     unit
  P      places       the point of the surface that the pixel shows               m
  P'     there        the same point of the surface at the other time             m
  x, y   columns      its place in the other frame, y downwards                   pixel
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eclat.bridge.anchors import Numbers, barycentric, corners_of, first_triangles, meshes_of
from eclat.scene import Camera, Scene

Layer = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Moment:
    """A scene and its camera at one time. All moments of one scene have the same meshes in the same order."""

    scene: Scene
    camera: Camera


def motion_layers(
    now: Moment, previous: Moment, following: Moment, size: tuple[int, int], threads: int
) -> dict[str, Layer]:
    """Compute the layers of a frame of `size` (width, height).

    Returns
    -------
    `object_id`, (H, W): the number of the mesh in the scene, from 1, or 0 where the pixel shows none. `motion_next` and
    `motion_previous`, (H, W, 3): by how many pixels to the right and downwards the place that the pixel shows lies
    elsewhere in the other frame, and by how many metres farther from the camera; 0 where the camera cannot see it then.
    What is infinitely far moves with the turns of the camera alone.
    """
    width, height = size
    origins, directions = pixel_rays(now.camera, size)
    hit = first_triangles(now.scene, origins, directions, threads, from_camera=True)
    meshes, triangles = meshes_of(now.scene, hit)
    corners = corners_of(now.scene, now.scene, meshes, triangles)
    shares = barycentric(corners, origins, directions)
    places = _places(corners, shares, meshes, directions)
    # These are the centres of the pixels. Computed like those of the other frame, what rests has a motion of exactly 0.
    start = _projected(now.camera, places, meshes, size)
    layers: dict[str, Layer] = {"object_id": (meshes + 1).reshape(height, width).astype(np.float32)}
    for name, other in (("motion_next", following), ("motion_previous", previous)):
        there = _places(corners_of(now.scene, other.scene, meshes, triangles), shares, meshes, directions)
        moved = _projected(other.camera, there, meshes, size) - start
        moved[meshes < 0, 2] = 0
        moved[~np.isfinite(moved).all(axis=1)] = 0
        layers[name] = moved.reshape(height, width, 3).astype(np.float32)
    return layers


def pixel_rays(camera: Camera, size: tuple[int, int]) -> tuple[Numbers, Numbers]:
    """Return the origins and directions, (H · W, 3) each, of the rays through the centres of the pixels, row by row, as
    `core/scene/camera.h` makes them for a pinhole.
    """
    width, height = size
    half_width, half_height = camera.half_extent(width / height)
    matrix = np.asarray(camera.to_world, np.float64)
    right, up, backward = (matrix[:3, i] / np.linalg.norm(matrix[:3, i]) for i in range(3))
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    sx = (2 * (x.ravel() + camera.shift[0]) - 1) * half_width
    sy = (1 - 2 * (y.ravel() + camera.shift[1])) * half_height
    aside = sx[:, None] * right + sy[:, None] * up
    if camera.projection == "orthographic":
        return matrix[:3, 3] + aside, np.tile(-backward, (len(aside), 1))
    directions = aside - backward
    return np.tile(matrix[:3, 3], (len(aside), 1)), directions / np.linalg.norm(directions, axis=1, keepdims=True)


def _projected(camera: Camera, places: Numbers, meshes: NDArray[np.int64], size: tuple[int, int]) -> Numbers:
    """Return the column, the row and the distance (N, 3) at which a camera sees places. Where `meshes` is −1, `places` are
    directions to what is infinitely far. Places behind the camera become NaN.
    """
    width, height = size
    half_width, half_height = camera.half_extent(width / height)
    matrix = np.asarray(camera.to_world, np.float64)
    axes = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    relative = np.where((meshes >= 0)[:, None], places - matrix[:3, 3], places)
    seen = relative @ axes
    far = -seen[:, 2]
    with np.errstate(all="ignore"):
        scale = np.ones_like(far) if camera.projection == "orthographic" else np.where(far > 0, far, np.nan)
        x = (seen[:, 0] / scale / half_width + 1) / 2 - camera.shift[0]
        y = (1 - seen[:, 1] / scale / half_height) / 2 - camera.shift[1]
    distance = far if camera.projection == "orthographic" else np.linalg.norm(seen, axis=1)
    return np.column_stack([x * width, y * height, distance])


def _places(corners: Numbers, shares: Numbers, meshes: NDArray[np.int64], directions: Numbers) -> Numbers:
    on_surface: Numbers = np.einsum("nc,nci->ni", shares, corners)
    return np.where((meshes >= 0)[:, None], on_surface, directions)
