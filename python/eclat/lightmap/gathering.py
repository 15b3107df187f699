# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Computing the light of each texel, by any method, at those points of the texel that a viewer may see."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from eclat.bridge.arguments import thread_count
from eclat.bridge.running import ProgressReport
from eclat.lightmap.probes import inside_or_behind
from eclat.lightmap.solids import Mask
from eclat.lightmap.stages import stage
from eclat.lightmap.texels import Corners, Texels, at_texel_points
from eclat.measure.error_estimate import CHANCE_ENTRIES
from eclat.methods import Direct, Path, Source
from eclat.methods.work import AtPoints, Work
from eclat.scene import FloatArray, Scene
from eclat.verbs.irradiance import asks_for_indirect, irradiance_at
from eclat.verbs.light_at_points import Component

DARK_SHARE = 0.05
"""Irradiance, relative to the mean of the scene, below which a point that may lie behind a surface is treated as lying
there."""

CHECK_PATHS = 16
"""Number of paths by which the irradiance of a point that may lie behind a surface is estimated."""

REFERENCE_POINTS = 1000
"""Approximate number of other points from which the mean irradiance of the scene is estimated."""


@dataclass(frozen=True)
class Settings:
    """The arguments of `eclat.irradiance` other than the points and the method. `samples` is the number per texel."""

    component: Component
    samples: int
    max_depth: int
    seed: int
    threads: int | None
    progress: ProgressReport | None

    def keywords(self, component: Component | None = None, samples: int | None = None) -> dict[str, Any]:
        """Return the values as keyword arguments, with the component and the number of samples replaced if given."""
        return {
            "component": self.component if component is None else component,
            "samples": self.samples if samples is None else max(1, samples),
            "max_depth": self.max_depth,
            "seed": self.seed,
            "threads": self.threads,
            "progress": self.progress,
        }


@dataclass(frozen=True, eq=False)
class TexelPoints:
    """The n sample points of each of N texels: the first is at the centre, the others form a grid.

    `positions`, the unit shading `normals` and the unit `face_normals` are (N, n, 3); the positions `uvs` in the map,
    in texels, are (N, n, 2).
    """

    positions: FloatArray
    normals: FloatArray
    face_normals: FloatArray
    uvs: FloatArray


@dataclass(frozen=True, eq=False)
class GatheredTexels:
    """The irradiance of N texels.

    `values` (N, 3) is the irradiance at the positions `places` (N, 2) in the map, in texels. `seen` (N,) is False for
    texels that no viewer can see, whose values are 0. `source` is what computed the light: the solution, if records were
    solved for it. `counts` holds the number of `rays`, and the errors
    `direct_error` and `estimated_error` that `eclat.irradiance` states.
    """

    values: FloatArray
    places: FloatArray
    seen: Mask
    counts: dict[str, float]
    source: Source


def sample_points(corners: Corners, texels: Texels, supersampling: int) -> TexelPoints:
    """Make the sample points of each texel: its centre and a grid of `supersampling`² points, moved into its
    triangle."""
    steps = (np.arange(supersampling) + 0.5) / supersampling
    offsets = [(0.5, 0.5), *((u, v) for v in steps for u in steps)]
    found = [
        at_texel_points(corners, texels, np.column_stack((texels.columns + u, texels.rows + v))) for u, v in offsets
    ]

    def joined(name: str) -> FloatArray:
        return np.stack([getattr(at, name) for at in found], axis=1)

    return TexelPoints(joined("positions"), joined("normals"), joined("face_normals"), joined("uvs"))


def visible_points(scene: Scene, solid: Sequence[Mask], points: TexelPoints, settings: Settings) -> Mask:
    """Compute a mask (N, n) of the points that a viewer may see.

    It excludes points inside solids, and dark points behind one-sided surfaces, such as those at the foot of a wall
    that passes through the floor. `solid` marks the triangles of each mesh that bound solids.
    """
    shape = points.positions.shape[:2]
    places, normals = points.positions.reshape(-1, 3), points.normals.reshape(-1, 3)
    told = stage(settings.progress, "hidden texels")
    faces = points.face_normals.reshape(-1, 3)
    buried, behind = inside_or_behind(scene, solid, places, faces, settings.threads, told)
    doubtful = np.flatnonzero(behind & ~buried)
    others = np.flatnonzero(~behind & ~buried)
    free = ~buried
    if len(doubtful) and len(others):
        # Paths are used, because records might give a point behind a wall the light in front of the wall.
        asked = np.concatenate((doubtful, others[:: max(1, len(others) // REFERENCE_POINTS)]))
        keywords = settings.keywords("total", CHECK_PATHS)
        found = irradiance_at(scene, places[asked], normals[asked], Path(), statistics={}, **keywords)
        brightness = found.mean(axis=1)
        usual = float(brightness[len(doubtful) :].mean())
        free[doubtful] = brightness[: len(doubtful)] >= DARK_SHARE * usual
    return free.reshape(shape)


def gather(scene: Scene, source: Source, points: TexelPoints, free: Mask, settings: Settings) -> GatheredTexels:
    """Compute the mean irradiance over the points of each texel that are `free`, a mask (N, n).

    Light from records varies slowly, so it is read at one point per texel. Light from sources has shadows with sharp
    edges, so it is averaged over all points.
    """
    spread = free[:, 1:]
    seen = np.asarray(spread.any(axis=1))
    share = spread / np.maximum(spread.sum(axis=1, keepdims=True), 1)
    places = (points.uvs[:, 1:] * share[..., None]).sum(axis=1)
    chosen = np.argmax(free, axis=1)  # This is the centre, or the first free point if the centre is not free.
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
        found = irradiance_at(scene, points.positions[which], points.normals[which], by, statistics=counts, **keywords)
        rays += counts["rays"]
        stated = ("direct_error", "estimated_error", *CHANCE_ENTRIES)
        errors.update({name: counts[name] for name in stated if name in counts})
        return found.astype(np.float64)

    def mean_of(by: Source, component: Component) -> FloatArray:
        where = np.nonzero(spread)
        total = np.zeros((*spread.shape, 3))
        samples = math.ceil(settings.samples / spread.shape[1])
        total[where] = of_points((where[0], where[1] + 1), by, **settings.keywords(component, samples))
        summed: FloatArray = (total * share[..., None]).sum(axis=1)
        # The errors of the points of a texel are independent, so the error of their mean is smaller.
        errors["direct_error"] *= math.sqrt(len(share) / max(1, len(where[0])))
        return summed

    values: FloatArray = np.zeros((len(free), 3))
    if not from_records:
        values = mean_of(source, settings.component)
        return GatheredTexels(values, places, seen, {"rays": rays, **errors}, source)
    # Records include the light of an environment image, so direct and indirect light are computed together then: their
    # sum has less noise than the two parts.
    apart = settings.component == "total" and scene.environment is None
    component: Component = "indirect" if apart else settings.component
    values[seen] = of_points(at, source, **settings.keywords(component))
    if apart:
        values += mean_of(Direct(), "direct")
    return GatheredTexels(values, places, seen, {"rays": rays, **errors}, source)
