# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `irradiance`, which computes how much light falls on points."""

from __future__ import annotations

import math
import os
import time as clock
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat import _core
from eclat.bridge.arguments import (
    checked_max_depth,
    checked_max_error,
    checked_samples,
    checked_seed,
    points_with_normals,
    thread_count,
)
from eclat.bridge.compiled import compiled
from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError, did_you_mean, warn
from eclat.measure.error_estimate import CHANCE_ENTRIES, chance_warning, light_by_chance
from eclat.measure.metrics import RELATIVE_C
from eclat.measure.photometry import luminance
from eclat.methods import Direct, IrradianceCache, Method, Path, Source, as_method
from eclat.methods.records.laws import core_options
from eclat.methods.work import AtPoints, Work
from eclat.scene import Scene
from eclat.stage.staging import staged
from eclat.typed import typed
from eclat.verbs.light_at_points import Component, PointLight, light_at

RAYS_OF_TRACED_PATH, RAYS_OF_GATHER_PATH = 7, 2.5
"""Mean number of rays, shadow rays included, of a path that is traced to its end, and of a path that ends in a far
record. They were counted in the Cornell box; in darker rooms paths are shorter, so both methods cost less."""

PATHS_OF_POINT = 8192
"""Number of paths per point with which the error is about 1 %; the error is proportional to the inverse square root of
this number."""


def paths_for_few(count: int, max_error: float) -> int | None:
    """Return the number of paths per point if tracing paths takes fewer rays than records do, and None otherwise.

    The rule counts rays instead of seconds, so that the choice is the same on every machine. Records first need far
    records, which cost the same for one point as for thousands.
    """
    options = core_options(IrradianceCache(max_error=max_error))
    paths = max(1, round(PATHS_OF_POINT * (0.01 / max_error) ** 2))
    far = options.far_records * math.pi * options.far_rows**2 * RAYS_OF_TRACED_PATH
    gather = math.pi * options.rows**2 * RAYS_OF_GATHER_PATH
    return paths if count * paths * RAYS_OF_TRACED_PATH < far + count * gather else None


