# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Polygons cut into triangles: same area, same sense of rotation, no overlap."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eclat.errors import EclatWarning
from eclat.loaders.polygons import polygon_triangles


def cut(points: list[tuple[float, ...]]) -> np.ndarray:
    p = np.array([(*q, 0.0)[:3] for q in points], dtype=np.float64)
    return polygon_triangles(p, np.arange(len(p))[None], "test")[0][0]


def signed_areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    q = points[triangles]
    return np.cross(q[:, 1] - q[:, 0], q[:, 2] - q[:, 0])[:, 2] / 2


def test_a_convex_quad_is_a_fan() -> None:
    assert cut([(0, 0), (1, 0), (1, 1), (0, 1)]).tolist() == [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize("start", range(4))
def test_an_arrowhead_is_cut_at_its_reflex_corner(start: int) -> None:
    arrow = np.roll(np.array([(0, 0), (2, 1), (0, 2), (0.5, 1)], dtype=float), start, axis=0)
    points = np.column_stack([arrow, np.zeros(4)])
    areas = signed_areas(points, polygon_triangles(points, np.arange(4)[None], "test")[0][0])
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(1.5)


@settings(derandomize=True, max_examples=60, deadline=None)
@given(st.lists(st.floats(0.1, 1.0), min_size=4, max_size=24), st.integers(0, 2), st.booleans())
def test_star_shaped_polygons_in_any_plane_keep_their_area(radii: list[float], axis: int, reverse: bool) -> None:
    angles = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    flat = np.column_stack([np.cos(angles), np.sin(angles)]) * np.array(radii)[:, None]
    flat = flat[::-1] if reverse else flat
    points = np.roll(np.column_stack([flat, np.full(len(flat), 0.7)]), axis, axis=1)
    triangles = polygon_triangles(points, np.arange(len(points))[None], "test")[0][0]
    areas = signed_areas(np.roll(points, -axis, axis=1), triangles) * (-1 if reverse else 1)
    x, y = flat.T
    expected = abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
    assert (areas > -1e-9).all()
    assert areas.sum() == pytest.approx(expected, rel=1e-9)


def test_a_corner_in_the_middle_of_an_edge_makes_no_flat_triangle() -> None:
    square = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]
    areas = signed_areas(np.array([(*q, 0.0) for q in square]), cut(square))
    assert (areas > 0.1).all()


def test_tangled_and_flat_polygons_still_give_triangles() -> None:
    assert cut([(0, 0), (1, 1), (1, 0), (0, 1)]).shape == (2, 3)
    assert cut([(0, 0), (1, 0), (2, 0), (3, 0), (4, 0)]).shape == (3, 3)
    assert cut([(1, 1)] * 6).shape == (4, 3)


def test_concave_polygons_beyond_the_budget_become_fans_with_a_warning() -> None:
    star = [(np.cos(a) * r, np.sin(a) * r, 0.0) for a, r in zip(np.linspace(0, 6, 20), [1, 0.3] * 10, strict=True)]
    polygons = np.tile(np.arange(20), (3, 1))
    with pytest.warns(
        EclatWarning, match=r"test: 2 concave polygons of 20 corners are triangulated as if they were convex"
    ):
        triangles, left = polygon_triangles(np.array(star), polygons, "test", work=10_000)
    assert left == 2000
    assert not np.array_equal(triangles[0], triangles[1])
    assert np.array_equal(triangles[1], triangles[2])
