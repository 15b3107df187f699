# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb solve: records of a scene, for a view, for points, or for all of its surfaces."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import overload

import numpy as np

from eclat import _core, refining
from eclat.bridge.arguments import (
    checked_max_depth,
    checked_seed,
    chosen_camera,
    picture_size,
    points_with_normals,
    thread_count,
)
from eclat.bridge.compiled import compiled
from eclat.bridge.running import ProgressReport, run
from eclat.error_estimate import CHECK_SHARE, ErrorEstimate
from eclat.errors import EclatError, warn
from eclat.options import IrradianceCache, PhotonMap, RadianceCache, Radiosity
from eclat.photons import Photons, trace
from eclat.radiance_tables import radiance_tables
from eclat.radiosity import RadiositySolution, solve_radiosity
from eclat.refining import CHECK_SHARE_OF_REFINEMENT, finer, rays_after, step_towards
from eclat.scene import Camera, FloatArray, Scene
from eclat.solution import Solution, core_options, core_radiance_options, solved_from_core

SURFACE_POINTS = 1 << 14
"""At which irradiance everywhere is checked, evenly spread over all surfaces."""


@dataclass(frozen=True)
class Where:
    """What records are for: how caches are filled for it, and how their error there is estimated."""

    fill: Callable[[_core.SolvedCaches, _core.IrradianceCacheOptions, _core.Progress], None]
    """In place; what it has done when it is stopped stays."""
    estimate: Callable[
        [_core.SolvedCaches, _core.ErrorCheck, _core.Progress, _core.RadianceTables | None], _core.ErrorEstimate
    ]
    fill_radiance: (
        Callable[[_core.SolvedCaches, _core.RadianceTables, _core.RadianceCacheOptions, _core.Progress], None] | None
    ) = None
    """The same with records of radiance; points have no lobes to be cached."""
    estimates_gloss: bool = False
    """Whether `estimate` looks at what is reflected, not at irradiance alone."""


@overload
def solve(
    scene: Scene,
    options: IrradianceCache | None = None,
    *,
    camera: int | Camera | None = None,
    size: tuple[int, int] | None = None,
    points: tuple[FloatArray, FloatArray] | None = None,
    view_independent: bool = False,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    keep_partial: bool = False,
    check: bool = True,
    refine: bool = False,
    progress: ProgressReport | None = None,
) -> Solution: ...


