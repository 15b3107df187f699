# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How much of a given time goes into records: as fine ones as fit, the rest is left to samples of pixels.

A cheap solve tells how many rays a second this scene gets on this machine. The laws of `refining` then say how fine a
second solve may be. With records' error falling with time to the power −3/7 and noise with −1/2, both parts weigh about
the same at the best split, so that each gets about half.
"""

from __future__ import annotations

import time as clock
from dataclasses import replace
from typing import Any

from eclat.error_estimate import CHECK_SHARE
from eclat.options import IrradianceCache
from eclat.refining import RAYS_EXPONENT, finer
from eclat.scene import Scene
from eclat.solution import Solution, core_options
from eclat.solving import solve

SHARE_OF_RECORDS = 0.45
"""Of the time that is left after the first solve, the check included."""

FINEST_STEP = 1 / 64
"""Of the error from the first solve to the second: beyond it laws say nothing."""


def first_options(options: IrradianceCache) -> IrradianceCache:
    """Of the cheap solve."""
    coarse = core_options(replace(options, max_error=0.08, spacing=None, rows=None))
    return replace(options, spacing=coarse.spacing, rows=coarse.rows, far_records=min(options.far_records, 500))


def solve_within(scene: Scene, options: IrradianceCache, deadline: float, *, check: bool, **keywords: Any) -> Solution:
    """Records that leave enough of the time until `deadline` (of `time.perf_counter`) for the pixels.

    The options of the Solution hold the numbers that were chosen: with them `solve` makes the same records.
    """
    started = clock.perf_counter()
    first = solve(scene, first_options(options), check=False, **keywords)
    now = clock.perf_counter()
    rate = first.statistics["rays"] / max(now - started, 1e-9)
    affordable = SHARE_OF_RECORDS * max(0.0, deadline - now) * rate / (1 + CHECK_SHARE * check)
    if affordable <= first.statistics["rays"]:
        return first
    ratio = max(FINEST_STEP, (first.statistics["rays"] / affordable) ** (1 / RAYS_EXPONENT))
    second = solve(scene, finer(first.options, ratio), check=check, **keywords)
    second.statistics["rays"] += first.statistics["rays"]
    return second