@typed
def irradiance(
    scene: Scene | str | os.PathLike[str],
    points: ArrayLike,
    normals: ArrayLike,
    what: Source | type[Method] | str | None = None,
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
    """Compute the irradiance at `points` on the side of their `normals`.

    Parameters
    ----------
    points, normals : (N, 3) positions in metres and directions of any length. Points need not lie on a surface.
    what : a method, its class or its name, a solution, or None. None means irradiance caching, or path tracing if there
        are so few points that paths take fewer rays (`paths_for_few`). If it is a class or a name, the argument
        `max_error` is passed on to the method, provided that the method has an option of that name.

        ====================  ==================================================================================
        `Solution`            Indirect light is read from its records. At points that no record covers, it is
                              gathered by rays that end in the far records of the Solution.
        `IrradianceCache`     The same, with records that are first solved for these points.
        `Photons`             Each point is gathered by `samples` paths, which end in the irradiance of the
                              photons.
        `PhotonMap`           The same, with photons that are traced first.
        `RadiositySolution`   Each point is gathered by `samples` paths, which end in the irradiance of the
                              patches.
        `Radiosity`           The same, with patches that are solved first.
        `Path`                Each point is gathered by `samples` paths, without bias.
        `Direct`              Only light straight from lights is computed.
        ====================  ==================================================================================

    component : the light to compute. "direct" is the light that arrives straight from lights, including the environment
        and suns; "indirect" is all other light; "total" is both. The meaning is the same for every method.
    max_error : wanted relative error of the indirect light, if `what` is None, a class or a name.
    samples : number of samples of the lights per point, and of paths per point with `Path`.
    max_depth : greatest number of edges of a path, as for pictures: 2 is direct light, −1 sets no limit. A solution must
        have been solved with the same value.
    statistics : a dict that is filled with the number of `points`; the numbers of points `served` by records and
        `gathered`, if records were read; the number of `paths` per point, if None chose path tracing; `rays` and
        `seconds`; `direct_error`, the relative error of light straight from lights (one standard deviation, from two
        halves of its samples); `estimated_error`, that of all light, if the error of the records is known; and
        `light_by_chance`, the share of the lamps' light that rays from points find only by chance, by way of mirrors,
        metals or glass, if it is more than 0.5 %. A warning tells of it where no known error does.

    Returns
    -------
    An array (N, 3) float32 of RGB irradiance in W·m⁻², or in lux if the scene is photometric.

    Raises
    ------
    EclatError : the arrays differ in shape or are not finite, a solution belongs to another scene or another
        `max_depth`, or an argument is out of range.

    Examples
    --------
    >>> import eclat
    >>> scene = eclat.load("furnace")  # closed, emits 1, reflects half: its radiance is 2 everywhere
    >>> E = eclat.irradiance(scene, [[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    >>> bool(abs(E[0, 0] / (2 * np.pi) - 1) < 0.02)
    True
    """
    counts: dict[str, float] = {}
    found = irradiance_at(
        scene, points, normals, what, component=component, max_error=max_error, samples=samples, max_depth=max_depth,
        seed=seed, threads=threads, progress=progress, statistics=counts,
    )  # fmt: skip
    if doubt := chance_warning(counts):
        warn(f"irradiance: {doubt}")
    if statistics is not None:
        statistics.update(counts)
    return found


def irradiance_at(
    scene: Scene | str | os.PathLike[str],
    points: ArrayLike,
    normals: ArrayLike,
    what: Source | type[Method] | str | None,
    *,
    component: Component,
    max_error: float = 0.01,
    samples: int,
    max_depth: int,
    seed: int,
    threads: int | None,
    progress: ProgressReport | None = None,
    statistics: dict[str, float],
) -> NDArray[np.float32]:
    """Do what `irradiance` does, but leave it to the caller to warn of light that is found only by chance."""
    checked_component(component)
    scene = staged(scene)
    started = clock.perf_counter()
    places = AtPoints(*points_with_normals(points, normals))
    work = Work(checked_max_depth(max_depth), checked_seed(seed), thread_count(threads), progress)
    checked_samples(samples)
    counts: dict[str, float] = {"points": float(len(places.positions)), "rays": 0.0}
    source = as_method(what, IrradianceCache(max_error=checked_max_error(max_error)), max_error=max_error)
    source.require_match(scene, max_depth)
    if not asks_for_indirect(component, max_depth):
        source = Direct()  # All methods give the same light straight from lights.
    elif what is None and (paths := paths_for_few(len(places.positions), max_error)) is not None:
        source, samples = Path(), max(samples, paths)
        counts["paths"] = float(samples)
    prepared = source.prepare(scene, places, work)
    if prepared is not source:
        counts["rays"] += prepared.statistics.get("rays", 0.0)
    light = light_at(PointLight(scene, prepared, work, component, samples), places, progress)
    if light.served is not None:
        counts |= {"served": float(light.served[0]), "gathered": float(light.served[1])}
    counts["rays"] += float(light.rays)
    counts |= stated_errors(light.irradiance, light.direct_errors, prepared.statistics)
    if "estimated_error" not in counts and not isinstance(source, Direct):
        counts |= found_by_chance(scene, work)
    statistics.update(counts, seconds=clock.perf_counter() - started)
    return np.asarray(light.irradiance, np.float32).reshape(-1, 3)


def stated_errors(
    found: NDArray[np.floating], direct_errors: NDArray[np.floating], solved: dict[str, float]
) -> dict[str, float]:
    """Compute the known errors of irradiance `found` (N, 3), which are relative as in `metrics.relative_rmse`.

    `direct_error` is the error of light straight from lights, from the standard errors `direct_errors` (N,) of its
    luminance at each point. If `solved`, the statistics of the solution, hold the error of the records,
    `estimated_error` is the error of all light; light that records find only by chance makes it that or more, and is
    told by the entries of `light_by_chance`.
    """
    light = luminance(found).astype(np.float64)
    scale = light**2 + RELATIVE_C * float(np.mean(light**2)) if len(light) else light
    relative = np.divide(direct_errors.astype(np.float64) ** 2, scale, out=np.zeros_like(light), where=scale > 0)
    errors = {"direct_error": float(np.sqrt(relative.mean())) if len(light) else 0.0}
    if "estimated_error" in solved:
        errors["estimated_error"] = float(np.hypot(errors["direct_error"], solved["estimated_error"]))
        errors |= {name: solved[name] for name in CHANCE_ENTRIES if name in solved}
    return errors


def found_by_chance(scene: Scene, work: Work) -> dict[str, float]:
    """Return the entries of `light_by_chance` for methods whose error is unknown: light from small lamps by way of mirrors, which
    all of them find at points by rays that meet the lamps by chance or never.
    """
    focused = _core.focused_light(compiled(scene).core, work.max_depth, work.seed, work.threads, _core.Progress())
    return light_by_chance(focused.by_chance, focused.spread)


def asks_for_indirect(component: Component, max_depth: int) -> bool:
    """Return whether indirect light is wanted, and not only light straight from lights."""
    return component != "direct" and (max_depth < 0 or max_depth > 2)


def checked_component(component: str) -> None:
    """Raise EclatError for an unknown component of light."""
    known = get_args(Component)
    if component not in known:
        raise EclatError(
            f"component must be one of {', '.join(known)}, got {component!r}{did_you_mean(str(component), known)}"
        )
