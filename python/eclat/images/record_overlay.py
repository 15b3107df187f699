# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Compute the positions of records in an image, for the layer `record_density` that `Image.show_records` uses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.images.image import Image
from eclat.scene import Camera, FloatArray

DEPTH_TOLERANCE = 0.02
"""The largest relative distance of a record behind the visible surface at which it counts as visible. The depth varies
within a pixel, so that an exact comparison would fail."""


def project(camera: Camera, points: FloatArray, size: tuple[int, int]) -> tuple[FloatArray, FloatArray]:
    """Project points to the image, as the inverse of the rays of `camera`.

    Parameters
    ----------
    camera : the camera.
    points : (N, 3) points in world space.
    size : the width and the height of the image in pixels.

    Returns
    -------
    (N, 2) positions in pixels, where (0, 0) is the top left corner of the image, and (N,) distances along the ray in
    metres. The distances of an orthographic camera are measured from its plane. Points behind the camera have NaN.
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


def visible_places(image: Image, camera: Camera, positions: FloatArray) -> FloatArray:
    """Return where (M, 2) visible records are in the image, in pixels from its upper left corner.

    `positions` (N, 3) are the records. A record is hidden if it is behind the depth in the layer `depth` of the image.
    """
    raster, distance = project(camera, positions, (image.width, image.height))
    inside = np.isfinite(raster).all(axis=1) & (raster >= 0).all(axis=1)
    inside &= (raster < (image.width, image.height)).all(axis=1)
    places = raster[inside]
    depth = image.layers.get("depth")
    if depth is None:
        return places
    pixels = places.astype(np.intp)
    return places[distance[inside] <= depth[pixels[:, 1], pixels[:, 0]] * (1 + DEPTH_TOLERANCE)]


def record_density(image: Image, camera: Camera, positions: FloatArray) -> NDArray[np.float32]:
    """Return the number (H, W) of visible records in each pixel. `positions` (N, 3) are the records."""
    pixels = visible_places(image, camera, positions).astype(np.intp)
    density = np.zeros((image.height, image.width), dtype=np.float32)
    np.add.at(density, (pixels[:, 1], pixels[:, 0]), np.float32(1))
    return density
