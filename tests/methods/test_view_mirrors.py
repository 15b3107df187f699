# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mirrors on the page of `eclat view` in headless Chromium: plane ones are exact, others are marked approximations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat import scenes
from eclat.measure.metrics import away_from_edges, relative_rmse
from eclat.scene import Material, Scene, rgb
from support.browser import look_at_page, require_page

SIZE = (96, 96)
SUPERSAMPLING = 3
SAMPLES = 64


SILVER = Material("conductor", {"eta": rgb(0.14, 0.13, 0.16), "k": rgb(4.0, 3.1, 2.3)}, name="silver")
VARNISH = Material("plastic", {"diffuse_reflectance": rgb(0.4, 0.1, 0.05)}, name="varnish")
BLUE = Material("diffuse", {"reflectance": rgb(0.0, 0.0, 0.9)}, name="blue")
YELLOW = Material("diffuse", {"reflectance": rgb(0.9, 0.9, 0.0)}, name="yellow")


def cornell_box(back: Material, large_box: Material) -> Scene:
    """The Cornell box with other materials of the back wall and of the large box."""
    new = {"back": back, "large-box": large_box}
    scene = scenes.build("cornell-box")
    return replace(scene, meshes=tuple(replace(m, material=new.get(m.name, m.material)) for m in scene.meshes))


@pytest.mark.slow
def test_a_plane_mirror_shows_what_render_shows() -> None:
    require_page()
    scene = cornell_box(SILVER, VARNISH)
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.03), size=SIZE, check=False)
    asked = {"camera": 0, "width": SUPERSAMPLING * SIZE[0], "height": SUPERSAMPLING * SIZE[1]}
    with eclat.view(scene, solution, texel_size=0.03, samples=64) as viewer:
        page = look_at_page(viewer.url, [asked, asked | {"look": {"mirrors": False}}])
    assert page.message == "" and page.messages == []
    with_mirrors, without = (
        p.reshape(SIZE[1], SUPERSAMPLING, SIZE[0], SUPERSAMPLING, 3).mean(axis=(1, 3)) for p in page.pictures
    )
    a, b = (eclat.render(scene, solution, size=SIZE, samples=SAMPLES, seed=seed) for seed in (1, 2))
    places = eclat.render(cornell_box(BLUE, YELLOW), eclat.Path(), size=SIZE, samples=4, max_depth=1).layers
    away = away_from_edges(places["depth"], places["normal"])
    glossy = np.abs(places["albedo"][..., 1] - places["albedo"][..., 2]) > 0.85
    wall = away & glossy & (places["albedo"][..., 2] > 0.85)
    lamp = a.pixels.max(axis=-1) > 2  # the edges of the mirrored lamp are edges, too
    wall &= ~np.lib.stride_tricks.sliding_window_view(np.pad(lamp, 2), (5, 5)).any(axis=(-1, -2))
    wall &= a.pixels.max(axis=-1) > 0.01  # elsewhere the mirror shows the black before the box
    assert inner_of(without, a.pixels, b.pixels, wall) > 0.8
    mirrored = inner_of(with_mirrors, a.pixels, b.pixels, wall)
    assert mirrored < 0.02, f"{mirrored:.4f}"
    # An overlay marks what is approximated: the mirror and the varnish, and nothing without gloss.
    marked = page.approximated[0][1::SUPERSAMPLING, 1::SUPERSAMPLING]
    assert marked[wall].all() and not marked[away & ~glossy].any()


def inner_of(page: np.ndarray, a: np.ndarray, b: np.ndarray, mask: np.ndarray) -> float:
    """The error where the reference changes little around a pixel, because what is mirrored has edges, too."""
    mean = np.pad(((a + b) / 2).mean(axis=-1), 1, mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(mean, (3, 3))
    smooth = around.max(axis=(-1, -2)) < 1.5 * around.min(axis=(-1, -2))
    mask = mask & smooth
    assert mask.mean() > 0.02
    return relative_rmse(page, a, b, c=0.01 * float(np.mean(a[mask] ** 2)), mask=mask)
