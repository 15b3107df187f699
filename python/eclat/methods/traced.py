# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The result of preparing a method that computes nothing in advance, but traces all light when it is needed."""

from __future__ import annotations

from dataclasses import dataclass, field

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.methods.method import Method, Prepared
from eclat.methods.work import Work
from eclat.scene import Scene

ROULETTE_DEPTH = 5
"""Default number of edges of a path after which Russian roulette may end it."""


@dataclass(frozen=True, eq=False)
class Traced(Prepared):
    """A method that traces paths of at most `most_edges` edges from the camera and from points."""

    options: Method
    most_edges: int = -1
    """Greatest number of edges of a path; −1 sets no limit."""
    roulette_depth: int = ROULETTE_DEPTH
    statistics: dict[str, float] = field(default_factory=dict)

    @property
    def errs_by_noise_alone(self) -> bool:
        return True

    def radiance_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        return _core.path_estimator(
            compiled(scene).core, max_depth=self._depth(work), roulette_depth=self.roulette_depth
        )

    def reference_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        return self.radiance_estimator(scene, work)

    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        return _core.path_point_estimator(compiled(scene).core, max_depth=self._depth(work))

    def _depth(self, work: Work) -> int:
        limits = [depth for depth in (work.max_depth, self.most_edges) if depth >= 0]
        return min(limits, default=-1)
