# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's cameras, and the view of a viewport, as Éclat's cameras."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from eclat.errors import EclatError
from eclat.scene import Camera

from .notices import Notices

MILLIMETRE = 1e-3


def scene_camera(camera: Any, to_world: np.ndarray, size: tuple[int, int], notices: Notices) -> Camera:
    """Make the camera of Blender's camera data at `to_world` (4×4), for a picture of `size` (width, height).

    Raises EclatError if its projection is a panorama.
    """
    where = f"camera {camera.name!r}"
    if camera.type not in ("PERSP", "ORTHO"):
        raise EclatError(f"{where}: expected a perspective or orthographic camera, got {camera.type.lower()}")
    fit = fitted_axis(camera.sensor_fit, size)
    if camera.type == "ORTHO":
        extent, projection = float(camera.ortho_scale), "orthographic"
    else:
        sensor = camera.sensor_height if camera.sensor_fit == "VERTICAL" else camera.sensor_width
        extent, projection = math.degrees(2 * math.atan(sensor / (2 * camera.lens))), "perspective"
    radius, distance = _focus(camera, to_world, where, notices)
    return Camera(
        _rigid(to_world),
        extent,
        fit,
        projection,
        radius,
        distance,
        size,
        _shift(camera, fit, size),
        camera.name,
    )


def fitted_axis(sensor_fit: str, size: tuple[int, int]) -> str:
    """Return the axis, "x" or "y", along which the sensor fills the picture."""
    if sensor_fit == "AUTO":
        return "x" if size[0] >= size[1] else "y"
    return "x" if sensor_fit == "HORIZONTAL" else "y"


def view_camera(view: np.ndarray, window: np.ndarray, size: tuple[int, int]) -> Camera:
    """Make the camera of a viewport from its matrices `view` (world to eye) and `window` (eye to clip space), both 4×4."""
    eye, height = _rigid(np.linalg.inv(view)), float(window[1, 1])
    perspective = window[3, 3] == 0  # In a perspective, clip space is divided by the depth.
    if perspective:
        middle = -window[:2, 2]
        extent = math.degrees(2 * math.atan(1 / height))
    else:
        middle = window[:2, 3]
        extent = 2 / height
        # A viewport without perspective also shows what lies behind its eye, so the camera stands at its near plane.
        eye[:3, 3] -= eye[:3, 2] * min(0.0, float((1 + window[2, 3]) / window[2, 2]))
    # The axis meets the picture at `middle`, in clip space with y upwards, where the picture is 2 wide and 2 high. The
    # coordinates of pixels move the other way.
    shift = (-float(middle[0]) / 2, float(middle[1]) / 2)
    projection: Any = "perspective" if perspective else "orthographic"
    return Camera(eye, extent, "y", projection, size=size, shift=shift, name="viewport")


def _shift(camera: Any, fit: str, size: tuple[int, int]) -> tuple[float, float]:
    """Blender shifts the frame by a part of the fitted side of the picture, right and up; Éclat's shift is added to the
    coordinates of pixels, right and down, in parts of their own sides."""
    side = size[0] if fit == "x" else size[1]
    return camera.shift_x * side / size[0], -camera.shift_y * side / size[1]


def _focus(camera: Any, to_world: np.ndarray, where: str, notices: Notices) -> tuple[float, float]:
    """Return the radius of the aperture and the distance of focus in metres."""
    dof = camera.dof
    if not dof.use_dof:
        return 0.0, 1.0
    if dof.aperture_blades > 0 or abs(dof.aperture_ratio - 1) > 1e-6:
        notices.add(where, "the shape of its aperture is not supported; it is round")
    distance = float(dof.focus_distance)
    if dof.focus_object is not None:
        target = np.array(dof.focus_object.matrix_world, float)[:3, 3]
        rigid = _rigid(to_world)
        distance = abs(float((target - rigid[:3, 3]) @ rigid[:3, 2]))
    opening = camera.lens * MILLIMETRE if camera.type == "PERSP" else 1.0
    return opening / (2 * max(float(dof.aperture_fstop), 1e-5)), max(distance, 1e-5)


def _rigid(to_world: np.ndarray) -> np.ndarray:
    """Return the transform without its scale, which cameras do not have."""
    rigid = np.eye(4)
    axes = to_world[:3, :3]
    rigid[:3, :3] = axes / np.linalg.norm(axes, axis=0)
    rigid[:3, 3] = to_world[:3, 3]
    return rigid
