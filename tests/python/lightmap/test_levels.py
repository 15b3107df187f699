# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The smaller levels of the mip map of a light map."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.lightmap.atlas import Packing
from eclat.lightmap.fit import bilinear
from eclat.lightmap.gutters import dilate
from eclat.lightmap.layout import Layout, Wishes, lay_out
from eclat.lightmap.levels import smaller_levels
from eclat.stage.staging import staged


def looked_up(level: np.ndarray, uvs: np.ndarray) -> np.ndarray:
    """Bilinear lookups at texture coordinates (N, 2), clamped at the edges as graphics cards do."""
    height, width = level.shape[:2]
    numbers = np.arange(height * width).reshape(height, width)
    return bilinear(numbers, uvs * (width, height)).times(level.reshape(-1, level.shape[2]))


def coloured(layout: Layout, gutter: int) -> tuple[np.ndarray, np.ndarray]:
    """Pages in which each chart has a value of its own, and the value of each chart."""
    rng = np.random.default_rng(3)
    values = rng.lognormal(0, 2, (layout.corners.charts.max() + 1, 3))
    stack = np.zeros((layout.atlas.stack_height, layout.atlas.width, 3))
    texels = layout.texels
    stack[texels.rows, texels.columns] = values[layout.corners.charts[texels.triangles]]
    stack = dilate(stack, stack[..., 0] > 0, gutter + 1)[0]
    return layout.pages(stack).astype(np.float32), values


@pytest.mark.parametrize(("gutter", "count"), [(2, 1), (4, 2), (16, 4)])
@pytest.mark.parametrize("timeout", [60.0, 0.0])
def test_no_level_mixes_charts(gutter: int, count: int, timeout: float) -> None:
    scene = staged(eclat.load("cornell-box"))
    layout = lay_out(scene, Wishes(0.04, packing=Packing(gutter, 1024, timeout)), 1, None)
    page, values = coloured(layout, gutter)
    levels = [page, *smaller_levels(page, layout.used(np.ones(len(layout.texels), bool)), layout.apart)]
    assert len(levels) == count + 1
    rng = np.random.default_rng(4)
    charts = layout.corners.charts
    which = rng.choice(np.flatnonzero(charts >= 0), 4000)
    at = np.einsum("ni,nij->nj", rng.dirichlet((0.3, 0.3, 0.3), len(which)), layout.corners.uvs[which])
    uvs = at / (page.shape[1], page.shape[0])
    for number, level in enumerate(levels):
        assert level.shape == (page.shape[0] >> number, page.shape[1] >> number, 3)
        np.testing.assert_allclose(looked_up(level, uvs), values[charts[which]], rtol=1e-5)


def test_dark_surfaces_stay_black_in_all_levels() -> None:
    scene = staged(eclat.load("cornell-box"))
    for gutter in (2, 16):
        layout = lay_out(scene, Wishes(0.05, packing=Packing(gutter, 1024)), 1, None)
        page = coloured(layout, gutter)[0]
        levels = smaller_levels(page, layout.used(np.ones(len(layout.texels), bool)), layout.apart)
        parts = layout.parts()
        dark = [
            part.lightmap_uvs[np.unique(np.asarray(part.mesh.triangles)[~side.lit])]
            for part, side in zip(parts, layout.sides, strict=True)
            if not side.lit.all()
        ]
        uvs = np.concatenate(dark)
        assert len(uvs) and levels
        for level in (page, *levels):
            np.testing.assert_array_equal(looked_up(level, uvs), 0)


def test_texels_of_no_surface_do_not_count() -> None:
    page = np.zeros((8, 8, 3), np.float32)
    page[:, :3] = 2
    page[:, 3:] = 100
    used = np.zeros((8, 8), bool)
    used[:, :3] = True
    first, *_ = smaller_levels(page, used, 4)
    np.testing.assert_array_equal(first[:, :2], 2)


def test_small_pages_have_one_level() -> None:
    page = np.ones((1, 1, 3), np.float32)
    assert smaller_levels(page, np.ones((1, 1), bool), 100) == []
    assert smaller_levels(np.ones((64, 64, 3), np.float32), np.ones((64, 64), bool), 3) == []
    assert smaller_levels(np.ones((64, 64, 3), np.float32), np.ones((64, 64), bool), 0) == []
