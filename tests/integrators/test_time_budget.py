# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What a given time chooses is told, and made again without a clock. No time is asserted: the clock here is a fake."""

from __future__ import annotations

from itertools import pairwise

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


class Clock:
    """Every look takes a second."""

    def __init__(self) -> None:
        self.now = 0.0

    def perf_counter(self) -> float:
        self.now += 1.0
        return self.now


def test_more_time_makes_finer_records(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for deadline in (2.5, 8.0, 40.0):
        monkeypatch.setattr(time_budget, "clock", Clock())
        solution = time_budget.solve_within(cornell, eclat.IrradianceCache(), deadline, check=False, size=(8, 8))
        found.append(solution)
    settings = [core_options(solution.options) for solution in found]
    # Half of the half second that is left is less than the first solve took: that is all there is.
    assert found[0].options == time_budget.first_options(eclat.IrradianceCache())
    for coarse, fine in pairwise(settings):
        assert fine.spacing < coarse.spacing
        assert fine.rows > coarse.rows
    # What was foreseen: 0.45 of 38 s at the rate of the first solve; laws are rough.
    wanted = 0.45 * 38 * found[0].statistics["rays"]
    assert wanted / 4 < found[2].statistics["rays"] - found[0].statistics["rays"] < 2 * wanted
