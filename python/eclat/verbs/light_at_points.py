# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Irradiance at points by what a method prepared, in this process or, in ranges of points, on the workers of a farm."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.bridge.running import ProgressReport, run
from eclat.farm.farm import current_farm, share_of
from eclat.farm.worker import Bench
from eclat.methods import Prepared
from eclat.methods.work import AtPoints, Work
from eclat.scene import Scene

Component = Literal["total", "direct", "indirect"]

RANGES_OF_THREAD, FEWEST_POINTS = 4, 64
"""The number of ranges for each thread of a worker, and the least number of points in a range, for which a range takes clearly
longer than its message."""


@dataclass(frozen=True, eq=False)
class PointLight:
    """What all points share."""

    scene: Scene
    prepared: Prepared
    work: Work
    component: Component
    samples: int


@dataclass(frozen=True, eq=False)
class LightAtPoints:
    """The irradiance (N, 3), the standard errors (N,) of the luminance of direct light, how many points a cache served and
    did not, or None where there is none, and the number of rays."""

    irradiance: NDArray[np.float32]
    direct_errors: NDArray[np.float32]
    served: tuple[int, int] | None
    rays: int


@dataclass(frozen=True, eq=False)
class PointRange:
    """Points of which the first has an index."""

    first: int
    places: AtPoints


def light_at(light: PointLight, places: AtPoints, progress: ProgressReport | None) -> LightAtPoints:
    """Compute the light at points, on the current farm if there is one. Ranges do not change the bits."""
    farm, count = current_farm(), len(places.positions)
    if farm is None or count < 2 * FEWEST_POINTS:
        return _of_range(light, PointRange(0, places), light.work.threads, progress)
    parts = min(count // FEWEST_POINTS, RANGES_OF_THREAD * farm.workers.threads())
    cuts = [count * k // parts for k in range(parts + 1)]
    ranges = [
        PointRange(first, AtPoints(places.positions[first:end], places.normals[first:end]))
        for first, end in itertools.pairwise(cuts)
    ]
    shared = replace(light, work=replace(light.work, progress=None, threads=0))
    return _joined(farm.ordered(light_of_range, shared, ranges, share_of(progress, "irradiance")))


def light_of_range(light: PointLight, points: PointRange, bench: Bench) -> LightAtPoints:
    """Compute the light at a range of points on a worker."""
    return _of_range(light, points, bench.threads, bench.progress)


def _of_range(light: PointLight, points: PointRange, threads: int, progress: ProgressReport | None) -> LightAtPoints:
    work = replace(light.work, threads=threads)
    estimator = light.prepared.point_estimator(light.scene, work)
    asked = _core.PointIrradianceOptions(
        component=_core.Component[light.component], samples=light.samples, max_depth=work.max_depth, seed=work.seed,
        threads=threads, first=points.first,
    )  # fmt: skip
    positions = compiled(light.scene).to_core(points.places.positions)
    directions = np.ascontiguousarray(points.places.normals, np.float32)
    counted = _core.Progress()
    found, served, errors = run(
        "irradiance", lambda p: _core.irradiance(positions, directions, estimator, asked, p), progress, counted
    )
    return LightAtPoints(np.asarray(found, np.float32), np.asarray(errors), served, int(counted.rays))


def _joined(parts: Sequence[LightAtPoints]) -> LightAtPoints:
    served = None
    if parts[0].served is not None:
        each = [part.served or (0, 0) for part in parts]
        served = (sum(found for found, _ in each), sum(missed for _, missed in each))
    return LightAtPoints(
        np.concatenate([part.irradiance.reshape(-1, 3) for part in parts]),
        np.concatenate([part.direct_errors for part in parts]),
        served,
        sum(part.rays for part in parts),
    )
