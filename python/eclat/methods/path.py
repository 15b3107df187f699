# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Path tracing, which is unbiased and therefore the reference for all other methods."""

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
        if scene.lights:
            _warn_of_unseen_light(scene, work)
        return Traced(self, roulette_depth=self.roulette_depth)


def _warn_of_unseen_light(scene: Scene, work: Work) -> None:
    """Points and spots by mirrors: photons tell how much light no path from the eye can find."""
    _, unseen = _core.focused_light(compiled(scene).core, work.max_depth, work.seed, work.threads, _core.Progress())
    if unseen > LEAST_BY_CHANCE:
        warn(
            f"{100 * unseen:.2g} % of the light of lamps is that of points, spots or directions by mirrors or glass: no path "
            "finds it, and it is missing here; photon-map has it"
        )
