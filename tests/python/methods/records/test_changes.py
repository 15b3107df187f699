# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The measures of changes between gathers, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.methods.records.changes import NOTHING, IrradianceMeasure, Measure, RadianceMeasure, Seen

BOTH = pytest.mark.parametrize("measure", [IrradianceMeasure(0, 1), RadianceMeasure(0)])


def lit(factor: float, count: int = 8) -> Seen:
    cells = np.linspace(0.5, 1.5, count)
    return Seen(factor * cells, factor * np.pi * float(cells.mean()), 0.0)


@BOTH
def test_light_that_grows_evenly_changes_by_its_growth(measure: Measure) -> None:
    assert measure.change(lit(1), lit(1)) == 0
    assert measure.change(lit(1), lit(1.25)) == pytest.approx(0.2)
    assert measure.change(lit(1.25), lit(1)) == pytest.approx(0.2)
    assert measure.bend(lit(1), lit(1.25), lit(2), 0.25) == pytest.approx(0, abs=1e-12)
    assert measure.bend(lit(1), lit(1.5), lit(2), 0.25) == pytest.approx(0.125)


@BOTH
def test_a_loss_on_one_side_does_not_hide_a_gain_on_the_other(measure: Measure) -> None:
    a, b = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    assert measure.change(Seen(a, np.pi / 2), Seen(b, np.pi / 2)) > 1


@BOTH
def test_a_surface_without_extent_ends_a_life(measure: Measure) -> None:
    assert measure.change(NOTHING, lit(1)) == np.inf
    assert measure.change(NOTHING, NOTHING) == 0


def test_changes_in_the_dark_are_compared_to_a_tenth_of_the_mean() -> None:
    a, b = lit(0), lit(1e-3)
    assert IrradianceMeasure(100, 1).change(a, b) == pytest.approx(1e-3 * np.pi / 10, rel=1e-3)
    # Uniform radiance E / π has coefficients of the norm √(2/π) E.
    uniform = Seen(np.array([np.sqrt(2 / np.pi) * 1e-3]), 1e-3)
    assert RadianceMeasure(100).change(Seen(np.zeros(1)), uniform) == pytest.approx(1e-4, rel=1e-3)


def test_the_excess_counts_as_light_from_everywhere() -> None:
    without, with_it = Seen(np.zeros(4)), Seen(np.zeros(4), 0.0, 2.0)
    assert RadianceMeasure(0).change(without, with_it) == pytest.approx(1)
    assert IrradianceMeasure(0, 1).change(without, with_it) == pytest.approx(1)


def test_far_records_count_cells_less_than_sums() -> None:
    a, b = Seen(np.array([1.0, 0.0]), np.pi / 2), Seen(np.array([0.0, 1.0]), np.pi / 2)
    assert IrradianceMeasure(0, 0.125).change(a, b) == pytest.approx(0.125 * IrradianceMeasure(0, 1).change(a, b))
