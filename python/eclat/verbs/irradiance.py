# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb irradiance: how much light falls on points."""

from __future__ import annotations

import math
import os
import time as clock
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

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
from eclat.bridge.running import ProgressReport, run
from eclat.errors import EclatError, did_you_mean
from eclat.measure.metrics import RELATIVE_C
from eclat.measure.photometry import luminance
from eclat.methods import Direct, IrradianceCache, Method, Path, Source, as_method
from eclat.methods.records.laws import core_options
from eclat.methods.work import AtPoints, Work
from eclat.scene import FloatArray, Scene
from eclat.stage.staging import staged

Component = Literal["total", "direct", "indirect"]

RAYS_OF_TRACED_PATH, RAYS_OF_GATHER_PATH = 7, 2.5
"""Rays of a path that is traced to its end, shadow rays included, and of one that ends in a far record. Counted in the
Cornell box; darker rooms have shorter paths, so that both methods cost less there."""

PATHS_OF_POINT = 8192
"""Paths per point where nothing is solved: the error is then about one per cent, and falls with their square root."""


def paths_for_few(count: int, max_error: float) -> int | None:
    """The number of paths per point if paths to all points take fewer rays than records would; otherwise None.

    The rule counts rays, so that the choice is the same on every machine: records first need their far records, which
    cost the same for one point as for thousands.
    """
    options = core_options(IrradianceCache(max_error=max_error))
    paths = max(1, round(PATHS_OF_POINT * (0.01 / max_error) ** 2))
    far = options.far_records * math.pi * options.far_rows**2 * RAYS_OF_TRACED_PATH
    gather = math.pi * options.rows**2 * RAYS_OF_GATHER_PATH
    return paths if count * paths * RAYS_OF_TRACED_PATH < far + count * gather else None


def irradiance(
    scene: Scene | str | os.PathLike[str],
    points: FloatArray,
    normals: FloatArray,
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
    """Irradiance at `points` on the side of their `normals`: (N, 3) RGB in W·m⁻², lux where the scene is photometric.

    Parameters
    ----------
    points, normals : (N, 3) positions in metres and directions of any length. Points need not lie on a surface.
    what : a method, its class or its name, a solution, or None. None is irradiance caching, or paths if the points are
        so few that paths take fewer rays (`paths_for_few`). A class or a name takes `max_error`, where the method has
        one.

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
    max_error : wanted relative error of the indirect light if `what` is None.
    samples : samples of the lights per point, and paths per point with `Path`.
    max_depth : edges of a path, as for pictures: 2 is direct light, −1 unlimited. What was solved must have been solved
        with the same.
    statistics : a dict that is filled with `points`, `served` (by records) and `gathered` (both only where a cache
        was read), `paths` per point (only where None chose them), `rays` and `seconds`; `direct_error`, the relative
        error of light straight from lights (one deviation, from halves of its samples), and where the error of records
        is known, `estimated_error` of both.

    Raises
    ------
    EclatError : arrays do not fit or are not finite, a solution is for another scene or depth, or arguments are out of
        range.

    Examples
    --------
    >>> import eclat
    >>> scene = eclat.load("furnace")  # closed, emits 1, reflects half: its radiance is 2 everywhere
    >>> E = eclat.irradiance(scene, [[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    >>> bool(abs(E[0, 0] / (2 * np.pi) - 1) < 0.02)
    True
    """
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
        source = Direct()  # Light that arrives straight from lights is the same for every method.
    elif what is None and (paths := paths_for_few(len(places.positions), max_error)) is not None:
        source, samples = Path(), max(samples, paths)
        counts["paths"] = float(samples)
    prepared = source.prepare(scene, places, work)
    if prepared is not source:
        counts["rays"] += prepared.statistics.get("rays", 0.0)
    estimator = prepared.point_estimator(scene, work)
    asked = _core.PointIrradianceOptions(
        component=_core.Component[component], samples=samples, max_depth=max_depth, seed=seed, threads=work.threads
    )
    positions = compiled(scene).to_core(places.positions)
    directions = np.ascontiguousarray(places.normals, np.float32)
    counted = _core.Progress()
    found, served, direct_errors = run(
        "irradiance", lambda p: _core.irradiance(positions, directions, estimator, asked, p), progress, counted
    )
    if served is not None:
        counts |= {"served": float(served[0]), "gathered": float(served[1])}
    counts["rays"] += float(counted.rays)
    counts |= stated_errors(np.asarray(found), np.asarray(direct_errors), prepared.statistics)
    if statistics is not None:
        statistics.update(counts, seconds=clock.perf_counter() - started)
    return np.asarray(found, np.float32).reshape(-1, 3)


def stated_errors(
    found: NDArray[np.floating], direct_errors: NDArray[np.floating], solved: dict[str, float]
) -> dict[str, float]:
    """What is known of the error of irradiance (N, 3), relative as in `metrics.relative_rmse`: `direct_error`, from halves
    of the light samples of each point, whose standard errors are (N,) luminances; and where the error of records was
    estimated, `estimated_error` of both together."""
    light = luminance(found).astype(np.float64)
    scale = light**2 + RELATIVE_C * float(np.mean(light**2)) if len(light) else light
    relative = np.divide(direct_errors.astype(np.float64) ** 2, scale, out=np.zeros_like(light), where=scale > 0)
    errors = {"direct_error": float(np.sqrt(relative.mean())) if len(light) else 0.0}
    if "estimated_error" in solved:
        errors["estimated_error"] = float(np.hypot(errors["direct_error"], solved["estimated_error"]))
    return errors


def asks_for_indirect(component: Component, max_depth: int) -> bool:
    """Whether indirect light is wanted too, not only light straight from lights."""
    return component != "direct" and (max_depth < 0 or max_depth > 2)


def checked_component(component: str) -> None:
    """Raise EclatError for an unknown component of light."""
    known = get_args(Component)
    if component not in known:
        raise EclatError(
            f"component must be one of {', '.join(known)}, got {component!r}{did_you_mean(str(component), known)}"
        )
