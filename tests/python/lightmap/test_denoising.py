# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Denoised light maps: less error, of the size that is stated, on the texels of surfaces; charts stay islands."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.images import denoiser
from eclat.lightmap.atlas import Packing, unwrap
from eclat.lightmap.denoising import gather_denoised
from eclat.lightmap.gathering import GatheredTexels, Settings, TexelPoints, gather, sample_points
from eclat.lightmap.sides import lit_sides
from eclat.lightmap.solids import solid_triangles
from eclat.lightmap.texels import Texels, corners_of, rasterize
from eclat.measure.metrics import RELATIVE_C
from eclat.scene import Environment, Material, grey
from eclat.scenes import build
from eclat.scenes.geometry import icosphere, mesh
from support.light_maps import read_at_random, seam_gap

pytestmark = pytest.mark.skipif(not denoiser.has_denoiser(), reason="pyoidn is not installed")


MapTexels = tuple[Texels, TexelPoints, np.ndarray, tuple[int, int]]


@pytest.fixture(scope="module")
def cornell() -> eclat.Scene:
    """The Cornell box without its boxes."""
    scene = build("cornell-box")
    return replace(scene, meshes=scene.meshes[:6])


@pytest.fixture(scope="module")
def texels(cornell: eclat.Scene) -> MapTexels:
    lit = lit_sides(cornell, "front", solid_triangles(cornell, cornell.meshes), 1)
    meshes = [replace(side.part.mesh, triangles=np.asarray(side.part.mesh.triangles)[side.lit]) for side in lit]
    atlas = unwrap(meshes, 0.05, Packing(2, 1024, 0))
    corners = corners_of(meshes, atlas)
    found = rasterize(corners, atlas.width, atlas.height)
    return found, sample_points(corners, found, 1), corners.charts[found.triangles], (atlas.height, atlas.width)


def settings(samples: int, seed: int, threads: int | None = None) -> Settings:
    return Settings("total", samples, -1, seed, threads, None)


@pytest.mark.slow
def test_the_error_that_is_stated_is_the_true_one(cornell: eclat.Scene, texels: MapTexels) -> None:
    found, points, *place = texels
    free = np.ones(points.positions.shape[:2], dtype=bool)

    def gathered(samples: int, seed: int) -> GatheredTexels:
        return gather(cornell, eclat.Path(), points, free, settings(samples, seed))

    a, b = (gathered(192, seed).values for seed in (91, 92))
    square = ((a + b) / 2) ** 2
    scale = square + RELATIVE_C * square.mean()

    def true(values: np.ndarray) -> float:
        return float(max(0.0, ((values - a) * (values - b) / scale).mean()) ** 0.5)

    ratios = []
    for seed in range(4):
        clean = gather_denoised(cornell, eclat.Path(), points, free, settings(32, seed), found, *place)
        assert true(clean.values) < 0.75 * true(gathered(32, seed).values)
        assert clean.counts["denoised"] > 0.5 and "direct_error" not in clean.counts
        ratios.append(clean.counts["estimated_error"] / true(clean.values))
        assert true(clean.values) < 1.25 * clean.counts["estimated_error_high"]
    assert np.mean(ratios) == pytest.approx(1, abs=0.3)


def test_same_bits_on_any_number_of_threads(cornell: eclat.Scene, texels: MapTexels) -> None:
    found, points, *place = texels
    free = np.ones(points.positions.shape[:2], dtype=bool)
    one, two = (
        gather_denoised(cornell, eclat.Path(), points, free, settings(8, 1, threads), found, *place)
        for threads in (1, 2)
    )
    np.testing.assert_array_equal(one.values, two.values)
    assert one.counts == two.counts


def test_charts_are_islands(texels: MapTexels, monkeypatch: pytest.MonkeyPatch) -> None:
    # One wall is a thousand times as bright as the others, which are next to it in the map.
    found, points, *place = texels
    bright = place[0] == place[0][len(found) // 2]
    light = np.where(bright, 1000.0, 1.0)[:, None] * np.ones(3)

    def noisy(scene: Any, source: Any, points: Any, free: Any, settings: Settings) -> GatheredTexels:
        random = np.random.default_rng(settings.seed)
        values = light * random.exponential(size=light.shape)
        return GatheredTexels(values, np.zeros((len(light), 2)), np.ones(len(light), bool), {"rays": 1.0}, eclat.Path())

    monkeypatch.setattr("eclat.lightmap.denoising.gather", noisy)
    clean = gather_denoised(
        build("furnace"), eclat.Path(), points, np.ones((1, 1), bool), settings(2, 0), found, *place
    )
    assert 200 < bright.sum() < 0.5 * len(bright)
    for side in (bright, ~bright):
        ratio = clean.values[side] / light[side]
        assert ratio.mean() == pytest.approx(1, abs=0.05) and ratio.max() < 4


def test_the_dark_stays_dark() -> None:
    """Floor and ceiling are one chart on both sides of the wall: a denoiser smooths across it, by three texels at most."""
    scene = build("two-rooms")
    plain, clean = (
        eclat.bake(scene, eclat.Path(), texel_size=0.1, samples=32, denoise=denoise) for denoise in (False, True)
    )
    assert clean.settings["denoise"] and not plain.settings["denoise"]
    assert clean.statistics["noise_left_low"] <= clean.statistics["noise_left_high"]
    assert clean.irradiance.shape == plain.irradiance.shape
    read = read_at_random(clean, 3000)
    dark = (read.positions[:, 0] > 0.3) & (np.abs(read.positions[:, 2]) < 1.49)
    lit = (read.positions[:, 0] < -0.1) & (read.positions[:, 1] > 0.01) & (read.positions[:, 1] < 2.34)
    usual = np.median(read.irradiance[lit & ~np.array([part.back for part in clean.parts])[read.parts]])
    assert dark.sum() > 500 and usual > 0.1
    assert read.irradiance[dark].max() < 1e-2 * usual


def test_seams_do_not_get_worse() -> None:
    """A smooth ball under a sky, cut into charts: lookups on both sides of each cut agree as well as without the denoiser."""
    ball = mesh([icosphere(2).smooth(180)], Material("diffuse", {"reflectance": grey(0.5)}, two_sided=False), "ball")
    sky = np.linspace(3, 0, 16, dtype=np.float32).reshape(16, 1, 1).repeat(3, axis=2)
    scene = eclat.Scene((ball,), environment=Environment(sky))
    gaps = [
        seam_gap(eclat.bake(scene, eclat.Direct(), texel_size=0.1, samples=32, denoise=denoise))
        for denoise in (False, True)
    ]
    assert gaps[1] < 1.1 * gaps[0] and gaps[1] < 0.01


def test_records_are_solved_once(cornell: eclat.Scene, texels: MapTexels) -> None:
    found, points, *place = texels
    free = np.ones(points.positions.shape[:2], dtype=bool)
    given = eclat.IrradianceCache(max_error=0.2)
    clean = gather_denoised(cornell, given, points, free, settings(8, 1), found, *place)
    plain = gather(cornell, given, points, free, settings(8, 1))
    assert clean.counts["rays"] < 1.5 * plain.counts["rays"]
    assert isinstance(clean.source, eclat.Solution)
    assert clean.counts["noise_left"] > 0 and "estimated_error" not in clean.counts  # that of the records is not known


def test_without_a_denoiser(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(denoiser, "PACKAGE", "no_such_denoiser")
    with pytest.raises(eclat.EclatError, match="extra `denoise`"):
        eclat.bake(cornell, denoise=True)
