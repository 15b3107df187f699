# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Checks of the arguments that several verbs share. Each function returns the value to use or raises EclatError."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from eclat.errors import EclatError, shown
from eclat.images.image import check_size
from eclat.scene import Camera, FloatArray, Scene

DEFAULT_SIZE = (1280, 720)
"""Size of a picture in pixels if neither the caller nor the camera gives one."""
MAX_SAMPLES = 1 << 24
"""Largest number of samples per pixel or per point."""
MAX_ERROR_RANGE = (0.0005, 0.5)
"""Smallest and largest relative error that can be requested of records and pictures."""


def chosen_camera(scene: Scene, camera: int | Camera) -> Camera:
    """Return `camera` itself, or the camera of the scene with that index."""
    if isinstance(camera, Camera):
        return camera
    if not 0 <= camera < len(scene.cameras):
        limit = f"an index from 0 and below {len(scene.cameras)}, the number of cameras of {scene.name or 'the scene'}"
        raise EclatError(f"camera: expected {limit}, got {camera}")
    return scene.cameras[camera]


def picture_size(camera: Camera, size: tuple[int, int] | None) -> tuple[int, int]:
    """Return the requested width and height in pixels; by default they are those of the camera or, if it has none,
    `DEFAULT_SIZE`.
    """
    width, height = size or camera.size or DEFAULT_SIZE
    check_size(width, height)
    return int(width), int(height)


def checked_crop(crop: tuple[int, int, int, int] | None, width: int, height: int) -> tuple[int, int, int, int]:
    """Return the crop (x0, y0, x1, y1) in pixels, x1 and y1 exclusive; None means the whole picture."""
    if crop is None:
        return (0, 0, width, height)
    x0, y0, x1, y1 = crop
    if not (0 <= x0 < x1 <= width and 0 <= y0 < y1 <= height):
        raise EclatError(
            f"crop must be a rectangle x0, y0, x1, y1 inside the picture of {width}x{height} pixels, got {crop}"
        )
    return (x0, y0, x1, y1)


def checked_seed(seed: int) -> int:
    """Return the seed, a number of 32 bits."""
    if not 0 <= seed < 2**32:
        raise EclatError(f"seed must be between 0 and {2**32 - 1}, got {seed}")
    return seed


def thread_count(threads: int | None) -> int:
    """Return the number of threads for the core, where 0 means all processors."""
    if threads is None:
        return 0
    if not 1 <= threads <= 1024:
        raise EclatError(f"threads must be between 1 and 1024, got {threads}")
    return threads


def checked_samples(samples: int) -> int:
    """Return the number of samples per pixel or per point."""
    if not 1 <= samples <= MAX_SAMPLES:
        raise EclatError(f"samples must be between 1 and {MAX_SAMPLES}, got {samples}")
    return samples


def checked_max_error(max_error: float) -> float:
    """Return the wanted relative error, which must be within `MAX_ERROR_RANGE`."""
    low, high = MAX_ERROR_RANGE
    if not low <= max_error <= high:
        raise EclatError(f"max_error must be between {low:g} and {high:g}, got {max_error}")
    return max_error


def checked_max_depth(max_depth: int) -> int:
    """Return the greatest number of edges of a path: −1 (no limit) or at least 1."""
    if max_depth == 0 or max_depth < -1:
        raise EclatError(f"max_depth must be -1 (unlimited) or at least 1, got {max_depth}")
    if max_depth >= 2**31:
        raise EclatError(f"max_depth must be below {2**31}, got {max_depth}")
    return max_depth


def checked_time(time: float | None) -> float | None:
    """Return the time limit in seconds, which must be above 0, or None if there is no limit."""
    if time is not None and not (math.isfinite(time) and time > 0):
        raise EclatError(f"time must be a finite number of seconds above 0, got {time}")
    return time


def points_with_normals(points: ArrayLike, normals: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return points (N, 3) and unit normals (N, 3), both float64; N may be 0."""
    places, directions = _rows("points", points), _rows("normals", normals)
    if places.shape != directions.shape or places.ndim != 2 or (places.size and places.shape[1] != 3):
        raise EclatError(f"points and normals must both be (N, 3), got {places.shape} and {directions.shape}")
    places, directions = places.reshape(-1, 3), directions.reshape(-1, 3)
    lengths = np.linalg.norm(directions, axis=1)
    bad = ~np.isfinite(places).all(axis=1) | ~np.isfinite(lengths) | (lengths == 0)
    if bad.any():
        row = int(np.argmax(bad))
        raise EclatError(
            f"points and normals must be finite, and normals must not be zero; "
            f"got the point {places[row].tolist()} with the normal {directions[row].tolist()} at index {row}"
        )
    return places, directions / lengths[:, None]


def _rows(name: str, values: object) -> FloatArray:
    try:
        with np.errstate(all="ignore"):
            return np.atleast_2d(np.asarray(values, np.float64))
    except (TypeError, ValueError, OverflowError):
        raise EclatError(f"{name}: expected an array of numbers, got {shown(values)}") from None
