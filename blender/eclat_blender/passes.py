# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The layers of Éclat's pictures as Blender's passes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from eclat.scene import Camera

FAR = 1e10
"""The depth of pixels that show no surface, as in Cycles."""


@dataclass(frozen=True)
class Pass:
    """A pass: its name and channels in Blender, the layer of Éclat's picture, and who switches it on: a property of the
    view layer itself or, with `own`, of its Éclat settings."""

    name: str
    channels: str
    layer: str
    switch: str
    own: bool = True

    @property
    def kind(self) -> str:
        """The type of the pass as Blender names it."""
        return {"RGB": "COLOR", "XYZ": "VECTOR"}.get(self.channels, "VALUE")


PASSES = (
    Pass("Depth", "Z", "depth", "use_pass_z", own=False),
    Pass("Normal", "XYZ", "normal", "use_pass_normal", own=False),
    Pass("Direct", "RGB", "direct", "use_direct"),
    Pass("Indirect", "RGB", "indirect", "use_indirect"),
    Pass("Albedo", "RGB", "albedo", "use_albedo"),
    Pass("Record Density", "X", "record_density", "use_record_density"),
)


def wanted(view_layer: Any) -> list[Pass]:
    """Return the passes that a view layer asks for."""
    return [p for p in PASSES if getattr(view_layer.eclat if p.own else view_layer, p.switch)]


def layer_of(image: Any, which: Pass, camera: Camera) -> np.ndarray:
    """Return the values (H, W, channels) of a pass, row 0 on top; layers that a picture has not are 0."""
    values = image.layers.get(which.layer)
    if values is None:
        return np.zeros((*image.pixels.shape[:2], len(which.channels)), np.float32)
    if which.layer == "depth":
        values = np.where(np.isfinite(values), values * _cosines(camera, image.width, image.height), FAR)
    return np.asarray(values, np.float32).reshape(*image.pixels.shape[:2], -1)


def _cosines(camera: Camera, width: int, height: int) -> np.ndarray:
    """The cosines (H, W) between the rays through the centres of pixels and the axis of the camera, by which Blender's depth
    differs from the distance along the ray."""
    if camera.projection == "orthographic":
        return np.ones((height, width))
    half_width, half_height = camera.half_extent(width / height)
    x = ((np.arange(width) + 0.5) / width - 0.5 + camera.shift[0]) * 2 * half_width
    y = ((np.arange(height) + 0.5) / height - 0.5 + camera.shift[1]) * 2 * half_height
    return 1 / np.sqrt(1 + x[None, :] ** 2 + y[:, None] ** 2)


def write(result: Any, layers: dict[str, np.ndarray], region: tuple[int, int, int, int]) -> None:
    """Write arrays (H, W, channels), row 0 on top, to the passes of a Blender result that covers `region` of them."""
    x0, y0, x1, y1 = region
    for name, values in layers.items():
        target = find(result.layers[0].passes, name)
        if target is not None:
            block = np.ascontiguousarray(values[y0:y1, x0:x1][::-1], np.float32)
            target.rect.foreach_set(block.reshape(-1))


def find(passes: Any, name: str) -> Any:
    """Return a pass of a Blender result by its name, or None."""
    return next((p for p in passes if p.name == name), None)


Layers = Callable[[Any], dict[str, np.ndarray]]
