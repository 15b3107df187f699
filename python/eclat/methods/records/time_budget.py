# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How a given time is divided between records, which are as fine as fits, and samples of pixels.

A cheap solve, which looks only at every fourth pixel, tells how many rays a second this scene gets on this machine. A
second one looks at all pixels, or at as many as there is time for. `laws` then say how fine a third one
may be. With records' error falling with time to the power −3/7 and noise with −1/2, both parts weigh about the same at
the best split, so that each gets about half.
"""

from __future__ import annotations

import math
import time as clock
from dataclasses import replace

from eclat.bridge.running import ProgressReport
from eclat.measure.error_estimate import CHECK_SHARE
from eclat.methods.records.laws import RAYS_EXPONENT, finer, first_options
from eclat.methods.records.options import RecordOptions
from eclat.methods.records.solution import Solution
from eclat.methods.records.solving import Job
from eclat.methods.work import Care, Purpose, Work
from eclat.scene import Scene

SHARE_OF_RECORDS = 0.45
"""Share that the last solve and its check get of the time that is left before them."""

SHARE_OF_COVERAGE = 0.7
"""The same as long as records do not lie as close as was asked for: pixels without one take sixteen paths a sample."""

FINEST_STEP = 1 / 64
"""Smallest factor of the error from one solve to the next: the laws say nothing about larger steps."""

RAYS_OF_HALVING = 2.3
"""Factor by which a solve takes more rays when its records lie half as far apart."""

LATEST = 0.8
"""Share of all the time after which an unfinished solve is given up, since laws can be wrong; the solve before it counts."""


def solve_within(
    scene: Scene, options: RecordOptions, deadline: float, purpose: Purpose, work: Work, care: Care
) -> Solution:
    """Records that leave enough of the time until `deadline` (of `time.perf_counter`) for the pixels.

    The options of the Solution hold the numbers that were chosen: with them `solve` makes the same records.
    """
    begun = clock.perf_counter()
    check_share = CHECK_SHARE if care.check else 0.0
    last = Job(scene, purpose, work).solve(first_options(options), 0.0)
    total = last.statistics["rays"]

    def fitting() -> float:
        """The number of rays that there is time for, by the speed of the last solve and without the share of a
        check."""
        left = max(0.0, deadline - clock.perf_counter())
        return left * last.statistics["rays"] / max(clock.perf_counter() - begun, 1e-9) / (1 + check_share)

    timely = replace(work, progress=_until(begun + LATEST * (deadline - begun), work.progress))
    job = Job(scene, purpose, timely)
    try:
        # First the places that are looked at come as close to each other as was asked for, since pixels without records
        # cost the most.
        least, rays, most = last.options.least_pixels, last.statistics["rays"], fitting()
        while least >= 2 * options.least_pixels and rays * RAYS_OF_HALVING <= SHARE_OF_COVERAGE * most:
            least, rays = least / 2, rays * RAYS_OF_HALVING
        finer_fits = rays <= SHARE_OF_RECORDS / 2 * most
        if least < last.options.least_pixels:
            begun = clock.perf_counter()
            covering = replace(last.options, least_pixels=least)
            last = job.solve(covering, 0.0 if finer_fits else check_share)
            total += last.statistics["rays"]
        # Then all settings become finer.
        if finer_fits:
            ratio = (last.statistics["rays"] / max(1.0, SHARE_OF_RECORDS * fitting())) ** (1 / RAYS_EXPONENT)
            ratio = min(1.0, max(FINEST_STEP, ratio))
            # Places lie at steps of powers of two: the next finer one only where there is time for all of it.
            steps = math.floor(math.log2(1 / ratio) + 1e-6)
            fine = replace(finer(last.options, ratio), least_pixels=max(0.25, least / 2**steps))
            last = job.solve(fine, check_share)
            total += last.statistics["rays"]
    except _LateError:
        pass
    last.statistics["rays"] = total
    return last


class _LateError(Exception):
    """Raised if a solve takes longer than the time that is left."""


def _until(latest: float, report: ProgressReport | None) -> ProgressReport:
    """A `report` that also stops the work when the deadline has passed."""

    def timely(phase: str, fraction: float, statistics: dict[str, float]) -> None:
        if clock.perf_counter() > latest:
            raise _LateError
        if report is not None:
            report(phase, fraction, statistics)

    return timely
