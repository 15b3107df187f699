# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The value of an input of a shader: constants, images, and the nodes of colour and number between them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .fields import Field, combined, constant
from .image_nodes import ImageReader
from .links import Found, follow
from .node_arithmetic import BLENDS, MATH, brightness_contrast, hue_saturation, ramp
from .notices import Notices


class NodeValues:
    """Evaluates the inputs of the nodes of one material or world. What it cannot evaluate is named in the notices, and the
    value that is written at the input is used instead."""

    def __init__(self, where: str, images: ImageReader, notices: Notices) -> None:
        self.where, self.images, self.notices = where, images, notices
        self.uses_vertex_color = False

    def of(self, socket: Any, groups: tuple[Any, ...] = ()) -> Field:
        """Evaluate an input. Numbers are grey; colours are linear."""
        found = follow(socket, groups)
        if found.node is None:
            return written(found.socket, socket)
        maker = _MAKERS.get(found.node.type)
        field = None if maker is None else maker(self, found)
        if field is None:
            self.refuse(f"the node {found.node.name!r} ({found.node.bl_label}) is not supported")
            return written(socket, socket)
        if socket.type == "VALUE" and found.socket.type in ("RGBA", "VECTOR"):
            return field.grey()
        return field

    def input(self, found: Found, name: str | int) -> Field:
        """Evaluate an input of the node that was found."""
        return self.of(found.node.inputs[name], found.groups)

    def refuse(self, what: str) -> None:
        """Name something that is not carried over."""
        self.notices.add(self.where, what)

    def join(self, function: Callable[..., np.ndarray], *fields: Field) -> Field:
        """Combine fields, and say so where images of different places had to be replaced by their means."""
        field, fits = combined(function, *fields)
        if not fits:
            self.refuse(
                "images of different sizes or coordinates are combined; all but one are replaced by their means"
            )
        return field


def written(socket: Any, wanted: Any) -> Field:
    """Return the value that is written at an input, as an input of the type of `wanted` takes it."""
    value = getattr(socket, "default_value", 0.0)
    numbers = (float(value),) if isinstance(value, int | float) else tuple(float(x) for x in value)
    field = constant(*numbers)
    return field.grey() if wanted.type == "VALUE" and len(numbers) > 1 else field


def _image(values: NodeValues, found: Found) -> Field | None:
    field = values.images.field(found, values)
    if field is not None and found.socket.name == "Alpha":
        return field.grey(3)
    return field


def _mix(values: NodeValues, found: Found) -> Field | None:
    node = found.node
    if node.data_type not in ("RGBA", "FLOAT"):
        return None
    enabled = [socket for socket in node.inputs if socket.enabled]
    factor, a, b = (values.of(socket, found.groups) for socket in enabled[:3])
    mode = node.blend_type if node.data_type == "RGBA" else "MIX"
    return _blended(values, mode, (factor, a, b), node.clamp_factor, getattr(node, "clamp_result", False))


def _mix_old(values: NodeValues, found: Found) -> Field | None:
    fields = tuple(values.input(found, index) for index in range(3))
    return _blended(values, found.node.blend_type, fields, True, found.node.use_clamp)


def _blended(values: NodeValues, mode: str, fields: tuple[Field, ...], clamp_factor: bool, clamp: bool) -> Field | None:
    if mode not in BLENDS:
        return None
    blend = BLENDS[mode]

    def mixed(factor: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        share = np.clip(factor[..., :1], 0, 1) if clamp_factor else factor[..., :1]
        result = a + share * (blend(a, b) - a)
        return np.clip(result, 0, 1) if clamp else result

    return values.join(mixed, *fields)


def _math(values: NodeValues, found: Found) -> Field | None:
    function = MATH.get(found.node.operation)
    if function is None:
        return None
    fields = [values.input(found, index) for index in range(len(found.node.inputs))]
    clamp = found.node.use_clamp

    def applied(*arrays: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            result = np.nan_to_num(function(*arrays))
        return np.clip(result, 0, 1) if clamp else result

    return values.join(applied, *fields)


def _separate(values: NodeValues, found: Found) -> Field | None:
    if getattr(found.node, "mode", "RGB") != "RGB":
        return None
    names = ("Red", "Green", "Blue") if found.socket.name in ("Red", "Green", "Blue") else ("R", "G", "B")
    return values.input(found, 0).grey(names.index(found.socket.name))


def _combine(values: NodeValues, found: Found) -> Field | None:
    if getattr(found.node, "mode", "RGB") != "RGB":
        return None
    parts = [values.input(found, index) for index in range(3)]

    def stacked(r: np.ndarray, g: np.ndarray, b: np.ndarray) -> np.ndarray:
        channels = np.broadcast_arrays(r[..., 0], g[..., 0], b[..., 0], np.float32(1))
        return np.stack(channels, axis=-1)

    return values.join(stacked, *parts)


def _invert(values: NodeValues, found: Found) -> Field:
    return values.join(lambda f, c: c + f[..., :1] * (1 - 2 * c), values.input(found, 0), values.input(found, 1))


def _gamma(values: NodeValues, found: Found) -> Field:
    power = values.input(found, 1)
    return values.join(lambda c, g: np.maximum(c, 0) ** g[..., :1], values.input(found, 0), power)


def _clamp(values: NodeValues, found: Found) -> Field | None:
    if found.node.clamp_type != "MINMAX":
        return None
    return values.join(np.clip, *(values.input(found, index) for index in range(3)))


def _map_range(values: NodeValues, found: Found) -> Field | None:
    node = found.node
    if node.data_type != "FLOAT" or node.interpolation_type != "LINEAR":
        return None
    fields = [values.input(found, index) for index in range(5)]

    def ranged(x: np.ndarray, a: np.ndarray, b: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        width = np.where(b == a, 1, b - a)
        share = np.where(b == a, 0, (x - a) / width)
        return low + (np.clip(share, 0, 1) if node.clamp else share) * (high - low)

    return values.join(ranged, *fields)


def _ramp(values: NodeValues, found: Found) -> Field:
    field = values.input(found, 0).mapped(lambda x: ramp(found.node.color_ramp, x[..., 0]))
    return field.grey(3) if found.socket.name == "Alpha" else field


def _hue(values: NodeValues, found: Found) -> Field:
    named = (values.input(found, name) for name in ("Hue", "Saturation", "Value", "Fac", "Color"))
    return values.join(hue_saturation, *named)


def _brightness(values: NodeValues, found: Found) -> Field:
    fields = [values.input(found, index) for index in range(3)]
    return values.join(brightness_contrast, *fields)


def _vertex_color(values: NodeValues, found: Found) -> Field | None:
    if found.socket.name != "Color":
        return None
    values.uses_vertex_color = True
    return constant(1.0)


_MAKERS: dict[str, Callable[[NodeValues, Found], Field | None]] = {
    "TEX_IMAGE": _image,
    "RGB": lambda values, found: written(found.socket, found.socket),
    "VALUE": lambda values, found: written(found.socket, found.socket),
    "MIX": _mix,
    "MIX_RGB": _mix_old,
    "MATH": _math,
    "SEPARATE_COLOR": _separate,
    "SEPRGB": _separate,
    "COMBINE_COLOR": _combine,
    "COMBRGB": _combine,
    "INVERT": _invert,
    "GAMMA": _gamma,
    "CLAMP": _clamp,
    "MAP_RANGE": _map_range,
    "VALTORGB": _ramp,
    "RGBTOBW": lambda values, found: values.input(found, 0).grey(),
    "HUE_SAT": _hue,
    "BRIGHTCONTRAST": _brightness,
    "VERTEX_COLOR": _vertex_color,
}
