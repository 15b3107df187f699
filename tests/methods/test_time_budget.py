# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What a given time chooses is told, and made again without a clock. No time is asserted: the clock here is a fake."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import eclat
from eclat import time_budget
from eclat.scenes import build
from eclat.solution import core_options

SIZE = (24, 24)


@pytest.fixture(scope="module")
def cornell() -> eclat.Scene:
    return build("cornell-box")


def test_a_picture_in_time_is_made_again_from_its_metadata(cornell: eclat.Scene) -> None:
    first = eclat.render(cornell, time=2.0, size=SIZE)
    samples = int(first.metadata["statistics"]["samples"])
    again = eclat.render(cornell, eclat.IrradianceCache(**first.metadata["options"]), samples=samples, size=SIZE)
    assert np.array_equal(first.pixels, again.pixels)
    assert again.metadata["options"] == first.metadata["options"]


class Machine:
    """Takes a second for each million rays of a solve, and no time for anything else."""

    def __init__(self) -> None:
        self.now = 0.0

    def perf_counter(self) -> float:
        return self.now

    def solve(self, scene: eclat.Scene, options: eclat.IrradianceCache, **keywords: Any) -> eclat.Solution:
        solution = eclat.solve(scene, options, **keywords)
        self.now += solution.statistics["rays"] / 1e6
        return solution


def test_more_time_makes_finer_records(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    found, seconds = [], []
    for deadline in (0.4, 6.0, 30.0):
        machine = Machine()
        monkeypatch.setattr(time_budget, "clock", machine)
        monkeypatch.setattr(time_budget, "solve", machine.solve)
        options = eclat.IrradianceCache()
        found.append(time_budget.solve_within(cornell, options, deadline, check=False, size=(64, 64)))
        seconds.append(machine.now)
    # What is left is less than the first solve took: that is all there is.
    assert found[0].options == time_budget.first_options(eclat.IrradianceCache())
    # Then pixels are covered, then all is finer.
    first, covering, fine = (core_options(solution.options) for solution in found)
    assert first.least_pixels == 4 and covering.least_pixels == 1
    assert (first.spacing, first.rows) == (covering.spacing, covering.rows)
    assert fine.least_pixels <= 1 and fine.spacing < first.spacing and fine.rows > first.rows
    # Time is left for pixels, whatever the laws say; and records get what helps.
    assert 0.2 * 6 < seconds[1] < 0.75 * 6
    assert 0.25 * 30 < seconds[2] < 0.75 * 30
    assert [solution.statistics["rays"] / 1e6 for solution in found] == pytest.approx(seconds)


def test_a_solve_that_takes_too_long_is_given_up(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    machine = Machine()
    monkeypatch.setattr(time_budget, "clock", machine)

    def solve(scene: eclat.Scene, options: eclat.IrradianceCache, **keywords: Any) -> eclat.Solution:
        if machine.now:  # all but the first
            machine.now = 19.0
            keywords["progress"]("solve", 0.5, {})
        return machine.solve(scene, options, **keywords)

    monkeypatch.setattr(time_budget, "solve", solve)
    found = time_budget.solve_within(cornell, eclat.IrradianceCache(), 20.0, check=False, size=(24, 24))
    assert found.options == time_budget.first_options(eclat.IrradianceCache()) and machine.now == 19.0
