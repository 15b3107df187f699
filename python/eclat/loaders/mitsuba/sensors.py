# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Makes cameras of the sensors in the tree."""

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
"""Millimetres, of the film that `focal_length` refers to."""
_MAX_SIZE = 10**6


def make_camera(node: Node) -> Camera | None:
    """The camera of a sensor; None, with a warning, if its type is not supported.

    Raises
    ------
    EclatError : a transform that flattens space, angles outside 0..180°, and other numbers that make no sense.
    """
    if node.type not in _SUPPORTED:
        near = did_you_mean(node.type, _SUPPORTED) if node.type not in PLUGINS["sensor"] else ""
        warn(f"{node.where}: a sensor of a type that is not supported{near}; left out")
        return None
    if is_singular(node.transform("to_world")):
        raise EclatError(f"{node.where}, to_world: expected a camera's frame, got a matrix that flattens space")
    options: dict[str, Any] = {"to_world": _frame(node), "size": _film_size(node), "name": node.id}
    options["shift"] = (
        node.number("principal_point_offset_x", default=0.0),
        node.number("principal_point_offset_y", default=0.0),
    )
    if node.type == "orthographic":
        # The picture has a width of 2 in the sensor's own units.
        width = 2 * float(np.linalg.norm(node.transform("to_world")[:3, 0]))
        return Camera(projection="orthographic", fov=width, fov_axis="x", **options)
    options |= _field_of_view(node)
    if node.type == "thinlens":
        options["aperture_radius"] = max(node.number("aperture_radius", default=0.0), 0.0)
        options["focus_distance"] = node.positive("focus_distance", default=node.number("far_clip", default=1e4))
    return Camera(**options)


def up_axis(camera: Camera) -> tuple[float, float, float]:
    """The world axis, in either direction, that is nearest to the camera's up."""
    up = np.asarray(camera.to_world)[:3, 1]
    index = int(np.argmax(np.abs(up)))
    x, y, z = (float(np.copysign(1.0, up[index])) if i == index else 0.0 for i in range(3))
    return x, y, z


def _frame(node: Node) -> Matrix:
    """Mitsuba's cameras look along +z with +x to the left of the picture. Those of Éclat look along −z with +x to the
    right."""
    matrix = node.transform("to_world").copy()
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    if node.type != "orthographic" and not np.allclose(lengths, 1, rtol=1e-3):
        warn(f"{node.where}, to_world: the scale of a camera's transform is ignored")
    if node.type == "orthographic" and not np.isclose(lengths[0], lengths[1], rtol=1e-3):
        warn(f"{node.where}, to_world: unequal scales in x and y are not supported; that of x is used")
    matrix[:3, :3] = normalize(matrix[:3, :3].T).T
    if not np.allclose(matrix[:3, :3].T @ matrix[:3, :3], np.eye(3), atol=1e-3):
        warn(f"{node.where}, to_world: the camera's axes are not at right angles")
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
        raise node.mismatch("fov", "degrees between 0 and 180", fov)
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
        raise EclatError(f"{film.where}: expected a size of 1 to {_MAX_SIZE}, got {width} × {height}")
    if any(film.get(name) is not None for name in ("crop_width", "crop_height", "crop_offset_x", "crop_offset_y")):
        warn(f"{film.where}: the crop of the film is ignored")
    return width, height
