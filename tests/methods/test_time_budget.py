# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What a given time chooses is told, and made again without a clock. No time is asserted: the clock here is a fake."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import eclat
from eclat.methods.records import time_budget
from eclat.methods.records.laws import core_options, first_options
from eclat.methods.records.solving import Job
from eclat.methods.work import Care, View, Work
from eclat.scenes import build

SIZE = (24, 24)


@pytest.fixture(scope="module")
def cornell() -> eclat.Scene:
    return build("cornell-box")


def test_a_picture_in_time_is_made_again_from_its_metadata(cornell: eclat.Scene) -> None:
    first = eclat.render(cornell, time=2.0, size=SIZE)
    samples, made = int(first.metadata["statistics"]["samples"]), {n: first.metadata[n] for n in ("halves", "adaptive")}
    records = eclat.IrradianceCache(**first.metadata["options"])
    again = eclat.render(cornell, records, samples=samples, size=SIZE, denoise=first.metadata["denoised"], **made)
    assert np.array_equal(first.pixels, again.pixels)
    assert again.metadata["options"] == first.metadata["options"]


class Machine:
    """Takes a second for each million rays of a solve, and no time for anything else."""

    def __init__(self) -> None:
        self.now = 0.0

    def perf_counter(self) -> float:
        return self.now

    def job(self, *arguments: Any, **keywords: Any) -> Any:
        """A `Job` whose solves take the machine's time."""
        job, machine = Job(*arguments, **keywords), self

        class Timed:
            def solve(self, options: eclat.IrradianceCache, check_share: float) -> eclat.Solution:
                solution = job.solve(options, check_share)
                machine.now += solution.statistics["rays"] / 1e6
                return solution

        return Timed()


def within(scene: eclat.Scene, deadline: float, size: tuple[int, int]) -> eclat.Solution:
    view = View(scene.cameras[0], size)
    return time_budget.solve_within(scene, eclat.IrradianceCache(), deadline, view, Work(), Care())


def test_more_time_makes_finer_records(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    found, seconds = [], []
    for deadline in (0.4, 9.0, 30.0):
        machine = Machine()
        monkeypatch.setattr(time_budget, "clock", machine)
        monkeypatch.setattr(time_budget, "Job", machine.job)
        found.append(within(cornell, deadline, (64, 64)))
        seconds.append(machine.now)
    # What is left is less than the first solve took: that is all there is.
    assert found[0].options == first_options(eclat.IrradianceCache())
    # Then pixels are covered, then all is finer.
    first, covering, fine = (core_options(solution.options) for solution in found)
    assert first.least_pixels == 4 and covering.least_pixels == 1
    assert (first.spacing, first.rows) == (covering.spacing, covering.rows)
    assert fine.least_pixels <= 1 and fine.spacing < first.spacing and fine.rows > first.rows
    # Time is left for pixels, whatever the laws say; and records get what helps.
    assert 0.15 * 9 < seconds[1] < 0.75 * 9
    assert 0.25 * 30 < seconds[2] < 0.75 * 30
    assert [solution.statistics["rays"] / 1e6 for solution in found] == pytest.approx(seconds)


def test_a_solve_that_takes_too_long_is_given_up(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    machine = Machine()
    monkeypatch.setattr(time_budget, "clock", machine)

    def job(scene: eclat.Scene, purpose: View, work: Work, keep_partial: bool = False) -> Any:
        if machine.now:  # all but the first
            machine.now = 19.0
            assert work.progress is not None
            timely = work.progress

            class Late:
                def solve(self, *arguments: Any) -> None:
                    timely("solve", 0.5, {})

            return Late()
        return machine.job(scene, purpose, work, keep_partial=keep_partial)

    monkeypatch.setattr(time_budget, "Job", job)
    found = within(cornell, 20.0, (24, 24))
    assert found.options == first_options(eclat.IrradianceCache()) and machine.now == 19.0


def test_a_first_solve_that_takes_too_long_is_stopped(cornell: eclat.Scene) -> None:
    """On a busy machine the first solve alone could take many times the whole time."""
    with pytest.warns(
        eclat.EclatWarning, match=r"^time: even a coarse solve takes too long; it is stopped after .* s with"
    ):
        solution = within(cornell, time_budget.clock.perf_counter() - 1, (512, 512))
    assert not solution.complete
    with pytest.warns(eclat.EclatWarning, match="this cache is incomplete"):
        image = eclat.render(cornell, solution, samples=1, size=(8, 8), check=False)
    assert np.isfinite(image.pixels).all() and image.pixels.mean() > 0.05


def test_without_time_for_a_record_paths_are_traced(cornell: eclat.Scene) -> None:
    late = Care(deadline=time_budget.clock.perf_counter() - 1)
    with pytest.warns(eclat.EclatWarning, match="it is stopped after .* s with 0 records"):
        prepared = eclat.IrradianceCache().prepare(cornell, View(cornell.cameras[0], (512, 512)), Work(), late)
    assert prepared.options.name == "path"
