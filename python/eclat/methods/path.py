# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The method `path`, path tracing, which is unbiased and therefore the reference for all other methods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.errors import warn
from eclat.measure.error_estimate import LEAST_BY_CHANCE
from eclat.methods.method import Method, Prepared
from eclat.methods.ranges import check_range, check_types
from eclat.methods.traced import ROULETTE_DEPTH, Traced
from eclat.methods.work import AtPoints, Care, Purpose, Work
from eclat.scene import Scene


@dataclass(frozen=True)
class Path(Method):
    """Path tracing: unbiased, and therefore the reference for all other methods."""

    name: ClassVar[str] = "path"
    cannot: ClassVar[str] = (
        "Caustics of small lamps are found only by chance, and those of point, spot and directional lights are missing. "
        "The only other error is noise."
    )

    roulette_depth: int = ROULETTE_DEPTH
    """Number of edges after which Russian roulette may end a path (1 or more)."""

    def __post_init__(self) -> None:
        check_types(self)
        check_range(self, "roulette_depth", 1, 10**6)

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        # At points, rays find light of small lamps by mirrors no better, and whoever asks is told of both (`chance_warning`).
        if not isinstance(purpose, AtPoints) and (missing := missing_caustics(scene, work)):
            warn(f"path: {missing}; no path can find this light, so it is missing; use photon-map to compute it")
        return Traced(self, roulette_depth=self.roulette_depth)


def missing_caustics(scene: Scene, work: Work) -> str:
    """Describe how much of the light of point, spot and directional lights reaches surfaces by way of mirrors or glass,
    because no path from the camera or from a point can find it. The text is empty if that is little. The share is
    measured by a few photons, which are traced from the lights.
    """
    if not scene.lights:
        return ""
    core, progress = compiled(scene).core, _core.Progress()
    unseen = _core.focused_light(core, work.max_depth, work.seed, work.threads, progress).unseen
    if not unseen > LEAST_BY_CHANCE:
        return ""
    share = f"{100 * unseen:.2g} % of the light of the lamps"
    return f"{share} comes from point, spot or directional lights by way of mirrors or glass"
