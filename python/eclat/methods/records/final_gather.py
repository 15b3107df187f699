# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records that are read only by paths that have gone on from a matte surface, as in a final gather [Reichert92].

What a record gets wrong then reaches a pixel only as a small part of the light that its paths collect: it is averaged over the
surfaces that they meet and multiplied by an albedo. The price is the noise of paths with one scattering more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from eclat import _core
from eclat.methods.method import Method, Prepared
from eclat.methods.work import Work
from eclat.scene import Scene

if TYPE_CHECKING:
    from eclat.methods.records.solution import Solution


@dataclass(frozen=True, eq=False)
class FinalGather(Prepared):
    """The records of a solution, read after a matte surface. The probes of a picture measure what is left of their errors."""

    options: Method
    statistics: dict[str, float]
    solution: Solution

    @property
    def errs_by_noise_alone(self) -> bool:
        return True

    def radiance_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        return self.solution.radiance_estimator(scene, work, gather_first=True)

    def reference_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        return self.solution.reference_estimator(scene, work)

    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        return self.solution.point_estimator(scene, work)
