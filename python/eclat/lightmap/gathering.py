# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The light of each texel, gathered by any method at points of the texel that a viewer may see."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from eclat.bridge.arguments import thread_count
from eclat.bridge.running import ProgressReport
from eclat.lightmap.probes import buried_or_behind
from eclat.lightmap.solids import Mask
from eclat.lightmap.texels import Corners, Texels, at_texel_points
from eclat.methods import Direct, Path, Source
from eclat.methods.work import AtPoints, Work
from eclat.scene import FloatArray, Scene
from eclat.verbs.irradiance import Component, asks_for_indirect, irradiance

DARK = 0.05
"""Share of the usual irradiance below which a texel counts as dark, since it lies behind a surface."""

DOUBTFUL_PATHS = 16
"""For a point that may be dark behind a surface."""

USUAL_POINTS = 1000
"""Points that tell what is usual in the scene."""


@dataclass(frozen=True)
class Settings:
    """The arguments of `eclat.irradiance` beside points and method. `samples` is the number per texel."""

    component: Component
    samples: int
    max_depth: int
    seed: int
    threads: int | None
    progress: ProgressReport | None

    def keywords(self, component: Component | None = None, samples: int | None = None) -> dict[str, Any]:
        """The values as keyword arguments, some of them replaced."""
        return {
            "component": self.component if component is None else component,
            "samples": self.samples if samples is None else max(1, samples),
            "max_depth": self.max_depth,
            "seed": self.seed,
            "threads": self.threads,
            "progress": self.progress,
        }


@dataclass(frozen=True, eq=False)
class Points:
    """Sample points (N, n, 3) of N texels, the first at its centre, the others in a grid: positions, unit normals of
    shading and of triangles; places in the map (N, n, 2)."""

    positions: FloatArray
    normals: FloatArray
    face_normals: FloatArray
    uvs: FloatArray


@dataclass(frozen=True, eq=False)
class Gathered:
    """`values` (N, 3) of texels and the `places` (N, 2) in the map that they are for; `seen` (N,): texels of which a
    viewer may see anything, the others being 0. `counts` holds `rays`, and the errors
    `direct_error` and `estimated_error` as `eclat.irradiance` states them."""

    values: FloatArray
    places: FloatArray
    seen: Mask
    counts: dict[str, float]


def sample_points(corners: Corners, texels: Texels, supersampling: int) -> Points:
    """The centre and `supersampling`² more points of each texel, all moved into its triangle."""
    steps = (np.arange(supersampling) + 0.5) / supersampling
    offsets = [(0.5, 0.5), *((u, v) for v in steps for u in steps)]
    found = [
        at_texel_points(corners, texels, np.column_stack((texels.columns + u, texels.rows + v))) for u, v in offsets
    ]

    def joined(name: str) -> FloatArray:
        return np.stack([getattr(at, name) for at in found], axis=1)

    return Points(joined("positions"), joined("normals"), joined("face_normals"), joined("uvs"))


def in_the_open(scene: Scene, solid: Sequence[Mask], points: Points, settings: Settings) -> Mask:
    """A mask (N, n) of the points that a viewer may see. It excludes points in solids, and dark points behind one-sided
    surfaces, like the foot of a wall that passes through the floor."""
    shape = points.positions.shape[:2]
    places, normals = points.positions.reshape(-1, 3), points.normals.reshape(-1, 3)
    buried, behind = buried_or_behind(scene, solid, places, points.face_normals.reshape(-1, 3), settings.threads)
    doubtful = np.flatnonzero(behind & ~buried)
    others = np.flatnonzero(~behind & ~buried)
    free = ~buried
    if len(doubtful) and len(others):
        # Records may give a point behind a wall the light in front of it. Paths do not make this error.
        asked = np.concatenate((doubtful, others[:: max(1, len(others) // USUAL_POINTS)]))
        keywords = settings.keywords("total", DOUBTFUL_PATHS)
        brightness = irradiance(scene, places[asked], normals[asked], Path(), **keywords).mean(axis=1)
        usual = float(brightness[len(doubtful) :].mean())
        free[doubtful] = brightness[: len(doubtful)] >= DARK * usual
    return free.reshape(shape)


def gather(scene: Scene, source: Source, points: Points, free: Mask, settings: Settings) -> Gathered:
    """The mean irradiance over the points of each texel that are `free`.

    Light from records varies slowly, so one point per texel suffices for it. All points serve light from sources, whose
    shadows have edges.
    """
    spread = free[:, 1:]
    seen = np.asarray(spread.any(axis=1))
    share = spread / np.maximum(spread.sum(axis=1, keepdims=True), 1)
    places = (points.uvs[:, 1:] * share[..., None]).sum(axis=1)
    chosen = np.argmax(free, axis=1)  # This is the centre, or else the first point that is free.
    at = np.flatnonzero(seen), chosen[seen]
    rays = 0.0
    errors: dict[str, float] = {}
    from_records = asks_for_indirect(settings.component, settings.max_depth) and source.options.has_records
    if from_records:
        work = Work(settings.max_depth, settings.seed, thread_count(settings.threads), settings.progress)
        prepared = source.prepare(scene, AtPoints(points.positions[at], points.normals[at]), work)
        if prepared is not source:
            rays += prepared.statistics.get("rays", 0.0)
        source = prepared

    def of_points(which: tuple[np.ndarray, np.ndarray], by: Source, **keywords: Any) -> FloatArray:
        nonlocal rays
        counts: dict[str, float] = {}
        found = irradiance(scene, points.positions[which], points.normals[which], by, statistics=counts, **keywords)
        rays += counts["rays"]
        errors.update({name: counts[name] for name in ("direct_error", "estimated_error") if name in counts})
        return found.astype(np.float64)

    def mean_of(by: Source, component: Component) -> FloatArray:
        where = np.nonzero(spread)
        total = np.zeros((*spread.shape, 3))
        samples = math.ceil(settings.samples / spread.shape[1])
        total[where] = of_points((where[0], where[1] + 1), by, **settings.keywords(component, samples))
        summed: FloatArray = (total * share[..., None]).sum(axis=1)
        # Points of a texel err independently.
        errors["direct_error"] *= math.sqrt(len(share) / max(1, len(where[0])))
        return summed

    values: FloatArray = np.zeros((len(free), 3))
    if not from_records:
        return Gathered(mean_of(source, settings.component), places, seen, {"rays": rays, **errors})
    # Records hold the light of an environment's image: taken apart, both parts would be noisier than their sum.
    apart = settings.component == "total" and scene.environment is None
    component: Component = "indirect" if apart else settings.component
    values[seen] = of_points(at, source, **settings.keywords(component))
    if apart:
        values += mean_of(Direct(), "direct")
    return Gathered(values, places, seen, {"rays": rays, **errors})
