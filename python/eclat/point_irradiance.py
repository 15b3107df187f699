# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb irradiance: how much light falls on points."""

from __future__ import annotations

import math
import time as clock
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.bridge.arguments import checked_max_depth, checked_samples, checked_seed, points_with_normals, thread_count
from eclat.bridge.compiled import compiled
from eclat.bridge.running import ProgressReport, run
from eclat.errors import EclatError, did_you_mean
from eclat.options import Direct, IrradianceCache, Options, Path, PhotonMap, Radiosity
from eclat.photons import Photons, trace
from eclat.radiosity import RadiositySolution, solve_radiosity
from eclat.scene import FloatArray, Scene
from eclat.solution import Solution, core_options
from eclat.solving import solve

Component = Literal["total", "direct", "indirect"]

RAYS_OF_TRACED_PATH, RAYS_OF_GATHER_PATH = 7, 2.5
"""Rays of a path that is traced to its end, shadow rays included, and of one that ends in a far record. Counted in the
Cornell box; darker rooms have shorter paths, so that both methods cost less there."""

PATHS_OF_POINT = 8192
"""Of a point that is gathered by paths alone, to err by about a hundredth; their error falls with the square root."""


def paths_for_few(count: int, max_error: float) -> int | None:
    """Paths per point where fewer rays gather all points by paths than records would take; None where records pay.

    The rule counts rays, so that the choice is the same on every machine: records first need their far records, which
    cost the same for one point as for thousands.
    """
    options = core_options(IrradianceCache(max_error=max_error))
    paths = max(1, round(PATHS_OF_POINT * (0.01 / max_error) ** 2))
    far = options.far_records * math.pi * options.far_rows**2 * RAYS_OF_TRACED_PATH
    gather = math.pi * options.rows**2 * RAYS_OF_GATHER_PATH
    return paths if count * paths * RAYS_OF_TRACED_PATH < far + count * gather else None


def irradiance(
    scene: Scene,
    points: FloatArray,
    normals: FloatArray,
    what: Solution | Photons | RadiositySolution | Options | None = None,
    *,
    component: Component = "total",
    max_error: float = 0.01,
    samples: int = 1024,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
    statistics: dict[str, float] | None = None,
) -> NDArray[np.float32]:
    """Irradiance at `points` on the side of their `normals`: (N, 3) RGB in W·m⁻², lux where the scene is photometric.

    Parameters
    ----------
    points, normals : (N, 3) positions in metres and directions of any length. Points need not lie on a surface.
    what : a Solution or Photons, the options of a method, or None: irradiance caching, or paths where the points are so few that
        these take fewer rays (`paths_for_few`).

        ====================  ==================================================================================
        `Solution`            indirect light is read from its records; a point that none of them serves is
                              gathered, its rays ending in the Solution's far records
        `IrradianceCache`     the same, with records solved for these points first
        `Photons`             each point is gathered by `samples` paths that end in the photons' irradiance
        `PhotonMap`           the same, with photons traced first
        `RadiositySolution`   each point is gathered by `samples` paths that end in the patches' irradiance
        `Radiosity`           the same, with the scene solved first
        `Path`                unbiased: each point is gathered by `samples` paths
        `Direct`              light straight from lights only
        ====================  ==================================================================================

    component : "direct" is what arrives straight from lights, the environment and suns included; "indirect" the rest;
        the same for every method.
    max_error : relative error of indirect light that None aims at.
    samples : of the lights, and paths of `Path`, per point.
    max_depth : edges of a path, as for pictures: 2 is direct light, −1 unlimited. A Solution must have been solved
        with the same.
    statistics : a dict that is filled with `points`, `served` (by records) and `gathered` (both only where a cache
        was read), `paths` per point (only where None chose them), `rays` and `seconds`.

    Raises
    ------
    EclatError : arrays that do not fit or are not finite, a Solution of another scene or depth, arguments out of range.

    Examples
    --------
    >>> import eclat
    >>> scene = eclat.load("furnace")  # closed, emits 1, reflects half: its radiance is 2 everywhere
    >>> E = eclat.irradiance(scene, [[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    >>> bool(abs(E[0, 0] / (2 * np.pi) - 1) < 0.02)
    True
    """
    if component not in get_args(Component):
        known = get_args(Component)
        raise EclatError(
            f"component must be one of {', '.join(known)}, got {component!r}{did_you_mean(str(component), known)}"
        )
    started = clock.perf_counter()
    places, sides = points_with_normals(points, normals)
    common = checked_seed(seed), thread_count(threads)
    checked_samples(samples)
    depth = 2 if isinstance(what, Direct) else checked_max_depth(max_depth)
    counts: dict[str, float] = {"points": float(len(places)), "rays": 0.0}
    indirect = component != "direct" and (depth < 0 or depth > 2)
    if what is None:
        what = IrradianceCache(max_error=max_error)
        paths = paths_for_few(len(places), max_error)
        if indirect and paths is not None:
            what, samples = Path(), max(samples, paths)
            counts["paths"] = float(samples)
    if isinstance(what, PhotonMap):
        what = trace(scene, what, max_depth=depth, seed=seed, threads=common[-1], progress=progress)
        counts["rays"] += what.statistics["rays"]
    if isinstance(what, Radiosity):
        what = solve_radiosity(scene, what, max_depth=depth, seed=seed, threads=common[-1], progress=progress)
        counts["rays"] += what.statistics["rays"]
    if isinstance(what, Solution | Photons | RadiositySolution):
        what.check(scene, max_depth)
    if indirect and isinstance(what, IrradianceCache):
        what = solve(
            scene, what, points=(places, sides), max_depth=depth, seed=seed, threads=threads, progress=progress
        )
        counts["rays"] += what.statistics["rays"]
    prepared = compiled(scene)
    positions, directions = prepared.to_core(places), np.ascontiguousarray(sides, np.float32)
    number = get_args(Component).index(component)
    counted = _core.Progress()
    if indirect and isinstance(what, Solution):
        caches = what.core()
        settings = core_options(what.options, max_depth=depth, seed=seed, threads=common[-1])
        result, served, gathered = run(
            "irradiance",
            lambda p: _core.irradiance_from_caches(
                prepared.core, positions, directions, caches, settings, p, number, samples, *common
            ),
            progress,
            counted,
        )
        counts |= {"served": float(served), "gathered": float(gathered)}
    elif indirect and isinstance(what, Photons):
        maps = what.core(scene, gather=True, threads=common[-1], progress=progress)
        result = run(
            "irradiance",
            lambda p: _core.irradiance_by_photons(
                prepared.core, positions, directions, maps, p, number, samples, depth, *common
            ),
            progress,
            counted,
        )
    elif indirect and isinstance(what, RadiositySolution):
        field = what.core(scene, threads=common[-1])
        result = run(
            "irradiance",
            lambda p: _core.irradiance_by_radiosity(
                prepared.core, positions, directions, field, p, number, samples, depth, *common
            ),
            progress,
            counted,
        )
    else:
        result = run(
            "irradiance",
            lambda p: _core.irradiance_by_paths(
                prepared.core, positions, directions, p, number, samples, depth, *common
            ),
            progress,
            counted,
        )
    counts["rays"] += float(counted.rays)
    if statistics is not None:
        statistics.update(counts, seconds=clock.perf_counter() - started)
    return np.asarray(result, np.float32).reshape(-1, 3)
