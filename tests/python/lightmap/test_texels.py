# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Texels of triangles, against brute force."""

from __future__ import annotations

import numpy as np

from eclat.lightmap.texels import REACH, Corners, nearest_in_triangle, rasterize


def corners(uvs: np.ndarray, charts: np.ndarray | None = None) -> Corners:
    """Triangles that lie in the world, at z = 0, as they do in the atlas."""
    flat = np.concatenate((uvs, np.zeros((*uvs.shape[:2], 1))), axis=2)
    up = np.broadcast_to([0.0, 0.0, 1.0], flat.shape)
    numbers = np.arange(len(uvs)) if charts is None else charts
    return Corners(uvs, flat, up, up[:, 0], numbers)


def test_all_that_bilinear_filtering_reads_is_drawn() -> None:
    """Lookups at many points of random triangles meet only texels that are there, and every texel is met by one."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        uvs = rng.uniform(3, 13, (1, 3, 2))
        texels = rasterize(corners(uvs), 16, 16)
        drawn = np.zeros((16, 16), bool)
        drawn[texels.rows, texels.columns] = True
        u = rng.random((20000, 2))
        u[u.sum(axis=1) > 1] = 1 - u[u.sum(axis=1) > 1]
        points = uvs[0, 0] + u @ (uvs[0, 1:] - uvs[0, 0])
        low = np.floor(points - 0.5).astype(int)
        weight = points - 0.5 - low
        read = np.zeros((16, 16), bool)
        for dx in (0, 1):
            for dy in (0, 1):
                share = np.where(dx, weight[:, 0], 1 - weight[:, 0]) * np.where(dy, weight[:, 1], 1 - weight[:, 1])
                counts = share > 1e-2
                read[low[counts, 1] + dy, low[counts, 0] + dx] = True
        assert not (read & ~drawn).any()
        assert (drawn & ~read).sum() <= 0.15 * drawn.sum() + 3, "not many more than random points have met"


def test_sample_points_are_the_nearest_of_their_triangle() -> None:
    rng = np.random.default_rng(6)
    uvs = rng.uniform(0, 4, (200, 3, 2))
    points = rng.uniform(-1, 5, (200, 2))
    weights, squared = nearest_in_triangle(uvs, points)
    np.testing.assert_allclose(weights.sum(axis=1), 1)
    assert (weights >= 0).all()
    found = np.einsum("ni,nij->nj", weights, uvs)
    np.testing.assert_allclose(((found - points) ** 2).sum(axis=1), squared, atol=1e-9)
    grid = np.linspace(0, 1, 41)
    for a in grid:
        for b in grid[grid <= 1 - a + 1e-9]:
            other = np.einsum("i,nij->nj", [1 - a - b, a, b], uvs)
            assert (squared <= ((other - points) ** 2).sum(axis=1) + 1e-9).all()


def test_texels_represent_points_inside_triangles_near_their_centres() -> None:
    uvs = np.array([[[1.5, 1.5], [9.5, 1.5], [1.5, 9.5]], [[9.5, 1.5], [9.5, 9.5], [1.5, 9.5]]])
    texels = rasterize(corners(uvs, np.zeros(2, int)), 12, 12)
    assert len(texels) == 81 and texels.shared == 0
    centers = np.column_stack((texels.columns, texels.rows)) + 0.5
    assert np.abs(texels.uvs - centers).max() < 0.05, "edges lie on texel centres here: only moved a little inward"
    np.testing.assert_allclose(texels.positions[:, :2], texels.uvs)
    assert texels.uvs.min() > 1.5 and texels.uvs.max() < 9.5
    assert (np.bincount(texels.triangles) > 30).all()


def test_triangles_without_area_and_outside_the_image_draw_nothing() -> None:
    uvs = np.array([[[2.0, 2.0], [5.0, 5.0], [8.0, 8.0]], [[-9.0, -9.0], [-5.0, -9.0], [-9.0, -5.0]]])
    assert len(rasterize(corners(uvs), 10, 10)) == 0
    assert len(rasterize(corners(uvs[:0]), 10, 10)) == 0


def test_texels_of_two_charts_are_counted() -> None:
    left = np.array([[1.0, 1.0], [4.0, 1.0], [4.0, 4.0]])
    apart, close = left + np.array([3 + 2 * REACH, 0]), left + np.array([3.5, 0])
    assert rasterize(corners(np.stack((left, apart))), 16, 8).shared == 0
    assert rasterize(corners(np.stack((left, close))), 16, 8).shared > 0
