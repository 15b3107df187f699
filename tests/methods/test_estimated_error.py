# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The error that a solve tells of itself, against errors that are known: put there by hand, or measured by path tracing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat import _core
from eclat.measure.error_estimate import ErrorEstimate
from eclat.measure.metrics import relative_rmse
from eclat.methods.records.laws import core_options
from eclat.methods.records.solving import CacheFunctions, functions_for
from eclat.scenes import build
from eclat.verbs.solve import purpose_of

SIZE = (32, 32)


def interval(found: _core.ErrorEstimate) -> ErrorEstimate:
    return ErrorEstimate.of_squared(found.squared, found.deviation, found.missed)


def estimated(
    solution: eclat.Solution, where: CacheFunctions, rays: int = 400_000, seed: int = 5, threads: int = 0
) -> _core.ErrorEstimate:
    check = _core.ErrorCheck()
    check.rays, check.seed, check.threads = rays, seed, threads
    return where.estimate(solution.core(), check, _core.Progress(), None)


def scaled(solution: eclat.Solution, factor: float) -> eclat.Solution:
    """All records too bright by a factor."""
    near = solution.near.copy()
    near[:, 6:12] *= factor
    near[:, 12:30] *= factor
    return replace(solution, near=near)


@pytest.fixture(scope="module")
def furnace() -> eclat.Scene:
    return build("furnace")


@pytest.mark.parametrize("factor", [0.9, 1.05])
def test_records_that_are_wrong_by_a_known_factor_in_a_furnace(furnace: eclat.Scene, factor: float) -> None:
    """Closed, emits 1, reflects half: radiance 2, of which 1 is emitted, 0.5 direct and 0.5 in the cache."""
    solution = scaled(eclat.solve(furnace, size=SIZE, check=False), factor)
    found = interval(estimated(solution, functions_for(furnace, purpose_of(furnace, size=SIZE))))
    R = 1.5 + 0.5 * factor  # as shown
    expected = abs(factor - 1) * 0.5 / (R * 1.01**0.5)
    # The records' own noise in a furnace is some hundredths of what was put there.
    assert found.error == pytest.approx(expected, rel=0.1)
    assert found.low <= 1.05 * expected
    assert found.high >= 0.95 * expected


def test_irradiance_at_points_and_everywhere(furnace: eclat.Scene) -> None:
    """E indirect = π (2 − 1), E direct = π; hence a factor of 1.1 is an error of 0.05 of all irradiance."""
    rng = np.random.default_rng(2)
    points = rng.uniform(-0.3, 0.3, (300, 3))
    normals = np.tile([0.0, 1.0, 0.0], (300, 1))
    options = eclat.IrradianceCache(max_error=0.05)
    for keywords in ({"points": (points, normals)}, {"view_independent": True}):
        solution = scaled(eclat.solve(furnace, options, check=False, **keywords), 1.1)
        where = functions_for(furnace, purpose_of(furnace, **keywords))
        found = np.mean([estimated(solution, where, seed=seed).squared for seed in range(8)]) ** 0.5
        shown = 1 + 1.1  # in units of π, as the cache shows it
        assert found == pytest.approx(0.1 / (shown**2 * 1.01) ** 0.5, rel=0.1)


