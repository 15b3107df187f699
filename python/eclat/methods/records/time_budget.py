# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The division of a given time between the records and the samples of pixels.

A cheap first solve, which places records at every fourth pixel only, measures the rays per second for this scene and
machine. A second solve places records at all pixels, or at as many as there is time for. The scaling laws (`laws`) then
give the options of the finest third solve that fits into the time. The error of records is proportional to time^(−3/7),
and noise to time^(−1/2); the best division gives about half of the time to each.
"""

from __future__ import annotations

import math
import time as clock
from dataclasses import replace

from eclat.bridge.running import ProgressReport
from eclat.errors import warn
from eclat.measure.error_estimate import CHECK_SHARE
from eclat.methods.records.laws import RAYS_EXPONENT, core_options, finer, first_options
from eclat.methods.records.options import RecordOptions
from eclat.methods.records.solution import Solution
from eclat.methods.records.solving import Job
from eclat.methods.work import Care, Purpose, Work
from eclat.scene import Scene

SHARE_OF_FIRST = 0.5
"""Share of the whole time after which the first solve is stopped. It usually takes a tenth; on a machine that is busy with
other work, or for a very short time, it would take all of it, and more."""

SHARE_OF_RECORDS = 0.45
"""Share of the remaining time that the last solve and its check may take."""

SHARE_OF_COVERAGE = 0.7
"""Share of the remaining time that the second solve may take. It is larger, because pixels without records take sixteen
paths per sample."""

FINEST_STEP = 1 / 64
"""Smallest factor by which one solve may multiply the error of the solve before; for larger steps the scaling laws are
not reliable."""

RAYS_OF_HALVING = 2.3
"""Factor by which the number of rays of a solve increases if the distance of its records is halved."""

LATEST = 0.8
"""Share of the whole time after which an unfinished solve is abandoned, because the scaling laws can be wrong; the
solve before it is then used."""


def solve_within(
    scene: Scene, options: RecordOptions, deadline: float, purpose: Purpose, work: Work, care: Care
) -> Solution:
    """Solve records that leave enough of the time until `deadline`, a value of `time.perf_counter`, for the pixels.

    The options of the Solution hold the numbers that were chosen; `solve` makes the same records with them.
    """
    begun = clock.perf_counter()
    check_share = CHECK_SHARE if care.check else 0.0
    soon = replace(work, progress=_until(begun + SHARE_OF_FIRST * (deadline - begun), work.progress))
    try:
        last = Job(scene, purpose, soon, keep_partial=True).solve(first_options(options), 0.0)
    except _LateError as late:
        return _unfinished(late)
    total = last.statistics["rays"]

    def fitting() -> float:
        """Return the number of rays for which there is time at the speed of the last solve, leaving time for a
        check."""
        left = max(0.0, deadline - clock.perf_counter())
        return left * last.statistics["rays"] / max(clock.perf_counter() - begun, 1e-9) / (1 + check_share)

    timely = replace(work, progress=_until(begun + LATEST * (deadline - begun), work.progress))
    job = Job(scene, purpose, timely)
    try:
        # First, records are placed as densely as the options request, because pixels without records take the most
        # time.
        wanted, first = (core_options(each).least_pixels for each in (options, last.options))
        least, rays, most = first, last.statistics["rays"], fitting()
        while least >= 2 * wanted and rays * RAYS_OF_HALVING <= SHARE_OF_COVERAGE * most:
            least, rays = least / 2, rays * RAYS_OF_HALVING
        finer_fits = rays <= SHARE_OF_RECORDS / 2 * most
        if least < first:
            begun = clock.perf_counter()
            covering = replace(last.options, least_pixels=least)
            last = job.solve(covering, 0.0 if finer_fits else check_share)
            total += last.statistics["rays"]
        # Then all options become finer.
        if finer_fits:
            ratio = (last.statistics["rays"] / max(1.0, SHARE_OF_RECORDS * fitting())) ** (1 / RAYS_EXPONENT)
            ratio = min(1.0, max(FINEST_STEP, ratio))
            # The distance of positions is a power of two, so a finer one is used only if there is time for all of its
            # positions.
            steps = math.floor(math.log2(1 / ratio) + 1e-6)
            fine = replace(finer(last.options, ratio), least_pixels=max(0.25, least / 2**steps))
            last = job.solve(fine, check_share)
            total += last.statistics["rays"]
    except _LateError:
        pass
    last.statistics["rays"] = total
    return last


class _LateError(TimeoutError):
    """Raised if a solve takes longer than the time that is left."""


def _unfinished(late: _LateError) -> Solution:
    """Return what the first solve had finished when it was stopped, and warn: it may be nothing at all."""
    solution = getattr(late, "partial", None)
    assert isinstance(solution, Solution)
    warn(
        f"time: even a coarse solve takes too long; it is stopped after {solution.statistics['seconds']:.2g} s with "
        f"{solution.statistics['records']:.0f} records, and paths are traced where records are missing"
    )
    return solution


def _until(latest: float, report: ProgressReport | None) -> ProgressReport:
    """Wrap `report` in a progress function that also stops the work after the time `latest`."""

    def timely(phase: str, fraction: float, statistics: dict[str, float]) -> None:
        if clock.perf_counter() > latest:
            raise _LateError
        if report is not None:
            report(phase, fraction, statistics)

    return timely
