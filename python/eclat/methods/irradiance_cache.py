# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Irradiance caching: diffuse indirect light from records."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Self

from eclat.bridge.compiled import compiled
from eclat.methods.method import Solved
from eclat.methods.records.options import RecordOptions
from eclat.methods.records.solution import Solution
from eclat.methods.records.solving import refine_records, solve_records
from eclat.methods.records.time_budget import solve_within
from eclat.methods.work import Care, Purpose, Work
from eclat.scene import Scene


@dataclass(frozen=True)
class IrradianceCache(RecordOptions):
    """Irradiance caching: diffuse indirect light comes from records, and the rest is traced.

    `max_error` determines the spacing and the rays of near and far records. A field that is None takes the value that
    follows from `max_error`.
    """

    name: ClassVar[str] = "irradiance-cache"
    cannot: ClassVar[str] = (
        "Only indirect light on diffuse surfaces is cached; glossy reflections are traced, with noise. Indirect shadows "
        "narrower than a record's radius are blurred. Caustics of small lamps are met by chance, those of point, spot and "
        "directional lights are missing."
    )
    solved: ClassVar[type[Solved] | None] = Solution

    def solve(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Solution:
        care = care or Care()
        if care.deadline is not None:
            compiled(scene)  # before a clock looks at what rays take
            return solve_within(scene, self, care.deadline, purpose, work, care)
        return solve_records(scene, self, purpose, work, care)

    def refine(
        self, solved: Solved, scene: Scene, purpose: Purpose, work: Work, care: Care, max_error: float | None
    ) -> Solution:
        assert isinstance(solved, Solution)
        return refine_records(solved, scene, purpose, work, care, max_error)

    def at_effort(self, share: float, max_error: float) -> Self:
        return replace(self, max_error=max_error)
