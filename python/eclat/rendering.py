# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb render: a picture of a scene."""

from __future__ import annotations

import time as clock
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import eclat
from eclat import _core
from eclat.bridge.arguments import (
    checked_crop,
    checked_max_depth,
    checked_samples,
    checked_seed,
    checked_time,
    chosen_camera,
    picture_size,
    thread_count,
)
from eclat.bridge.compiled import compiled
from eclat.bridge.running import ProgressReport, run
from eclat.error_estimate import ErrorEstimate
from eclat.errors import EclatError, did_you_mean, warn
from eclat.images.image import Image
from eclat.options import Direct, IrradianceCache, Options, Path, PhotonMap, RadianceCache, Radiosity, method_name
from eclat.photons import Photons, ProgressivePasses, trace
from eclat.radiance_tables import radiance_tables
from eclat.radiosity import RadiositySolution, solve_radiosity
from eclat.record_overlay import record_density
from eclat.sampling.adaptive_sampling import AdaptiveSamples, Counts
from eclat.sampling.convergence import Goal, Sampling
from eclat.scene import Camera, Scene
from eclat.solution import Solution
from eclat.solving import solve
from eclat.time_budget import solve_within

_FILTERS = ("box", "tent")


def render(
    scene: Scene,
    what: Solution | Photons | RadiositySolution | Options | None = None,
    *,
    samples: int | None = None,
    max_error: float = 0.01,
    time: float | None = None,
    size: tuple[int, int] | None = None,
    crop: tuple[int, int, int, int] | None = None,
    camera: int | Camera = 0,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    filter: str = "box",
    adaptive: bool | None = None,
    keep_partial: bool = False,
    check: bool = True,
    refine: bool = False,
    progress: ProgressReport | None = None,
    tile_order: list[int] | None = None,
) -> Image:
    """A picture of the scene.

    Parameters
    ----------
    what : a Solution, Photons or a RadiositySolution, the options of a method (solved on the fly), or None for irradiance
        caching.
    samples : paths per pixel, where `adaptive` their mean. None: as many as `max_error` asks for.
    max_error : relative error at which the noise of the picture, estimated from its passes, is small enough; the
        samples are doubled until then, at most to `convergence.MOST_SAMPLES`. With records solved on the fly it is the
        error of the whole picture: what their own error, as `check` estimates it, leaves is the noise's, at least half.
    time : stop after about this many seconds instead. What fits is chosen by the clock (`time_budget`): how fine records
        are, and how many samples; the metadata hold both, and with them the same picture is made again, bit for bit.
    size, crop : (width, height), and (x0, y0, x1, y1) in pixels, exclusive; the rest of the picture stays black.
    max_depth : edges of a path: 1 emission, 2 direct light, −1 unlimited. A Solution must have been solved with the
        same.
    filter : of pixels, "box" or "tent".
    adaptive : give pixels that are noisy more samples and others less (`adaptive_sampling`), so that `samples` is their
        mean. None: where a cache is read and there is no `crop`, whose pixels are then those of the whole picture, bit
        for bit. Choosing by what samples showed biases the picture a little, so that `Path` does it only when told to.
    keep_partial : Ctrl-C still raises KeyboardInterrupt, but its attribute `partial` is then a whole Image of fewer
        samples, their number in its metadata as `samples_done`; absent before the first sample of each pixel.
    check : where records are solved on the fly, estimate their error as `solve` does. The statistics of the picture
        then hold `estimated_error` with `_low` and `_high` (95 %) of the whole picture, the noise of its samples
        included where there are at least two, and `cache_error`, without it.
    refine : where records are solved on the fly, go on until their estimated error meets their `max_error`.
    tile_order : a permutation in which tiles are worked on; it changes nothing (tests use it to show that).

    Returns
    -------
    Image with the layers direct, indirect, albedo, normal and depth, with records also record_density, and under radiance
    caching gloss_cached and gloss_traced: in which share of a pixel's samples the glossy lobes that it sees were served by
    records, and in which some had to be traced. Samples that were not finite are left out, told by a warning, and counted
    in its metadata as `bad_samples`.

    Raises
    ------
    EclatError : arguments out of range, a Solution of another scene or depth.

    Examples
    --------
    >>> import eclat
    >>> image = eclat.render(eclat.load("furnace"), eclat.Path(), samples=4, size=(8, 8))
    >>> image.pixels.shape, image.metadata["statistics"]["samples"]
    ((8, 8, 3), 4.0)
    """
    if samples is not None and time is not None:
        raise EclatError("render: expected samples or time, got both")
    if refine and time is not None:
        raise EclatError("render: expected refine or time, got both")
    if filter not in _FILTERS:
        known = ", ".join(_FILTERS)
        raise EclatError(f"filter must be one of {known}, got {filter!r}{did_you_mean(str(filter), _FILTERS)}")
    started = clock.perf_counter()
    deadline = None if checked_time(time) is None else started + float(time or 0)
    goal = Goal(None if samples is None else checked_samples(samples), max_error, deadline)
    checked_max_depth(max_depth)
    view = chosen_camera(scene, camera)
    width, height = picture_size(view, size)
    region = checked_crop(crop, width, height)
    common: dict[str, Any] = {"max_depth": max_depth, "seed": checked_seed(seed), "threads": threads}
    estimate: ErrorEstimate | None = None  # of this view: a Solution that was given may have been checked elsewhere
    if what is None:
        what = IrradianceCache(max_error=max_error)
    if isinstance(what, IrradianceCache):
        compiled(scene)  # before a clock looks at what rays take
        records = partial(solve, refine=refine) if deadline is None else partial(solve_within, deadline=deadline)
        what = records(scene, what, camera=view, size=(width, height), check=check, progress=progress, **common)
        estimate = what.estimate
    passes: ProgressivePasses | None = None
    if isinstance(what, PhotonMap) and what.progressive:
        passes = ProgressivePasses(scene, what, max_depth=max_depth, seed=seed, threads=thread_count(threads))
    elif isinstance(what, PhotonMap):
        what = trace(scene, what, max_depth=max_depth, seed=seed, threads=thread_count(threads), progress=progress)
    if isinstance(what, Radiosity):
        what = solve_radiosity(
            scene, what, max_depth=max_depth, seed=seed, threads=thread_count(threads), progress=progress
        )
    solution = what if isinstance(what, Solution) else None
    if isinstance(what, Solution | Photons | RadiositySolution):
        what.check(scene, max_depth)
    prepared = compiled(scene)
    depth = (2 if max_depth < 0 else min(2, max_depth)) if isinstance(what, Direct) else max_depth
    roulette = what.roulette_depth if isinstance(what, Path) else 5
    caches = solution.core() if solution is not None else None
    tables = None
    if solution is not None and isinstance(solution.options, RadianceCache):
        tables = radiance_tables(scene, solution.options, threads=threads, progress=progress)
    core_camera = prepared.camera(view, (width, height))
    film = _core.Film(width, height)
    if adaptive is None:
        adaptive = solution is not None and crop is None
    if estimate is not None:
        goal = replace(goal, max_error=max_error * max(0.5, 1 - (estimate.quoted / max_error) ** 2) ** 0.5)

    where = (region, seed, thread_count(threads), _FILTERS.index(filter), tile_order or [])
    if isinstance(what, Photons):
        gather = what.options.gather
        maps = what.core(scene, gather=gather > 0, threads=thread_count(threads), progress=progress)
    if isinstance(what, RadiositySolution):
        gather = what.options.gather
        field = what.core(scene, threads=thread_count(threads))

    def render_samples(first: Counts, end: Counts, p: _core.Progress) -> None:
        if passes is not None:
            for number in range(int(first.min()), int(end.max())):
                of_pass = passes.maps(number, p)
                begins, ends = (np.clip(counts, number, number + 1) for counts in (first, end))
                _core.render_photons(prepared.core, core_camera, film, p, of_pass, 0, max_depth, begins, ends, *where)
        elif isinstance(what, Photons):
            _core.render_photons(prepared.core, core_camera, film, p, maps, gather, max_depth, first, end, *where)
        elif isinstance(what, RadiositySolution):
            _core.render_radiosity(prepared.core, core_camera, film, p, field, gather, max_depth, first, end, *where)
        else:
            _core.render_samples(
                prepared.core, core_camera, film, p, depth, roulette, caches, tables, first, end, *where
            )

    def render_range(first: Counts, end: Counts, report: ProgressReport | None) -> float:
        counted = _core.Progress()
        run("render", lambda p: render_samples(first, end, p), report, counted)
        return float(counted.rays)

    about = _About(scene, what, view, seed, max_depth, (width, height), region, adaptive)
    pixels = AdaptiveSamples((width, height), region) if adaptive else None
    sampling = Sampling(film, render_range, keep_partial, progress, pixels)
    try:
        sampling.run(goal)
    except KeyboardInterrupt as stop:
        if sampling.partial is not None:
            statistics = _statistics(
                sampling, sampling.partial_taken, what, estimate, film, clock.perf_counter() - started
            )
            image = about.image(sampling.partial, statistics)
            image.metadata["samples_done"] = sampling.partial_taken
            stop.partial = image  # type: ignore[attr-defined]
        raise
    if samples is None and deadline is None and sampling.noise > goal.max_error:
        noise = f"the noise is still {sampling.noise:.2g}, not {goal.max_error:.2g}"
        warn(f"after {sampling.taken:,} samples {noise}: stopped there")
    seconds = clock.perf_counter() - started
    image = about.image(film, _statistics(sampling, sampling.taken, what, estimate, film, seconds))
    about.tell_bad_samples(image, film, sampling.taken)
    return image


