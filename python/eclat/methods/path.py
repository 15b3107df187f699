# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Path tracing, which is unbiased and therefore the reference for all other methods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from eclat.methods.method import Method, Prepared
from eclat.methods.ranges import check_range, check_types
from eclat.methods.traced import ROULETTE_DEPTH, Traced
from eclat.methods.work import Care, Purpose, Work
from eclat.scene import Scene


@dataclass(frozen=True)
class Path(Method):
    """Unbiased path tracing: the reference."""

    name: ClassVar[str] = "path"
    cannot: ClassVar[str] = (
        "Caustics of small lamps are met by chance; those of point, spot and directional lights never, so they are missing. "
        "Nothing else is wrong but noise."
    )

    roulette_depth: int = ROULETTE_DEPTH
    """Number of edges after which a path may be ended at random (1 or more)."""

    def __post_init__(self) -> None:
        check_types(self)
        check_range(self, "roulette_depth", 1, 10**6)

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        return Traced(self, roulette_depth=self.roulette_depth)
