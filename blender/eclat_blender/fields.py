# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers and colours of node trees: constants, or images with a place on the surface, and arithmetic with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from eclat.scene import Texture, Value

LUMINANCE = np.array((0.2126, 0.7152, 0.0722), np.float32)
"""Weights by which Blender makes a number of a colour, those of Rec. 709."""

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


@dataclass(frozen=True)
class Placement:
    """How an image lies on a surface: the name of the UV map ("" for that which renders), a 2×3 map from (u, v, 1) with v
    downwards, how the image goes on outside, whether texels are interpolated, and the name of the image."""

    uv: str = ""
    transform: tuple[tuple[float, float, float], tuple[float, float, float]] = IDENTITY
    wrap: str = "repeat"
    filter: str = "bilinear"
    name: str = ""


@dataclass(frozen=True, eq=False)
class Field:
    """Linear RGBA: `texels` (4,) of a constant, or (H, W, 4) of an image that lies as `placement` says, row 0 on top."""

    texels: np.ndarray
    placement: Placement | None = None

    @property
    def is_constant(self) -> bool:
        """Whether the field is the same everywhere."""
        return self.placement is None

    @property
    def number(self) -> float:
        """The first channel of a constant, or its mean."""
        return float(self.texels[..., 0].mean())

    @property
    def color(self) -> tuple[float, float, float]:
        """The RGB of a constant, or its mean."""
        r, g, b = self.texels.reshape(-1, 4)[:, :3].mean(axis=0)
        return float(r), float(g), float(b)

    def mapped(self, function: Callable[[np.ndarray], np.ndarray]) -> Field:
        """Apply a function to the RGBA values (…, 4)."""
        return replace(self, texels=np.asarray(function(self.texels), np.float32))

    def grey(self, channel: int | None = None) -> Field:
        """Make a number of a colour: one of its channels, or its luminance."""

        def one(texels: np.ndarray) -> np.ndarray:
            value = texels[..., :3] @ LUMINANCE if channel is None else texels[..., channel]
            return np.stack((value, value, value, np.ones_like(value)), axis=-1)

        return self.mapped(one)

    def value(self, uv_set: Callable[[str], int], low: float = 0.0, high: float = 1.0) -> Value:
        """Make an Éclat value with RGB between `low` and `high`. `uv_set` numbers the UV maps of a material."""
        texels = np.clip(np.nan_to_num(self.texels[..., :3]), low, high)
        if self.placement is None:
            r, g, b = (float(x) for x in texels)
            return Value((r, g, b))
        place = self.placement
        wrap: Any = place.wrap
        kind: Any = place.filter
        texture = Texture(np.ascontiguousarray(texels, np.float32), False, wrap, wrap, kind, place.name)
        return Value((1.0, 1.0, 1.0), texture, uv_set=uv_set(place.uv), uv_transform=place.transform)


def constant(*numbers: float) -> Field:
    """Make a constant of one number, or of three or four of a colour."""
    if len(numbers) == 1:
        numbers = numbers * 3
    return Field(np.array((*numbers, 1.0)[:4] if len(numbers) == 3 else numbers, np.float32))


def combined(function: Callable[..., np.ndarray], *fields: Field) -> tuple[Field, bool]:
    """Apply a function of RGBA arrays to fields.

    Two images are combined texel by texel if they have the same size and place. Where they have not, all but the largest
    are replaced by their means, and the second value that is returned is False.
    """
    images = [field for field in fields if not field.is_constant]
    if not images:
        return Field(np.asarray(function(*(f.texels for f in fields)), np.float32)), True
    chief = max(images, key=lambda field: field.texels.size)
    fits = True
    arrays = []
    for field in fields:
        same = field.is_constant or _alike(field, chief)
        fits &= same
        arrays.append(field.texels if same else field.texels.reshape(-1, 4).mean(axis=0))
    shape = chief.texels.shape
    found = np.broadcast_to(np.asarray(function(*arrays), np.float32), shape)
    return Field(found, chief.placement), fits


def _alike(a: Field, b: Field) -> bool:
    assert a.placement is not None and b.placement is not None
    return a.texels.shape == b.texels.shape and replace(a.placement, name="") == replace(b.placement, name="")
