# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read cameras [UsdGeomCamera]. Apertures and focal lengths are in tenths of the unit of length."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.loaders.usd.stages import Stage, pxr
from eclat.scene import Camera

HEIGHT = 720
"""The height of the picture in pixels. A camera has apertures only, and 720 is a usual height of videos."""
MAX_ASPECT = 16.0
"""The largest aspect ratio, and the inverse of the smallest one. Other ratios are probably mistakes."""


def read_camera(stage: Stage, prim: Any, to_world: NDArray[np.float64]) -> Camera:
    """Read a camera. Its clipping planes, its shutter and its exposure are ignored.

    Parameters
    ----------
    to_world : 4×4, in metres, and with the scale of the unit of length, as for meshes.

    Raises
    ------
    EclatError : an aperture or the focal length is invalid, or the transform is singular.
    """
    camera, where = pxr("UsdGeom").Camera(prim), stage.where(prim)
    width = stage.number(camera.GetHorizontalApertureAttr(), 20.955)
    height = stage.number(camera.GetVerticalApertureAttr(), 15.2908)
    length = stage.number(camera.GetFocalLengthAttr(), 50.0)
    if not (width > 0 and height > 0 and 1 / MAX_ASPECT <= width / height <= MAX_ASPECT):
        raise EclatError(f"{where}: expected apertures above 0 of a usual ratio, got {width:g} and {height:g}")
    across = stage.number(camera.GetHorizontalApertureOffsetAttr(), 0.0)
    up = stage.number(camera.GetVerticalApertureOffsetAttr(), 0.0)
    rotation, unit = _rigid(to_world, where)
    flat = stage.value(camera.GetProjectionAttr(), "perspective") == "orthographic"
    if not flat and not length > 0:
        raise EclatError(f"{where}: expected a focal length above 0, got {length:g}")
    stop, focus = stage.number(camera.GetFStopAttr(), 0.0), stage.number(camera.GetFocusDistanceAttr(), 0.0)
    blurs = not flat and stop > 0 and focus > 0
    return Camera(
        rotation,
        fov=width / 10 * unit if flat else math.degrees(2 * math.atan2(width / 2, length)),
        fov_axis="x",
        projection="orthographic" if flat else "perspective",
        aperture_radius=length / 10 * unit / stop / 2 if blurs else 0.0,
        focus_distance=focus * unit if blurs else 1.0,
        size=(max(round(HEIGHT * width / height), 1), HEIGHT),
        shift=(across / width, -up / height),
        name=prim.GetName(),
    )


def _rigid(to_world: NDArray[np.float64], where: str) -> tuple[NDArray[np.float64], float]:
    """Return the transform without its scale, and the scale along the view, in metres for each unit of the camera."""
    right, up, backward = to_world[:3, :3].T
    axes = [backward, up - backward * (up @ backward) / max(float(backward @ backward), 1e-300)]
    lengths = [float(np.linalg.norm(axis)) for axis in axes]
    if not min(lengths) > 0:
        raise EclatError(f"{where}: expected a camera with a viewing direction, but its transform has the scale 0")
    z, y = (axis / length for axis, length in zip(axes, lengths, strict=True))
    x = np.cross(y, z)
    result = np.eye(4)
    result[:3, :3] = np.column_stack((x if x @ right >= 0 else -x, y, z))
    result[:3, 3] = to_world[:3, 3]
    return result, lengths[0]
