# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `probes`, which computes the light that arrives at the points of a grid, for objects that move."""

from __future__ import annotations

import math
import os
import time as clock
from dataclasses import asdict, replace

import numpy as np

from eclat import _core
from eclat.bridge.arguments import checked_max_depth, checked_max_error, checked_samples, checked_seed, thread_count
from eclat.bridge.compiled import compiled
from eclat.bridge.running import ProgressReport, run
from eclat.errors import warn
from eclat.measure.error_estimate import LIGHT_BY_CHANCE, chance_warning
from eclat.measure.metrics import RELATIVE_C
from eclat.measure.photometry import luminance
from eclat.methods import Direct, Method, Path, Prepared, Source, as_method
from eclat.methods.work import Care, Everywhere, Work
from eclat.probe_grid.grid import ProbeGrid
from eclat.probe_grid.placing import Bounds, Counts, filled, grid_bounds, grid_counts, in_solids
from eclat.probe_grid.quadric import COSINE_LOBE, COUNT, Window, check_window, windowed
from eclat.scene import FloatArray, Scene
from eclat.stage.staging import staged
from eclat.typed import typed
from eclat.verbs.irradiance import checked_component, found_by_chance
from eclat.verbs.light_at_points import Component

MEASURED_ORDER = len(COSINE_LOBE)
"""Number of bands that are computed. Those that a probe does not hold measure what it leaves out."""


