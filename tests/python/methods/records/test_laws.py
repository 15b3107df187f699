# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Settings of the next step, and when steps end."""

from __future__ import annotations

from typing import Any

import pytest

import eclat
from eclat.measure.error_estimate import ErrorEstimate
from eclat.methods.records import laws
from eclat.methods.records.laws import core_options, core_radiance_options, finer, rays_after, step_towards
from eclat.scenes import build

COARSE = eclat.IrradianceCache(max_error=0.04, far_records=300)


def test_all_parts_of_the_error_are_made_finer() -> None:
    before, after = core_options(COARSE), core_options(finer(COARSE, 0.5))
    for name in ("spacing", "least_pixels", "far_spacing"):
        assert getattr(after, name) < getattr(before, name)
    for name in ("rows", "far_rows", "far_records"):
        assert getattr(after, name) > getattr(before, name)
    # Twice half is a quarter, but for rounding.
    twice, once = core_options(finer(finer(COARSE, 0.5), 0.5)), core_options(finer(COARSE, 0.25))
    assert twice.spacing == pytest.approx(once.spacing)
    assert abs(twice.rows - once.rows) <= 1


def test_records_are_no_smaller_than_the_wanted_error_asks_for() -> None:
    found = [
        core_options(eclat.IrradianceCache(max_error=error)).least_pixels for error in (0.005, 0.039, 0.04, 0.08, 0.5)
    ]
    assert found == [1, 1, 2, 4, 4]
    # What is given counts, and the largest radius is never below the least.
    assert core_options(eclat.IrradianceCache(max_error=0.5, least_pixels=1)).least_pixels == 1
    assert core_options(eclat.IrradianceCache(max_error=0.5, largest_pixels=2)).least_pixels == 2


def test_refining_reduces_all_parts_of_the_error_of_gloss() -> None:
    coarse = eclat.RadianceCache(max_error=0.04)
    half = finer(coarse, 0.5)
    assert isinstance(half, eclat.RadianceCache) and half.gloss_error == 0.2
    before, after = core_radiance_options(coarse), core_radiance_options(half)
    assert after.spacing < before.spacing and after.rows > before.rows


@pytest.mark.parametrize("options", [COARSE, eclat.RadianceCache()])
def test_settings_end_at_their_limits(options: eclat.IrradianceCache) -> None:
    for _ in range(40):
        options = finer(options, 0.25)
    assert finer(options, 0.25) == options


def test_a_refinement_step_aims_below_the_wanted_error_and_is_bounded() -> None:
    estimate = ErrorEstimate(0.02, 0.018, 0.022)
    assert step_towards(estimate, 0.015) == pytest.approx(0.6)
    assert step_towards(estimate, 0.0199) == pytest.approx(0.796)
    assert step_towards(estimate, 1e-4) == laws.LARGEST_STEP
    assert rays_after(1.0, 0.5) == pytest.approx(2 ** (7 / 3))


def test_refines_until_the_estimate_meets_the_target() -> None:
    scene = build("furnace")
    rough = eclat.IrradianceCache(max_error=0.01, rows=2, far_records=100)
    once = eclat.solve(scene, rough, size=(16, 16))
    assert once.estimate is not None and once.estimate.high > 0.01  # or nothing is tested
    refined = eclat.solve(scene, rough, size=(16, 16), refine=True)
    assert refined.estimate is not None and refined.estimate.high <= 0.01
    assert refined.statistics["refinements"] >= 1
    assert refined.statistics["rays"] > once.statistics["rays"]


def test_refining_warns_why_it_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = build("furnace")
    rough: Any = eclat.IrradianceCache(max_error=0.01, rows=2, far_records=100)
    monkeypatch.setattr(laws, "MOST_RAYS", 1000)
    with pytest.warns(eclat.EclatWarning, match="not the wanted 1 %: another refinement would take"):
        solution = eclat.solve(scene, rough, size=(16, 16), refine=True)
    assert solution.statistics["refinements"] == 0


def test_a_saved_solution_is_refined(tmp_path: Any) -> None:
    scene = build("furnace")
    rough = eclat.IrradianceCache(max_error=0.05, rows=3, far_records=100)
    eclat.solve(scene, rough, size=(16, 16)).save(tmp_path / "rough.npz")
    before = eclat.Solution.load(tmp_path / "rough.npz", scene)
    after = eclat.refine(before, scene, size=(16, 16))
    assert before.estimate is not None and after.estimate is not None
    assert after.estimate.error < before.estimate.error
    after.save(tmp_path / "fine.npz")
    assert eclat.Solution.load(tmp_path / "fine.npz", scene).options == after.options
