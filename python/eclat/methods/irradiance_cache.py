# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The method `irradiance-cache`, which interpolates diffuse indirect light between records."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from eclat.bridge.compiled import compiled
from eclat.methods.method import OverTime, Prepared, Solved
from eclat.methods.path import Path
from eclat.methods.records.moving import solve_over_time
from eclat.methods.records.moving_solution import load_over_time
from eclat.methods.records.options import RecordOptions
from eclat.methods.records.solution import Solution
from eclat.methods.records.solving import refine_records, solve_records
from eclat.methods.records.time_budget import solve_within
from eclat.methods.work import Care, Purpose, Times, Work
from eclat.scene import Scene


@dataclass(frozen=True)
class IrradianceCache(RecordOptions):
    """Irradiance caching: diffuse indirect light is interpolated between records, and all other light is traced.

    `max_error` determines how close the near and far records are to each other, and how many rays they take. A field
    that is None is computed from `max_error`.
    """

    name: ClassVar[str] = "irradiance-cache"
    cannot: ClassVar[str] = (
        "Only indirect light on diffuse surfaces is cached; glossy reflections are traced, with noise. Indirect shadows that "
        "are narrower than the radius of a record are blurred. Caustics of small lamps are found only by chance, and those "
        "of point, spot and directional lights are missing."
    )
    solved: ClassVar[type[Solved] | None] = Solution

    def solve(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Solution:
        care = care or Care()
        if care.deadline is not None:
            compiled(scene)  # The conversion must not count in the measured time of rays.
            return solve_within(scene, self, care.deadline, purpose, work, care)
        return solve_records(scene, self, purpose, work, care)

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        """Prepare the scene for a purpose. If the time of `care.deadline` is too short for a single record, paths replace
        the records: one sample of them is several times as fast as one that looks for records in vain.
        """
        solution = self.solve(scene, purpose, work, care)
        if care is not None and care.deadline is not None and not solution.statistics["records"]:
            return Path().prepare(scene, purpose, work)
        return solution

    @property
    def shares_over_time(self) -> bool:
        return not self.far_photons  # Photons at the ends of gather rays belong to one state of the scene.

    def solve_over_time(self, times: Times, work: Work) -> OverTime:
        return solve_over_time(self, times, work)

    def load_over_time(self, path: str | os.PathLike[str], times: Times, work: Work) -> OverTime:
        return load_over_time(path, self, times, work.max_depth)

    def refine(
        self, solved: Solved, scene: Scene, purpose: Purpose, work: Work, care: Care, max_error: float | None
    ) -> Solution:
        assert isinstance(solved, Solution)
        return refine_records(solved, scene, purpose, work, care, max_error)

    def at_effort(self, share: float, max_error: float) -> Self:
        return replace(self, max_error=max_error)
