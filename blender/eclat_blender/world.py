# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's world as an environment: a colour, an image with its rotation and strength, or, for all else, a picture of the
world that Cycles draws."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from eclat.scene import DirectionalLight, Environment

from .image_nodes import ImageReader
from .links import Found, active_output, follow
from .node_values import NodeValues
from .notices import Notices

TO_BLENDER = np.array(((0.0, 0.0, -1.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
"""From Éclat's frame of environments, with +y up and the centre of the image at −z, to Blender's, with +z up and the centre
at +x."""


@dataclass(frozen=True, eq=False)
class DrawnWorld:
    """A world that Cycles has drawn: an equirectangular image (H, W, 3), row 0 on top and +x in its centre, and the sun of
    its sky, whose disc the image leaves out."""

    image: np.ndarray
    sun: DirectionalLight | None = None


DrawWorld = Callable[[Any], DrawnWorld | None]
"""Draws a world; None if it cannot."""

Sky = tuple[Environment | None, DirectionalLight | None]


def environment(world: Any, images: ImageReader, draw: DrawWorld, notices: Notices) -> Sky:
    """Make the environment of a world, None if it is black, and the sun of its sky."""
    if world is None:
        return None, None
    where = f"world {world.name!r}"
    output = active_output(world.node_tree, "OUTPUT_WORLD")
    if output is None:
        return _constant(np.array(world.color[:3], float)), None
    if output.inputs["Volume"].is_linked:
        notices.add(where, "its volume is not supported and is left out")
    found = follow(output.inputs["Surface"])
    if found.node is None:
        return None, None
    simple = _simple(found, where, images) if found.node.type == "BACKGROUND" else None
    if simple is not None:
        return (simple if simple.image.any() else None), None
    drawn = draw(world)
    if drawn is None:
        notices.add(where, "its nodes could not be drawn by Cycles; it is black")
        return None, None
    height, width = drawn.image.shape[:2]
    sun = "" if drawn.sun is None else ", and its sun is a light of its own"
    notices.add(where, f"Cycles has drawn it as an image of {width} × {height} pixels{sun}")
    return (Environment(drawn.image, TO_BLENDER) if drawn.image.any() else None), drawn.sun


def _simple(found: Found, where: str, images: ImageReader) -> Environment | None:
    """The environment of a Background whose strength is constant and whose colour is a constant or an image; else None."""
    own = Notices()
    values = NodeValues(where, images, own)
    strength = values.input(found, "Strength")
    if own.texts or not strength.is_constant:
        return None
    color = follow(found.node.inputs["Color"], found.groups)
    if color.node is not None and color.node.type == "TEX_ENVIRONMENT":
        return _image(color, strength.number, values, images)
    field = values.input(found, "Color")
    if own.texts or not field.is_constant:
        return None
    return _constant(np.array(field.color) * strength.number)


def _constant(color: np.ndarray) -> Environment:
    return Environment(np.maximum(color, 0).astype(np.float32).reshape(1, 1, 3))


def _image(found: Found, strength: float, values: NodeValues, images: ImageReader) -> Environment | None:
    node = found.node
    if node.image is None or node.projection != "EQUIRECTANGULAR":
        return None
    turn = np.eye(3)
    at = follow(node.inputs["Vector"], found.groups)
    while at.node is not None and at.node.type == "MAPPING":
        own = rotation(at, values)
        if own is None:
            return None
        turn = turn @ own
        at = follow(at.node.inputs["Vector"], at.groups)
    if at.node is not None and not (at.node.type == "TEX_COORD" and at.socket.name == "Generated"):
        return None
    texels = np.nan_to_num(images.texels(node.image)[..., :3]) * strength
    # The image is looked up in the direction turn · d, so it stands in the world turned back.
    return Environment(np.maximum(texels, 0).astype(np.float32), turn.T @ TO_BLENDER)


def rotation(found: Found, values: NodeValues) -> np.ndarray | None:
    """Return the rotation (3×3) of a Mapping node that only rotates; None for any other."""
    node = found.node
    vectors = {
        name: values.of(node.inputs[name], found.groups)
        for name in ("Location", "Rotation", "Scale")
        if name in node.inputs and node.inputs[name].enabled
    }
    if not all(field.is_constant for field in vectors.values()):
        return None
    if not np.allclose(vectors["Scale"].color, 1):
        return None
    if "Location" in vectors and node.vector_type != "VECTOR" and not np.allclose(vectors["Location"].color, 0):
        return None
    x, y, z = vectors["Rotation"].color
    matrix = _turn(2, z) @ _turn(1, y) @ _turn(0, x)
    return matrix.T if node.vector_type == "TEXTURE" else matrix


def _turn(axis: int, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    matrix = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix
