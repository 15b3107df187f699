# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What is computed from a scene as it is given."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.scene import triangle_areas


def test_areas_of_triangles() -> None:
    right = [[0, 0, 0], [3, 0, 0], [0, 4, 0]]
    equilateral = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    flat = [[0, 0, 0], [1, 1, 1], [2, 2, 2]]
    found = triangle_areas(np.array([right, equilateral, flat], dtype=np.float32))
    assert found == pytest.approx([6, np.sqrt(3) / 2, 0])
    assert triangle_areas(np.zeros((0, 3, 3))).shape == (0,)
