# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pixel filters: the corner of a bright quadrant at a known place between pixels has a closed form for box and tent."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, FloatArray, Material, Mesh, Scene, grey, look_at

# Wider than one tile of 32 pixels, with the corner at the border of two.
WIDTH, HEIGHT = 36, 6


def quadrant(x: float, y: float) -> Scene:
    """Radiance 1 right of and above raster position (x, y), 0 elsewhere; one pixel is one metre."""
    left, top = x - WIDTH / 2, HEIGHT / 2 - y
    corners = np.array([[left, top, 0], [left + 99, top, 0], [left + 99, top + 99, 0], [left, top + 99, 0]])
    glow = Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(1.0))
    camera = Camera(look_at((0, 0, 1), (0, 0, 0)), fov=HEIGHT, projection="orthographic")
    return Scene((Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), glow),), (), None, (camera,))


def box(beyond: FloatArray) -> FloatArray:
    """Part of a pixel that lies beyond an edge; `beyond` = how far its centre does."""
    return np.clip(beyond + 0.5, 0, 1)


def tent(beyond: FloatArray) -> FloatArray:
    """The same, weighted by 1 − |distance to the centre|, from the centre to one pixel away."""
    d = np.clip(beyond, -1, 1)
    return np.where(d < 0, (1 + d) ** 2 / 2, 1 - (1 - d) ** 2 / 2)


@pytest.mark.parametrize("corner", [(31.25, 3.5), (31.9, 2.1), (32.0, 3.0), (4.5, 1.7)])
@pytest.mark.parametrize("name", ["box", "tent"])
def test_a_corner_between_pixels(name: str, corner: tuple[float, float]) -> None:
    x, y = corner
    image = eclat.render(quadrant(x, y), eclat.Direct(), samples=4096, size=(WIDTH, HEIGHT), filter=name).pixels
    inside = box if name == "box" else tent
    across, down = inside(np.arange(WIDTH) + 0.5 - x), inside(y - (np.arange(HEIGHT) + 0.5))
    expected = down[:, None] * across
    # 4096 points of a (0, 2)-sequence miss the area of a rectangle by some 10⁻³ at most.
    np.testing.assert_allclose(image, np.repeat(expected[:, :, None], 3, axis=2), atol=2e-3)
