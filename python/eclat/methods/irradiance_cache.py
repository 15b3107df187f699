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
from eclat.methods.work import Care, Purpose, Times, View, Work
from eclat.scene import Scene

GATHERED_ERROR = 0.02
"""Least `max_error` for which a denoised picture is a final gather. In furnished rooms this takes about the same time as records
that are read at sight, without their blotches; for smaller errors it takes more samples than records save."""

GATHERED_WIDTH = 80
"""The picture's longer side over the lower bound of the radius of records that only a final gather reads. These records are not
seen, so pixels say nothing about them: in `living-room` a tenth of the records left the error of the picture as it was."""


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

    final_gather: bool | None = None
    """Whether the paths of a picture read records only after they have gone on from a matte surface, so that errors of records
    are averaged and not seen, for more noise. None means True for pictures that are denoised and whose `max_error` is 0.02 or
    more, if neither `time` nor `refine` is given. If `least_pixels` is None, it is then an eightieth of the picture's longer
    side. A solution that `solve` returned is always read at sight."""

    def solve(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Solution:
        care, options = care or Care(), replace(self, final_gather=bool(self.final_gather))
        if care.deadline is not None:
            compiled(scene)  # The conversion must not count in the measured time of rays.
            return solve_within(scene, options, care.deadline, purpose, work, care)
        return solve_records(scene, options, purpose, work, care)

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        """Prepare the scene for a purpose. If the time of `care.deadline` is too short for a single record, paths replace
        the records: one sample of them is several times as fast as one that looks for records in vain.
        """
        care = care or Care()
        if isinstance(purpose, View) and self._gathers(care):
            return self._for_gathering(purpose).solve(scene, purpose, work, care).final_gather()
        solution = self.solve(scene, purpose, work, care)
        if care.deadline is not None and not solution.statistics["records"]:
            return Path().prepare(scene, purpose, work)
        return solution

    def _gathers(self, care: Care) -> bool:
        if self.final_gather is not None:
            return self.final_gather
        at_will = care.deadline is None and not care.refine
        return care.denoised and at_will and self.max_error >= GATHERED_ERROR

    def _for_gathering(self, view: View) -> Self:
        """Return the options of records that only a final gather reads. Pictures keep them, so that they can be repeated."""
        least = self.least_pixels
        if least is None:
            least = min(max(1.0, max(view.size) / GATHERED_WIDTH), self.largest_pixels)
        return replace(self, final_gather=True, least_pixels=least)

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