@overload
def solve(
    scene: Scene,
    options: PhotonMap,
    *,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> Photons: ...


@overload
def solve(
    scene: Scene,
    options: Radiosity,
    *,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> RadiositySolution: ...


def solve(
    scene: Scene,
    options: IrradianceCache | PhotonMap | Radiosity | None = None,
    *,
    camera: int | Camera | None = None,
    size: tuple[int, int] | None = None,
    points: tuple[FloatArray, FloatArray] | None = None,
    view_independent: bool = False,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    keep_partial: bool = False,
    check: bool = True,
    refine: bool = False,
    progress: ProgressReport | None = None,
) -> Solution | Photons | RadiositySolution:
    """Compute irradiance records where they are wanted: in a view (the default), at points, or everywhere.

    With the options of photon mapping or radiosity: trace photons or solve all patches, which are for the whole scene, so
    that of the following only `max_depth`, `seed`, `threads` and `progress` apply.

    Parameters
    ----------
    camera, size : the view, and its (width, height) in pixels; records are spaced by projected pixels. Default: the
        scene's first camera and that camera's size.
    points : positions and normals, (N, 3) each, instead of a view. They need not lie on a surface; each gets a record
        unless another one serves it.
    view_independent : records for all diffuse surfaces instead of a view, on each side that reflects, and under radiance
        caching on all glossy ones, for views from any direction. Without a
        view a pixel of `options` is a thousandth of the scene's diameter.
    max_depth : edges of a path: 2 direct light only, −1 unlimited.
    keep_partial : Ctrl-C still raises KeyboardInterrupt, but its attribute `partial` is then the Solution of the
        passes that were finished, for a view, points or everywhere alike, marked incomplete; absent as long as there
        are far records only, which the first passes make.
    check : estimate the error of the records where they are wanted, by path-traced gathers that never end in a cache.
        It takes up to `CHECK_SHARE` of the solve's rays, and says in the statistics `estimated_error` with
        `estimated_error_low` and `_high` (95 %), the measure of `metrics.relative_rmse` over all pixels of the view,
        over the points, or over all surfaces; of the light that records answer for, in units of all light there. In a
        view that is gloss from records of radiance too; on all surfaces it is irradiance alone, which is said beside it.
    refine : solve again with finer settings until the estimate and its margin meet the `max_error` of the options, or a
        step would take more than `refining.MOST_RAYS`, which is said in a warning. The statistics then hold the number of
        `refinements`; rays and seconds are those of all.

    Same arguments, same bits, whatever `threads`.

    Raises
    ------
    EclatError : arguments out of range, arrays that do not fit or are not finite, more than one of view, points and
        view_independent.

    Examples
    --------
    >>> import eclat
    >>> scene = eclat.load("furnace")
    >>> desk = eclat.solve(scene, points=([[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
    >>> len(desk)
    1
    """
    if isinstance(options, PhotonMap | Radiosity):
        if camera is not None or size is not None or points is not None or view_independent or refine or keep_partial:
            named = "photons are" if isinstance(options, PhotonMap) else "radiosity is"
            raise EclatError(f"solve: {named} for the whole scene: expected no view, no points, and no refinement")
        depth, count, key = checked_max_depth(max_depth), thread_count(threads), checked_seed(seed)
        if isinstance(options, PhotonMap):
            return trace(scene, options, max_depth=depth, seed=key, threads=count, progress=progress)
        return solve_radiosity(scene, options, max_depth=depth, seed=key, threads=count, progress=progress)
    options = options or IrradianceCache()
    where = where_wanted(scene, camera=camera, size=size, points=points, view_independent=view_independent)
    job = Job(
        scene, where, checked_max_depth(max_depth), checked_seed(seed), thread_count(threads), keep_partial, progress
    )
    solution = job.solve(options, CHECK_SHARE_OF_REFINEMENT if refine else CHECK_SHARE if check else 0.0)
    return job.refined(solution, options.max_error) if refine else solution


def refine(
    solution: Solution,
    scene: Scene,
    max_error: float | None = None,
    *,
    camera: int | Camera | None = None,
    size: tuple[int, int] | None = None,
    points: tuple[FloatArray, FloatArray] | None = None,
    view_independent: bool = False,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> Solution:
    """Go on from a Solution with finer settings: towards the exact light, the more often it is called.

    Every setting that the error depends on is made finer (`refining.finer`), that of records and that of the far records
    in which their gathers end, and records are gathered anew with more rays: none of the old noise stays.

    Parameters
    ----------
    max_error : go on until the estimated error with its margin meets it, as `solve` does with `refine`; None: one step,
        to half the error.
    camera, size, points, view_independent : what the Solution was solved for, as in `solve`.

    Raises
    ------
    EclatError : a Solution of another scene; else as `solve`.
    """
    solution.check(scene, solution.max_depth)
    where = where_wanted(scene, camera=camera, size=size, points=points, view_independent=view_independent)
    job = Job(scene, where, solution.max_depth, checked_seed(seed), thread_count(threads), False, progress)
    if max_error is None:
        return job.solve(finer(solution.options, 0.5), CHECK_SHARE)
    if solution.estimate is None:
        solution = job.checked(solution, CHECK_SHARE_OF_REFINEMENT)
    return job.refined(solution, max_error)


@dataclass(frozen=True, eq=False)
class Job:
    """Solves of one scene for one purpose."""

    scene: Scene
    where: Where
    max_depth: int
    seed: int
    threads: int
    keep_partial: bool
    progress: ProgressReport | None

    def _fill(
        self, options: IrradianceCache, caches: _core.SolvedCaches, photons: _core.PhotonMaps | None
    ) -> Callable[[_core.Progress], None]:
        common = {"max_depth": self.max_depth, "seed": self.seed, "threads": self.threads}
        fill_radiance, tables = self.where.fill_radiance, self._tables(options)
        if isinstance(options, RadianceCache) and fill_radiance is not None and tables is not None:
            with_radiance = core_radiance_options(options, **common)
            with_radiance.irradiance.far_photons = photons
            return lambda p: fill_radiance(caches, tables, with_radiance, p)
        settings = core_options(options, **common)
        settings.far_photons = photons
        return lambda p: self.where.fill(caches, settings, p)

    def _tables(self, options: IrradianceCache) -> _core.RadianceTables | None:
        if not isinstance(options, RadianceCache) or self.where.fill_radiance is None:
            return None
        return radiance_tables(self.scene, options, threads=self.threads or None, progress=self.progress)

    def _photons(self, options: IrradianceCache) -> tuple[_core.PhotonMaps | None, float]:
        """For gather rays to end in, if they are to, and the rays that tracing them took."""
        if not options.far_photons or self.max_depth >= 0:
            return None, 0.0
        if self.scene.environment is not None:
            raise EclatError(
                "far_photons: expected a scene without an environment image, whose light gathers collect themselves"
            )
        photons = trace(
            self.scene, PhotonMap(photons=options.far_photons, caustic_photons=max(1000, options.far_photons // 4)),
            seed=self.seed, threads=self.threads, progress=self.progress,
        )  # fmt: skip
        maps = photons.core(self.scene, gather=True, threads=self.threads, progress=self.progress)
        return maps, photons.statistics["rays"]

    def solve(self, options: IrradianceCache, check_share: float) -> Solution:
        """One solve, checked with that share of its rays."""
        started = clock.perf_counter()
        caches, counted = _core.SolvedCaches(), _core.Progress()
        photons, photon_rays = self._photons(options)

        def solution(complete: bool) -> Solution:
            statistics = {
                "records": float(caches.near_count),
                "far_records": float(caches.far_count),
                "left_to_paths": float(caches.left_to_paths),
                "rays": float(counted.rays) + photon_rays,
                "seconds": clock.perf_counter() - started,
            }
            if isinstance(options, RadianceCache):
                statistics["radiance_records"] = float(caches.radiance_count)
            return solved_from_core(
                self.scene, options, caches, statistics, max_depth=self.max_depth, complete=complete
            )

        try:
            run("solve", self._fill(options, caches, photons), self.progress, counted)
        except KeyboardInterrupt as stop:
            if self.keep_partial and caches.near_count:
                stop.partial = solution(False)  # type: ignore[attr-defined]
            raise
        return self.checked(solution(True), check_share, caches) if check_share > 0 else solution(True)

    def checked(
        self, solution: Solution, share: float, caches: _core.SolvedCaches | None = None, max_error: float | None = None
    ) -> Solution:
        """The same with an estimate of its error in the statistics, by gathers of at most that share of its rays; fewer
        where it is soon clear on which side of `max_error` (default: that of its options) the error lies."""
        started, counted, check = clock.perf_counter(), _core.Progress(), _core.ErrorCheck()
        check.rays = int(share * solution.statistics["rays"])
        check.wanted = solution.options.max_error if max_error is None else max_error
        check.max_depth, check.seed, check.threads = self.max_depth, self.seed, self.threads
        read = solution.core() if caches is None else caches
        tables = self._tables(solution.options)
        try:
            found = run("check", lambda p: self.where.estimate(read, check, p, tables), self.progress, counted)
        except KeyboardInterrupt as stop:
            if self.keep_partial:
                stop.partial = solution  # type: ignore[attr-defined]
            raise
        statistics = solution.statistics | ErrorEstimate.of(found).statistics()
        if tables is not None:
            statistics["gloss_estimated"] = float(self.where.estimates_gloss)
        statistics["check_rays"] = float(counted.rays)
        statistics["rays"] += float(counted.rays)
        statistics["seconds"] += clock.perf_counter() - started
        return replace(solution, statistics=statistics)

    def refined(self, solution: Solution, max_error: float) -> Solution:
        """Solves with finer settings until the estimate and its margin meet `max_error`, or it is said why not."""
        refinements, rays, seconds = 0, solution.statistics["rays"], solution.statistics["seconds"]
        while (estimate := solution.estimate) is not None and estimate.high > max_error:
            ratio = step_towards(estimate, max_error)
            options = finer(solution.options, ratio)
            needed = rays_after(solution.statistics["rays"], ratio)
            stopped = f"stopped at {100 * estimate.quoted:.2g} %, expected {100 * max_error:.2g} %: another refinement"
            if needed > refining.MOST_RAYS:
                warn(
                    f"{stopped} would take {needed / 1e6:,.0f} million rays, more than {refining.MOST_RAYS / 1e6:,.0f}"
                )
                break
            if replace(options, max_error=solution.options.max_error) == solution.options:
                warn(f"{stopped} would need settings beyond their limits")
                break
            try:
                solution = self.checked(self.solve(options, 0.0), CHECK_SHARE_OF_REFINEMENT, max_error=max_error)
            except KeyboardInterrupt as stop:
                if self.keep_partial:
                    stop.partial = solution  # type: ignore[attr-defined]
                raise
            refinements += 1
            rays += solution.statistics["rays"]
            seconds += solution.statistics["seconds"]
        total = {"rays": rays, "seconds": seconds, "refinements": float(refinements)}
        return replace(solution, statistics=solution.statistics | total)


def where_wanted(
    scene: Scene,
    *,
    camera: int | Camera | None = None,
    size: tuple[int, int] | None = None,
    points: tuple[FloatArray, FloatArray] | None = None,
    view_independent: bool = False,
) -> Where:
    """What records are for, by the arguments of `solve`. Raises EclatError where they contradict each other."""
    if (camera is not None or size is not None) + (points is not None) + view_independent > 1:
        raise EclatError("solve: expected one of camera (with size), points and view_independent, got several")
    prepared = compiled(scene)
    if points is not None:
        places, sides = points_with_normals(*points)
        positions, directions = prepared.to_core(places), np.ascontiguousarray(sides, np.float32)
        return Where(
            lambda caches, o, p: _core.solve_at_points(prepared.core, positions, directions, o, caches, p),
            lambda caches, c, p, _: _core.estimate_error_at_points(prepared.core, positions, directions, caches, c, p),
        )
    if view_independent:
        return Where(
            lambda caches, o, p: _core.solve_everywhere(prepared.core, o, caches, p),
            lambda caches, c, p, _: _core.estimate_error_everywhere(prepared.core, SURFACE_POINTS, caches, c, p),
            lambda caches, tables, o, p: _core.solve_radiance_everywhere(prepared.core, tables, o, caches, p),
        )
    view = chosen_camera(scene, 0 if camera is None else camera)
    core_camera = prepared.camera(view, picture_size(view, size))
    return Where(
        lambda caches, o, p: _core.solve_for_camera(prepared.core, core_camera, o, caches, p),
        lambda caches, c, p, tables: _core.estimate_error_for_camera(prepared.core, core_camera, caches, c, p, tables),
        lambda caches, tables, o, p: _core.solve_radiance_for_camera(prepared.core, core_camera, tables, o, caches, p),
        estimates_gloss=True,
    )