@typed
def probes(
    scene: Scene | str | os.PathLike[str],
    what: Source | type[Method] | str | None = None,
    *,
    grid: Counts | None = None,
    bounds: Bounds | None = None,
    component: Component = "total",
    window: Window = "none",
    samples: int = 1024,
    max_error: float = 0.01,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> ProbeGrid:
    """Compute the incident radiance at the points of a grid as spherical harmonics, which engines interpolate to light what
    moves.

    Parameters
    ----------
    what : a method, its class or its name, a solution, or None, which means path tracing. Rays from the probes end where
        those of a camera would: a solution of records, photons or patches serves them as it serves pictures.
    grid : numbers of probes along x, y and z. None means about 512 in cells that are about cubes.
    bounds : the box x0, y0, z0, x1, y1, z1 in metres whose cells have a probe in their middle each. None means the box of
        the scene without stray parts.
    component : the light to hold. "direct" is the light that arrives straight from lights, including the environment and
        suns, for which lights are sampled; "indirect" is all other light, for engines that add their lamps themselves;
        "total" is both.
    window : "none"; "nonnegative", which brings each probe just so much nearer to its mean that no normal has negative
        irradiance; "sloan", the weakest window of [Sloan08] that does the same, which blurs more; "hanning" or "lanczos",
        which blur all probes and leave some negative.
    samples : number of rays, and of samples of the lights, per probe.
    max_error : wanted relative error of the indirect light, if `what` is a class or a name and has that option.
    max_depth : greatest number of edges of a path from a probe: 1 is light straight from lights, 2 adds what surfaces
        reflect of it, −1 sets no limit. A solution must have been solved with the same value.

    Returns
    -------
    A `ProbeGrid`. Its statistics are the number of `probes`, of those `inside` solids and of those that the window changed
    (`windowed`); `rays` and `seconds`; and relative errors of the irradiance of all normals, in the mean over the probes
    as for `eclat.irradiance`: `noise_error`, from two halves of the samples; `order_error`, of what nine coefficients
    cannot hold; `window_error`, of the window; and `estimated_error`, all three with the error of the solution, if that
    is known.

    Raises
    ------
    EclatError : the scene has no surfaces and no bounds are given, all probes lie inside solids, a solution belongs to
        another scene or another `max_depth`, or an argument is out of range.

    Examples
    --------
    >>> import eclat
    >>> scene = eclat.load("furnace")  # closed, emits 1, reflects half: its radiance is 2 everywhere
    >>> grid = eclat.probes(scene, grid=(1, 1, 1), samples=256)
    >>> E = grid.irradiance([[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    >>> bool(abs(E[0, 0] / (2 * np.pi) - 1) < 0.02)
    True
    """
    checked_component(component)
    check_window(window)
    scene = staged(scene)
    started = clock.perf_counter()
    work = Work(checked_max_depth(max_depth), checked_seed(seed), thread_count(threads), progress)
    checked_samples(samples), checked_max_error(max_error)
    source = as_method(what, Path(), max_error=max_error)
    source.require_match(scene, max_depth)
    layout = replace(_empty_grid(scene, grid, bounds), component=component, method=source.options.name, window=window)
    counts, spacing = layout.counts, layout.spacing
    positions = layout.positions.reshape(-1, 3)
    inside = in_solids(scene, positions, work.threads)
    filled(np.zeros(counts), inside.reshape(counts), spacing)  # raises if all are inside, before anything is solved
    if component == "direct" or max_depth == 1:
        source = Direct()  # All methods give the same light straight from lights.
    prepared = source.prepare(scene, Everywhere(), work, Care(check=not source.options.for_whole_scene))
    values, errors, rays = _projected(scene, prepared, positions[~inside], component, samples, work)
    kept, changed = windowed(values[:, :COUNT], window)
    coefficients = np.zeros((len(positions), COUNT, 3))
    coefficients[~inside] = kept
    known = isinstance(source, Direct) or "estimated_error" in prepared.statistics
    chance = {} if known else found_by_chance(scene, work)
    if doubt := chance_warning(chance):
        warn(f"probes: {doubt}")
    statistics = {
        "probes": float(len(positions)),
        "inside": float(inside.sum()),
        "windowed": float(changed.sum()),
        "rays": rays + (prepared.statistics.get("rays", 0.0) if prepared is not source else 0.0),
        **stated_errors(values, errors, kept, _error_of(prepared, chance.get(LIGHT_BY_CHANCE, 0.0))),
        **chance,
        "seconds": clock.perf_counter() - started,
    }
    return replace(
        layout,
        coefficients=filled(coefficients.reshape(*counts, COUNT, 3), inside.reshape(counts), spacing).astype(
            np.float32
        ),
        inside=inside.reshape(counts),
        statistics=statistics,
        settings=asdict(source.options) | {"samples": samples, "max_depth": max_depth, "seed": seed},
    )


def _empty_grid(scene: Scene, grid: Counts | None, bounds: Bounds | None) -> ProbeGrid:
    """Make a grid of black probes in the middle of each cell of a box."""
    low, high = grid_bounds(scene, bounds)
    counts = grid_counts(high - low, grid)
    spacing = (high - low) / counts
    return ProbeGrid(
        origin=low + spacing / 2,
        spacing=spacing,
        coefficients=np.zeros((*counts, COUNT, 3), np.float32),
        inside=np.zeros(counts, bool),
        component="total",
        method=Path.name,
        window="none",
        unit="lux" if scene.photometric else "W/m2",
    )


def _projected(
    scene: Scene, prepared: Prepared, positions: FloatArray, component: Component, samples: int, work: Work
) -> tuple[FloatArray, FloatArray, float]:
    """Project the light at positions (N, 3); return coefficients and standard errors (N, `MEASURED_ORDER`², 3), and the
    number of rays."""
    asked = _core.ProbeOptions(
        component=_core.Component[component],
        order=MEASURED_ORDER,
        samples=samples,
        seed=work.seed,
        threads=work.threads,
    )
    places = compiled(scene).to_core(positions).astype(np.float32)
    estimator = prepared.radiance_estimator(scene, work)
    counted = _core.Progress()
    values, errors, dropped = run(
        "probes",
        lambda p: _core.probes(compiled(scene).core, places, estimator, asked, p),
        work.progress,
        counted,
    )
    if dropped:
        warn(f"probes: {dropped} rays of {samples * len(positions)} found light that is not finite, and count as dark")
    return np.asarray(values, np.float64), np.asarray(errors, np.float64), float(counted.rays)


def _error_of(prepared: Prepared, missed: float) -> float | None:
    """Return the relative error of what was prepared: the share of the light that is `missed` if it errs by noise alone
    otherwise, and None if it is unknown."""
    if prepared.errs_by_noise_alone:
        return missed
    return prepared.statistics.get("estimated_error")


def stated_errors(
    values: FloatArray, errors: FloatArray, kept: FloatArray, of_solution: float | None
) -> dict[str, float]:
    """Compute the known errors of probes, from coefficients and half the differences between their halves,
    (N, `MEASURED_ORDER`², 3) each, and from the coefficients `kept` (N, 9, 3).

    They are relative errors of the luminance of irradiance, over all normals in the mean square: by Parseval, that of
    Σ A_l c_lm Y_lm is Σ A_l² c_lm² / 4π. `noise_error` is that of the coefficients that probes hold, `order_error` that of
    leaving out the others, without their noise, and `window_error` that of the window. The mean over probes is that of
    `measure.metrics.relative_rmse`.
    """
    bands = np.repeat(np.arange(MEASURED_ORDER), 2 * np.arange(MEASURED_ORDER) + 1)
    weights = np.take(COSINE_LOBE, bands) ** 2 / (4 * math.pi)
    light, noise = luminance(values) ** 2 * weights, luminance(errors) ** 2 * weights
    power = light[:, :COUNT].sum(axis=1)
    scale = power + RELATIVE_C * (power.mean() if len(power) else 0.0)

    def relative(squares: FloatArray) -> float:
        shares = np.divide(squares, scale, out=np.zeros_like(power), where=scale > 0)
        return float(np.sqrt(max(0.0, shares.mean()))) if len(shares) else 0.0

    found = {
        "noise_error": relative(noise[:, :COUNT].sum(axis=1)),
        "order_error": relative((light - noise)[:, COUNT:].sum(axis=1)),
        "window_error": relative((luminance(kept - values[:, :COUNT]) ** 2 * weights[:COUNT]).sum(axis=1)),
    }
    if of_solution is not None:
        found["estimated_error"] = math.hypot(*found.values(), of_solution)
    return found
