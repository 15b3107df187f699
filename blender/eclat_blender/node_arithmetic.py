# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The arithmetic of Blender's nodes of colour and number, on arrays of RGBA (…, 4)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

RAMP_STEPS = 1024
"""Entries of the table by which a colour ramp is applied to an image: finer than 8 bits."""

Binary = Callable[[np.ndarray, np.ndarray], np.ndarray]


def _divided(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.where(b == 0, a, a / np.where(b == 0, 1, b))


BLENDS: dict[str, Binary] = {
    "MIX": lambda a, b: b,
    "MULTIPLY": lambda a, b: a * b,
    "ADD": lambda a, b: a + b,
    "SUBTRACT": lambda a, b: a - b,
    "DIVIDE": _divided,
    "SCREEN": lambda a, b: 1 - (1 - a) * (1 - b),
    "DARKEN": np.minimum,
    "LIGHTEN": np.maximum,
    "DIFFERENCE": lambda a, b: np.abs(a - b),
    "OVERLAY": lambda a, b: np.where(a < 0.5, 2 * a * b, 1 - 2 * (1 - a) * (1 - b)),
}
"""Blend modes: the result for the factor 1, of which the factor is the share."""

MATH: dict[str, Callable[..., np.ndarray]] = {
    "ADD": lambda a, b, c: a + b,
    "SUBTRACT": lambda a, b, c: a - b,
    "MULTIPLY": lambda a, b, c: a * b,
    "DIVIDE": lambda a, b, c: np.where(b == 0, 0, a / np.where(b == 0, 1, b)),
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": lambda a, b, c: np.power(a, b),
    "SQRT": lambda a, b, c: np.sqrt(np.maximum(a, 0)),
    "ABSOLUTE": lambda a, b, c: np.abs(a),
    "MINIMUM": lambda a, b, c: np.minimum(a, b),
    "MAXIMUM": lambda a, b, c: np.maximum(a, b),
    "LESS_THAN": lambda a, b, c: (a < b).astype(np.float32),
    "GREATER_THAN": lambda a, b, c: (a > b).astype(np.float32),
}
"""Operations of the Math node on its three inputs, of which most use fewer."""


def brightness_contrast(color: np.ndarray, bright: np.ndarray, contrast: np.ndarray) -> np.ndarray:
    """Apply the node Brightness/Contrast: a straight line of slope 1 + contrast, never below 0."""
    slope, offset = 1 + contrast[..., :1], bright[..., :1] - contrast[..., :1] * 0.5
    return np.maximum(slope * color + offset, 0)


def hue_saturation(
    hue: np.ndarray, saturation: np.ndarray, value: np.ndarray, factor: np.ndarray, color: np.ndarray
) -> np.ndarray:
    """Apply the node Hue/Saturation/Value: a hue of 0.5 turns nothing; saturation and value are factors."""
    rgb = color[..., :3]
    high, low = rgb.max(axis=-1), rgb.min(axis=-1)
    spread = high - low
    safe = np.where(spread > 0, spread, 1)
    r, g, b = (rgb[..., k] for k in range(3))
    sixth = np.where(high == r, (g - b) / safe, np.where(high == g, 2 + (b - r) / safe, 4 + (r - g) / safe))
    turned = (np.where(spread > 0, sixth / 6, 0) + hue[..., 0] - 0.5) % 1.0
    full = np.clip(np.where(high > 0, spread / np.where(high > 0, high, 1), 0) * saturation[..., 0], 0, 1)
    bright = high * value[..., 0]
    # The channel k of a hue h is a trapezoid of the distance of h from the hue of that channel.
    channels = [np.clip(np.abs((turned * 6 + k) % 6 - 3) - 1, 0, 1) for k in (0, 4, 2)]
    changed = np.stack([bright * (1 - full + full * channel) for channel in channels], axis=-1)
    mixed = rgb + factor[..., :1] * (np.maximum(changed, 0) - rgb)
    return np.concatenate((mixed, np.broadcast_to(color[..., 3:], (*mixed.shape[:-1], 1))), axis=-1)


def ramp(color_ramp: Any, positions: np.ndarray) -> np.ndarray:
    """Evaluate a colour ramp at positions (…) between 0 and 1: RGBA (…, 4)."""
    if positions.size == 1:
        return np.array(color_ramp.evaluate(float(positions)), np.float32).reshape(*positions.shape, 4)
    table = np.array([color_ramp.evaluate(i / (RAMP_STEPS - 1)) for i in range(RAMP_STEPS)], np.float32)
    return table[np.rint(np.clip(positions, 0, 1) * (RAMP_STEPS - 1)).astype(np.int64)]
