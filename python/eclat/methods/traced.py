# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Methods without preparation, which trace all light on request."""

from __future__ import annotations

from dataclasses import dataclass, field

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.methods.method import Method, Prepared
from eclat.methods.work import Work
from eclat.scene import Scene

ROULETTE_DEPTH = 5
"""Edges of a path before it may be ended at random, where no option says otherwise."""


@dataclass(frozen=True, eq=False)
class Traced(Prepared):
    """Camera paths and gathers at points, with at most `most_edges` edges."""

    options: Method
    most_edges: int = -1
    """−1 unlimited."""
    roulette_depth: int = ROULETTE_DEPTH
    statistics: dict[str, float] = field(default_factory=dict)

    def radiance_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        return _core.path_estimator(
            compiled(scene).core, max_depth=self._depth(work), roulette_depth=self.roulette_depth
        )

    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        return _core.path_point_estimator(compiled(scene).core, max_depth=self._depth(work))

    def _depth(self, work: Work) -> int:
        limits = [depth for depth in (work.max_depth, self.most_edges) if depth >= 0]
        return min(limits, default=-1)
