# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Image textures: their pixels, and how they lie on the surface."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from eclat.images.tone import srgb_decode

from .fields import IDENTITY, Field, Placement
from .links import Found, follow
from .notices import Notices

if TYPE_CHECKING:
    from .node_values import NodeValues

WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "MIRROR": "mirror", "CLIP": "clamp"}
LINEAR_SPACES = ("Linear Rec.709", "Linear", "Non-Color", "Raw", "Generic Data", "Utilities - Raw", "scene_linear")

MISSING = (1.0, 0.0, 1.0, 1.0)
"""The colour of an image that cannot be read: the magenta that Blender shows."""


class ImageReader:
    """The pixels of Blender's images, each decoded once."""

    def __init__(self, notices: Notices) -> None:
        self._notices = notices
        self._read: dict[tuple[str, str], np.ndarray] = {}

    def texels(self, image: Any) -> np.ndarray:
        """Return the linear RGBA of an image, (H, W, 4) float32, row 0 on top."""
        space = image.colorspace_settings.name
        key = (image.name_full, space)
        if key not in self._read:
            self._read[key] = self._decoded(image, space)
        return self._read[key]

    def _decoded(self, image: Any, space: str) -> np.ndarray:
        where = f"image {image.name!r}"
        width, height = image.size
        if width * height == 0 or (image.source in ("MOVIE", "SEQUENCE", "TILED")):
            self._notices.add(where, f"it cannot be read ({image.source.lower()}) and is magenta")
            return np.array(MISSING, np.float32).reshape(1, 1, 4)
        flat = np.empty(width * height * 4, np.float32)
        image.pixels.foreach_get(flat)
        texels = flat.reshape(height, width, 4)[::-1].copy()
        if space == "sRGB":
            # Images with floating-point numbers are linear already when they arrive.
            if not image.is_float:
                texels[..., :3] = srgb_decode(texels[..., :3])
        elif space not in LINEAR_SPACES:
            self._notices.add(where, f"the colour space {space!r} is not supported and is taken as linear Rec. 709")
        return texels

    def field(self, found: Found, values: NodeValues) -> Field | None:
        """Make the field of an Image Texture node; None if it has a projection that is not supported."""
        node = found.node
        if node.image is None:
            return Field(np.array((0.0, 0.0, 0.0, 1.0), np.float32))
        if node.projection != "FLAT":
            return None
        place = coordinates(found, values)
        if place is None:
            return None
        if node.extension == "CLIP":
            values.refuse(f"the image {node.image.name!r} is clipped at its border; its outermost texels go on instead")
        uv, transform = place
        kind = "nearest" if node.interpolation == "Closest" else "bilinear"
        texels = self.texels(node.image)
        return Field(texels, Placement(uv, transform, WRAPS[node.extension], kind, node.image.name))


Affine = tuple[tuple[float, float, float], tuple[float, float, float]]


def coordinates(found: Found, values: NodeValues) -> tuple[str, Affine] | None:
    """Return the UV map and the map from its coordinates to the image's, both with v downwards; None if the coordinates
    are not those of a UV map."""
    matrix = np.eye(3)
    at = follow(found.node.inputs["Vector"], found.groups)
    while at.node is not None and at.node.type == "MAPPING":
        own = mapping(at, values)
        if own is None:
            return None
        matrix = matrix @ own
        at = follow(at.node.inputs["Vector"], at.groups)
    if at.node is None or (at.node.type == "TEX_COORD" and at.socket.name == "UV"):
        uv = ""
    elif at.node.type == "UVMAP":
        uv = at.node.uv_map
    else:
        return None
    flip = np.array(((1.0, 0.0, 0.0), (0.0, -1.0, 1.0), (0.0, 0.0, 1.0)))
    rows = (flip @ matrix @ flip)[:2]
    transform: Any = tuple(tuple(float(x) for x in row) for row in rows)
    return uv, IDENTITY if np.allclose(rows, np.eye(3)[:2]) else transform


def mapping(found: Found, values: NodeValues) -> np.ndarray | None:
    """Return the plane map (3×3) of a Mapping node of the type Point or Texture, whose inputs are constant."""
    node = found.node
    fields = {name: values.of(node.inputs[name], found.groups) for name in ("Rotation", "Scale")}
    place = values.of(node.inputs["Location"], found.groups).color if "Location" in node.inputs else (0.0, 0.0, 0.0)
    turn, scale = fields["Rotation"].color, fields["Scale"].color
    if node.vector_type not in ("POINT", "TEXTURE", "VECTOR") or abs(turn[0]) + abs(turn[1]) > 1e-6:
        return None
    c, s = math.cos(turn[2]), math.sin(turn[2])
    moved = np.array(((1, 0, place[0]), (0, 1, place[1]), (0, 0, 1)), float)
    turned = np.array(((c, -s, 0), (s, c, 0), (0, 0, 1)), float)
    scaled = np.diag((scale[0], scale[1], 1.0))
    if node.vector_type == "VECTOR":
        return turned @ scaled
    whole = moved @ turned @ scaled
    if node.vector_type == "POINT":
        return whole
    return None if abs(np.linalg.det(whole)) < 1e-12 else np.linalg.inv(whole)