@dataclass(frozen=True, eq=False)
class _About:
    """What a picture shows and how it was asked for."""

    scene: Scene
    what: Solution | Photons | RadiositySolution | Options
    camera: Camera
    seed: int
    max_depth: int
    size: tuple[int, int]
    region: tuple[int, int, int, int]
    adaptive: bool

    @property
    def options(self) -> Options:
        return self.what.options if isinstance(self.what, Solution | Photons | RadiositySolution) else self.what

    def image(self, film: _core.Film, statistics: dict[str, float]) -> Image:
        radiance, direct = film.radiance, film.direct
        layers = {
            "direct": direct, "indirect": radiance - direct,
            "albedo": film.albedo, "normal": film.normal, "depth": film.depth,
        }  # fmt: skip
        metadata = {
            "scene": self.scene.name, "method": method_name(self.options), "options": asdict(self.options),
            "seed": self.seed, "max_depth": self.max_depth, "adaptive": self.adaptive, "version": eclat.__version__,
            "statistics": statistics,
        }  # fmt: skip
        if isinstance(self.options, RadianceCache):
            layers |= {"gloss_cached": film.gloss_cached, "gloss_traced": film.gloss_traced}
        image = Image(radiance, layers, metadata)
        if isinstance(self.what, Solution):
            image.layers["record_density"] = self._records_in(image, self.what)
        return image

    def _records_in(self, image: Image, solution: Solution) -> NDArray[np.float32]:
        density = record_density(image, self.camera, solution.positions)
        x0, y0, x1, y1 = self.region
        inside = np.zeros_like(density)
        inside[y0:y1, x0:x1] = density[y0:y1, x0:x1]
        return inside

    def tell_bad_samples(self, image: Image, film: _core.Film, taken: int) -> None:
        """Count the samples that were not finite and were left out, in the metadata and in a warning."""
        if not film.bad_count:
            return
        x, y, sample = film.bad_samples[0]
        x0, y0, x1, y1 = self.region
        image.metadata["bad_samples"] = {"count": int(film.bad_count), "first": [x, y, sample]}
        warn(
            f"{film.bad_count:,} of {taken * (x1 - x0) * (y1 - y0):,} samples were not finite and are left out; "
            f"first at pixel ({x}, {y}), sample {sample}\n"
            f"         replay: the same eclat.render(…) with samples={sample + 1}, "
            f"crop=({x}, {y}, {x + 1}, {y + 1}), size=({self.size[0]}, {self.size[1]})"
        )


def _statistics(
    sampling: Sampling,
    samples: int,
    what: Solution | Photons | RadiositySolution | Options,
    estimate: ErrorEstimate | None,
    film: _core.Film,
    seconds: float,
) -> dict[str, float]:
    statistics = {"samples": float(samples), "rays": sampling.rays, "seconds": seconds}
    if sampling.noise == sampling.noise:
        statistics["noise"] = sampling.noise
    if isinstance(what, Solution | Photons | RadiositySolution):
        statistics["rays"] += what.statistics.get("rays", 0.0)
        statistics["bytes"] = float(what.nbytes)
    if isinstance(what, Solution):
        statistics |= {"records": float(len(what)), "cache_misses": float(film.cache_misses)}
        if what.radiance is not None:
            statistics["radiance_records"] = float(len(what.radiance))
    if isinstance(what, Photons):
        statistics["photons"] = float(len(what))
    if isinstance(what, RadiositySolution):
        statistics["patches"] = float(len(what))
    if estimate is not None:
        noise = statistics.get("noise", 0.0)
        statistics |= estimate.with_noise(noise).statistics() | {"cache_error": estimate.quoted}
    return statistics
