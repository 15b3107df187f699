# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read perspective and orthographic cameras [glTF 2.0, 3.10]."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.gltf.element import Element
from eclat.scene import Camera

HEIGHT = 720
"""The height of the image in pixels. A glTF camera only has an aspect ratio, and 720 is a usual height of videos."""

MAX_ASPECT = 16.0
"""The largest aspect ratio, and the inverse of the smallest one. Other ratios are probably mistakes and are ignored."""


def read_camera(camera: Element, to_world: NDArray[np.float64], name: str) -> Camera:
    """Read a camera. Its clipping planes are ignored.

    Parameters
    ----------
    camera : the element of the camera.
    to_world : the 4×4 transform of the node that it belongs to.
    name : the name of the camera.

    Raises
    ------
    EclatError : the type is unknown, a number is out of range, or the transform is singular.
    """
    kind = camera.text("type")
    if kind not in ("perspective", "orthographic"):
        raise EclatError(f"{camera.at('type')}: expected perspective or orthographic, got {kind[:20]!r}")
    lens = camera.child(kind)
    if lens is None:
        raise EclatError(f"{camera.where}: expected an object as {kind!r}, but it is missing")
    projection: Literal["perspective", "orthographic"]
    if kind == "perspective":
        projection, fov = "perspective", math.degrees(lens.number("yfov"))
        aspect = lens.number("aspectRatio", 0.0)
        if not 0 < fov < 180:
            raise EclatError(
                f"{lens.at('yfov')}: expected an angle between 0 and π radians, got {lens.number('yfov'):g}"
            )
    else:
        projection, fov = "orthographic", 2 * abs(lens.number("ymag"))
        aspect = 2 * abs(lens.number("xmag")) / fov if fov > 0 else 0.0
        if not aspect > 0:
            raise EclatError(f"{lens.where}: expected nonzero xmag and ymag, got 0")
    return Camera(_rigid(to_world, camera), fov, "y", projection, size=_size(lens, aspect), name=name)


def _size(lens: Element, aspect: float) -> tuple[int, int] | None:
    if aspect == 0:
        return None
    if not 1 / MAX_ASPECT <= aspect <= MAX_ASPECT:
        warn(
            f"{lens.where}: expected an aspect ratio in {1 / MAX_ASPECT:g}..{MAX_ASPECT:g}, got {aspect:g}; it is ignored"
        )
        return None
    return max(round(HEIGHT * aspect), 1), HEIGHT


def _rigid(to_world: NDArray[np.float64], camera: Element) -> NDArray[np.float64]:
    """Return the transform of a node without its scale, which the specification excludes. A reflection is kept."""
    right, up, backward = to_world[:3, :3].T
    axes = [backward, up - backward * (up @ backward) / max(float(backward @ backward), 1e-300)]
    lengths = [float(np.linalg.norm(axis)) for axis in axes]
    if not min(lengths) > 0:
        raise EclatError(
            f"{camera.where}: expected a camera with a viewing direction, but the transform of its node has the scale 0"
        )
    z, y = (axis / length for axis, length in zip(axes, lengths, strict=True))
    x = np.cross(y, z)
    result = np.eye(4)
    result[:3, :3] = np.column_stack((x if x @ right >= 0 else -x, y, z))
    result[:3, 3] = to_world[:3, 3]
    return result
