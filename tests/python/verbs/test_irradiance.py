# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records or paths for points: a choice by counts, said in the statistics. What points receive is tested in
tests/methods/test_solve_points.py."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.scenes import build
from eclat.verbs.irradiance import paths_for_few


def test_few_points_are_gathered_by_paths_and_many_by_records() -> None:
    assert paths_for_few(1, 0.01) == 8192
    assert paths_for_few(10_000, 0.01) is None
    # Paths need four times as many for half the error, records only finer ones.
    most = [max(n for n in range(1, 5000) if paths_for_few(n, e) is not None) for e in (0.02, 0.01, 0.005)]
    assert most[0] > most[1] > most[2] > 0


def test_the_choice_is_told_and_right() -> None:
    """In the furnace irradiance is 2 π everywhere."""
    scene = build("furnace")
    told: dict[str, float] = {}
    E = eclat.irradiance(scene, [[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]], statistics=told)
    assert told["paths"] == 8192
    assert "served" not in told
    assert np.asarray(E) == pytest.approx(2 * np.pi, rel=0.02)
    asked: dict[str, float] = {}
    eclat.irradiance(
        scene, [[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]], eclat.IrradianceCache(max_error=0.05), statistics=asked
    )
    assert "paths" not in asked
    assert "served" in asked
