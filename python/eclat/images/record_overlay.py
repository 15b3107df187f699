# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The positions of records in a picture: the layer `record_density`, which `Image.show_records` draws."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.images.image import Image
from eclat.scene import Camera, FloatArray

DEPTH_TOLERANCE = 0.02
"""A record counts as visible up to this much (relative) behind what the pixel sees, since a pixel is not a point."""


def project(camera: Camera, points: FloatArray, size: tuple[int, int]) -> tuple[FloatArray, FloatArray]:
    """Raster positions (N, 2) in pixels, (0, 0) being the top left corner, and distances (N,) in metres.

    The inverse of the core's pinhole; NaN for points behind it. Distances are along the ray, of an orthographic
    camera from its plane.
    """
    width, height = size
    matrix = np.asarray(camera.to_world, dtype=np.float64)
    axes = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    local = (np.asarray(points, dtype=np.float64) - matrix[:3, 3]) @ axes
    ahead = np.where(local[:, 2] < 0, -local[:, 2], np.nan)
    if camera.projection == "orthographic":
        scale, distance = np.where(np.isnan(ahead), np.nan, 1.0), ahead
    else:
        scale, distance = ahead, np.where(np.isnan(ahead), np.nan, np.linalg.norm(local, axis=1))
    half_width, half_height = camera.half_extent(width / height)
    x = (local[:, 0] / scale / half_width + 1) / 2 - camera.shift[0]
    y = (1 - local[:, 1] / scale / half_height) / 2 - camera.shift[1]
    return np.stack([x * width, y * height], axis=1), distance


def visible_pixels(image: Image, camera: Camera, positions: FloatArray) -> NDArray[np.intp]:
    """(M, 2) columns and rows of those records that the picture's depth layer does not hide."""
    raster, distance = project(camera, positions, (image.width, image.height))
    inside = np.isfinite(raster).all(axis=1) & (raster >= 0).all(axis=1)
    inside &= (raster < (image.width, image.height)).all(axis=1)
    pixels = raster[inside].astype(np.intp)
    depth = image.layers.get("depth")
    if depth is None:
        return pixels
    return pixels[distance[inside] <= depth[pixels[:, 1], pixels[:, 0]] * (1 + DEPTH_TOLERANCE)]


def record_density(image: Image, camera: Camera, positions: FloatArray) -> NDArray[np.float32]:
    """(H, W): how many visible records lie in each pixel."""
    pixels = visible_pixels(image, camera, positions)
    density = np.zeros((image.height, image.width), dtype=np.float32)
    np.add.at(density, (pixels[:, 1], pixels[:, 0]), np.float32(1))
    return density
