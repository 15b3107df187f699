# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What is computed from a scene as it is given."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.scene import Material, Texture, Value, grey, rgb, triangle_areas


def test_areas_of_triangles() -> None:
    right = [[0, 0, 0], [3, 0, 0], [0, 4, 0]]
    equilateral = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    flat = [[0, 0, 0], [1, 1, 1], [2, 2, 2]]
    found = triangle_areas(np.array([right, equilateral, flat], dtype=np.float32))
    assert found == pytest.approx([6, np.sqrt(3) / 2, 0])
    assert triangle_areas(np.zeros((0, 3, 3))).shape == (0,)


def test_materials_say_what_they_are_in_a_line() -> None:
    board = Texture(np.zeros((4, 4, 3), np.uint8), srgb=True, name="board")
    paint = Material("diffuse", {"reflectance": rgb(0.5, 0.25, 0.125)}, name="paint")
    assert repr(paint) == "<Material 'paint': diffuse, reflectance (0.5, 0.25, 0.125)>"
    mixed = Material("blend", {"weight": Value((1, 1, 1), board)}, children=(paint, Material()), emission=grey(2))
    assert repr(mixed) == (
        "<Material '': blend, weight 1 × <Texture 'board': 4×4×3, sRGB>, children paint, diffuse, emission 2>"
    )
