# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that tev understands [tev, Ipc.h and VectorGraphics.h].

Each is a length of 4 bytes, which counts itself, a byte for its kind, and what the kind needs. Integers and floats are little
endian, texts are UTF-8 and end with a zero.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class Kind(IntEnum):
    """The kinds of messages that are used here. That of updates is the third of its kind, with channels at any distance."""

    update_image = 6
    create_image = 4
    vector_graphics = 8


class Drawing(IntEnum):
    """The commands of vector graphics that are used here."""

    fill_color = 2
    fill = 3
    begin_path = 6
    rectangle = 18


_RECTANGLE = np.dtype([("command", "i1"), ("corner", "<f4", 2), ("size", "<f4", 2)])


def create_image(name: str, size: tuple[int, int], channels: Sequence[str]) -> bytes:
    """Make the message that creates a black image of `size` (width, height), or replaces the one of this name, and shows it."""
    head = bytes([Kind.create_image, True]) + _text(name) + struct.pack("<3i", *size, len(channels))
    return _with_length(head + b"".join(map(_text, channels)))


def update_image(name: str, corner: tuple[int, int], channels: Mapping[str, NDArray[np.float32]]) -> bytes:
    """Make the message that replaces a rectangle of pixels.

    `corner` is the column and the row of its upper left pixel, and each of the `channels` has its values (h, w).
    """
    planes = [np.asarray(plane, dtype="<f4") for plane in channels.values()]
    height, width = planes[0].shape
    head = bytes([Kind.update_image, False]) + _text(name) + struct.pack("<i", len(planes))
    head += b"".join(map(_text, channels)) + struct.pack("<4i", *corner, width, height)
    # Each channel begins where the one before ends, and its values follow each other.
    offsets = np.arange(len(planes), dtype="<i8") * (width * height)
    strides = np.ones(len(planes), dtype="<i8")
    return _with_length(b"".join([head, offsets.tobytes(), strides.tobytes(), *(plane.tobytes() for plane in planes)]))


def squares(name: str, centers: NDArray[np.floating], side: float, color: tuple[float, float, float, float]) -> bytes:
    """Make the message that draws squares over an image, instead of what was drawn over it before.

    `centers` (N, 2) and `side` are in pixels, from the upper left corner, and `color` is RGB and alpha from 0 to 1.
    """
    drawn = np.empty(len(centers), _RECTANGLE)
    drawn["command"], drawn["size"] = Drawing.rectangle, side
    drawn["corner"] = np.asarray(centers).reshape(-1, 2) - side / 2
    head = bytes([Kind.vector_graphics, False]) + _text(name) + bytes([False]) + struct.pack("<i", len(drawn) + 3)
    color_and_path = struct.pack("<b4f", Drawing.fill_color, *color) + bytes([Drawing.begin_path])
    return _with_length(head + color_and_path + drawn.tobytes() + bytes([Drawing.fill]))


def _text(text: str) -> bytes:
    return text.encode("utf-8", "replace").replace(b"\0", b"?") + b"\0"


def _with_length(message: bytes) -> bytes:
    return struct.pack("<I", len(message) + 4) + message