def test_the_mean_over_many_seeds_is_the_error_of_the_picture() -> None:
    """Weights of both phases cancel: against long path-traced pictures, for a cache with splotches and a leak."""
    scene = build("cornell-box")
    options = eclat.IrradianceCache(max_error=0.08, rows=6)
    solution = eclat.solve(scene, options, size=SIZE, check=False)
    where = functions_for(scene, purpose_of(scene, size=SIZE))
    squares = [estimated(solution, where, rays=100_000, seed=s) for s in range(24)]
    mean = np.mean([e.squared for e in squares])
    spread = np.std([e.squared for e in squares], ddof=1)
    told = np.mean([e.deviation for e in squares])

    truth = [eclat.render(scene, eclat.Path(), samples=2048, size=SIZE, seed=100 + s).pixels for s in (1, 2)]
    pictures = [eclat.render(scene, solution, samples=256, size=SIZE, seed=200 + s).pixels for s in (1, 2)]
    # (x₁ − A)(x₂ − B): neither the noise of the references nor that of the pictures counts.
    (x1, x2), (a, b) = (np.asarray(p, np.float64) for p in (pictures, truth))
    R = (a + b) / 2
    expected = ((x1 - a) * (x2 - b) / (R**2 + 0.01 * (R**2).mean())).mean()
    assert relative_rmse(x1, a, b) > 0.01  # there is something to find
    assert mean == pytest.approx(expected, abs=5 * spread / 24**0.5 + 0.03 * expected)
    # What it tells of its own deviation is about right.
    assert 0.6 * spread < told < 2 * spread


def test_a_large_error_takes_fewer_records_and_is_kept_where_details_are_fine() -> None:
    scene, size, wanted = build("atrium"), (64, 36), 0.08
    a, b = (eclat.render(scene, eclat.Path(), size=size, samples=256, seed=seed, adaptive=False) for seed in (8, 9))
    at_sight = eclat.IrradianceCache(max_error=wanted, final_gather=False)
    shown = eclat.render(scene, at_sight, max_error=wanted, size=size, seed=1)
    assert relative_rmse(shown.pixels, a.layers.get("noisy", a.pixels), b.layers.get("noisy", b.pixels)) < wanted
    small = eclat.solve(scene, eclat.IrradianceCache(max_error=wanted, least_pixels=1), size=size, check=False)
    assert shown.metadata["statistics"]["records"] < len(small) / 2


def test_same_bits_on_one_thread_and_two() -> None:
    scene = build("glossy-box")
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.08), size=SIZE, check=False)
    one, two = (
        estimated(solution, functions_for(scene, purpose_of(scene, size=SIZE)), 100_000, threads=n) for n in (1, 2)
    )
    assert (one.squared, one.deviation, one.missed) == (two.squared, two.deviation, two.missed)
    assert np.array_equal(one.places, two.places)


def test_depth_is_that_of_the_solve(furnace: eclat.Scene) -> None:
    """With three edges the cached part is a single bounce, ρ · ρ · 1: nothing is missing of it."""
    solution = eclat.solve(furnace, size=SIZE, max_depth=3, check=False)
    settings = core_options(solution.options, max_depth=3)
    check = _core.ErrorCheck()
    check.rays, check.max_depth = 200_000, settings.max_depth
    found = interval(
        functions_for(furnace, purpose_of(furnace, size=SIZE)).estimate(solution.core(), check, _core.Progress(), None)
    )
    assert found.error < 0.004
    # The same records against all depths lack ρ³ / (1 − ρ) of light.
    check.max_depth = -1
    found = interval(
        functions_for(furnace, purpose_of(furnace, size=SIZE)).estimate(solution.core(), check, _core.Progress(), None)
    )
    # Pixels that are left to paths have no such error.
    assert found.unserved < 0.3
    served = (1 - found.unserved) ** 0.5
    assert found.error == pytest.approx(served * 0.25 / (1.75 * 1.01**0.5), rel=0.05)


def test_the_output_of_solve_and_render(furnace: eclat.Scene) -> None:
    solution = eclat.solve(furnace, size=SIZE)
    said = solution.statistics
    assert said["estimated_error_low"] <= said["estimated_error"] <= said["estimated_error_high"] < 0.02
    assert said["check_rays"] < said["rays"]
    image = eclat.render(furnace, eclat.IrradianceCache(), samples=4, size=SIZE)
    told = image.metadata["statistics"]
    assert told["estimated_error"] >= told["cache_error"]
    unchecked = eclat.render(furnace, eclat.IrradianceCache(), samples=4, size=SIZE, check=False)
    assert "estimated_error" not in unchecked.metadata["statistics"]
    assert np.array_equal(image.pixels, unchecked.pixels)
    assert solution.estimate is not None
