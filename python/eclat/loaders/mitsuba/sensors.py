# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Convert sensors to cameras."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np

from eclat.errors import EclatError, did_you_mean, warn
from eclat.loaders.mitsuba.kinds import PLUGINS
from eclat.loaders.mitsuba.node import Node, parse_number
from eclat.loaders.mitsuba.transforms import Matrix, is_singular, normalize
from eclat.scene import Camera

_SUPPORTED = ("perspective", "thinlens", "orthographic")
_FOV_AXES = ("x", "y", "diagonal", "smaller", "larger")
_FILM_DIAGONAL = math.hypot(36.0, 24.0)
"""The diagonal in millimetres of 35 mm film (36 mm × 24 mm), which `focal_length` refers to."""
_MAX_SIZE = 10**6
"""The largest width and height of an image in pixels."""


def make_camera(node: Node) -> Camera | None:
    """Convert a sensor to a camera, or return None, with a warning, if the type of the sensor is not supported.

    Raises
    ------
    EclatError : the transform is singular, the field of view is not between 0° and 180°, or another number is out of
        range.
    """
    if node.type not in _SUPPORTED:
        near = did_you_mean(node.type, _SUPPORTED) if node.type not in PLUGINS["sensor"] else ""
        warn(f"{node.where}: the sensor type {node.type!r} is not supported{near}; the sensor is left out")
        return None
    if is_singular(node.transform("to_world")):
        raise EclatError(f"{node.where}, to_world: expected an invertible matrix, got a singular one")
    options: dict[str, Any] = {"to_world": _frame(node), "size": _film_size(node), "name": node.id}
    options["shift"] = (
        node.number("principal_point_offset_x", default=0.0),
        node.number("principal_point_offset_y", default=0.0),
    )
    if node.type == "orthographic":
        # The image is 2 units wide in the coordinates of the sensor.
        width = 2 * float(np.linalg.norm(node.transform("to_world")[:3, 0]))
        return Camera(projection="orthographic", fov=width, fov_axis="x", **options)
    options |= _field_of_view(node)
    if node.type == "thinlens":
        options["aperture_radius"] = max(node.number("aperture_radius", default=0.0), 0.0)
        options["focus_distance"] = node.positive("focus_distance", default=node.number("far_clip", default=1e4))
    return Camera(**options)


def up_axis(camera: Camera) -> tuple[float, float, float]:
    """Return the direction among ±x, ±y and ±z in world space that is nearest to the up vector of `camera`."""
    up = np.asarray(camera.to_world)[:3, 1]
    index = int(np.argmax(np.abs(up)))
    x, y, z = (float(np.copysign(1.0, up[index])) if i == index else 0.0 for i in range(3))
    return x, y, z


def _frame(node: Node) -> Matrix:
    """Return the matrix (4, 4) from the coordinates of Éclat's camera to world space, without scale.

    In Mitsuba, a camera looks along +z, and +x points to the left of the image. In Éclat, it looks along −z, and +x
    points to the right.
    """
    matrix = node.transform("to_world").copy()
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    if node.type != "orthographic" and not np.allclose(lengths, 1, rtol=1e-3):
        warn(f"{node.where}, to_world: the scale of a camera's transform is ignored")
    if node.type == "orthographic" and not np.isclose(lengths[0], lengths[1], rtol=1e-3):
        warn(f"{node.where}, to_world: different scales in x and y are not supported; the scale in x is used")
    matrix[:3, :3] = normalize(matrix[:3, :3].T).T
    if not np.allclose(matrix[:3, :3].T @ matrix[:3, :3], np.eye(3), atol=1e-3):
        warn(f"{node.where}, to_world: the camera's axes are not perpendicular, so the image is sheared")
    return matrix @ np.diag([-1.0, 1.0, -1.0, 1.0])


def _field_of_view(node: Node) -> dict[str, Any]:
    if node.get("fov") is None:
        text = node.string("focal_length", default="50mm").strip().lower().removesuffix("mm")
        focal = parse_number(text, f"{node.where}, focal_length")
        if focal <= 0:
            raise node.mismatch("focal_length", "a length above 0 mm", text)
        return {"fov": math.degrees(2 * math.atan(_FILM_DIAGONAL / 2 / focal)), "fov_axis": "diagonal"}
    fov = node.number("fov", default=50.0)
    if not 0 < fov < 180:
        raise node.mismatch("fov", "an angle between 0 and 180 degrees", fov)
    axis = node.string("fov_axis", default="x").strip().lower()
    if axis not in _FOV_AXES:
        raise node.mismatch("fov_axis", f"one of {', '.join(_FOV_AXES)}", axis)
    return {"fov": fov, "fov_axis": cast(Any, axis)}


def _film_size(node: Node) -> tuple[int, int]:
    films = [child for _, child in node.of_tag("film")]
    if not films:
        return 768, 576
    film = films[0]
    width, height = film.integer("width", default=768), film.integer("height", default=576)
    if not (1 <= width <= _MAX_SIZE and 1 <= height <= _MAX_SIZE):
        raise EclatError(
            f"{film.where}: expected a width and a height of 1 to {_MAX_SIZE} pixels, got {width} × {height}"
        )
    if any(film.get(name) is not None for name in ("crop_width", "crop_height", "crop_offset_x", "crop_offset_y")):
        warn(f"{film.where}: the crop window of the film is ignored")
    for name in sorted(film.properties.keys() - film.asked):
        # The film has many other properties, such as those of files, which do not change the picture.
        if suggestion := did_you_mean(name, ("width", "height")):
            warn(f"{film.where}: the property {name!r} is not known and is ignored{suggestion}")
    return width, height
