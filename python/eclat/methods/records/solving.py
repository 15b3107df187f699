# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Solving records for a view, for points or for all surfaces, estimating their error, and refining them."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.bridge.running import run
from eclat.errors import EclatError, warn
from eclat.farm.farm import current_farm
from eclat.farm.shared_work import Share, SharedWork, Sharing, Tell
from eclat.measure.error_estimate import CHECK_SHARE, ErrorEstimate, light_by_chance, with_light_by_chance
from eclat.methods.photon_map import PhotonMap, trace
from eclat.methods.records import laws
from eclat.methods.records.cache_functions import CacheFunctions, functions_for
from eclat.methods.records.laws import CHECK_SHARE_OF_REFINEMENT, core_options, core_radiance_options, finer
from eclat.methods.records.options import RadianceOptions, RecordOptions
from eclat.methods.records.radiance_tables import radiance_tables
from eclat.methods.records.solution import Solution, solved_from_core
from eclat.methods.work import Care, Purpose, Work
from eclat.scene import Scene


def solve_records(scene: Scene, options: RecordOptions, purpose: Purpose, work: Work, care: Care) -> Solution:
    """Solve records for a purpose, and estimate their error and refine them as `care` requests."""
    job = Job(scene, purpose, work, care.keep_partial)
    solution = job.solve(options, CHECK_SHARE_OF_REFINEMENT if care.refine else CHECK_SHARE if care.check else 0.0)
    return job.refined(solution, options.max_error) if care.refine else solution


def refine_records(
    solution: Solution, scene: Scene, purpose: Purpose, work: Work, care: Care, max_error: float | None
) -> Solution:
    """Solve finer records until their estimated error is below `max_error`; None takes one step, to half the error."""
    job = Job(scene, purpose, work, care.keep_partial)
    if max_error is None:
        return job.solve(finer(solution.options, 0.5), CHECK_SHARE if care.check else 0.0)
    if solution.estimate is None:
        solution = job.checked(solution, CHECK_SHARE_OF_REFINEMENT)
    return job.refined(solution, max_error)


@dataclass(frozen=True, eq=False)
class Job:
    """The solves of one scene for one purpose."""

    scene: Scene
    purpose: Purpose
    work: Work
    keep_partial: bool = False

    @cached_property
    def functions(self) -> CacheFunctions:
        """The functions that fill and check caches for the purpose."""
        return functions_for(self.scene, self.purpose)

    def fill(
        self,
        options: RecordOptions,
        caches: _core.SolvedCaches,
        photons: _core.PhotonMaps | None,
        exchange: tuple[Share, Tell] | None,
    ) -> Callable[[_core.Progress], None]:
        """Make the function that fills caches. Its passes go out by `exchange`, if there is one."""
        common = {"max_depth": self.work.max_depth, "seed": self.work.seed, "threads": self.work.threads}
        fill_radiance, tables = self.functions.fill_radiance, self.tables(options)
        if isinstance(options, RadianceOptions) and fill_radiance is not None and tables is not None:
            with_radiance = core_radiance_options(options, **common)
            with_radiance.irradiance.far_photons = photons
            if exchange is not None:
                with_radiance.irradiance.share_work(*exchange)
            return lambda p: fill_radiance(caches, tables, with_radiance, p)
        settings = core_options(options, **common)
        settings.far_photons = photons
        if exchange is not None:
            settings.share_work(*exchange)
        return lambda p: self.functions.fill(caches, settings, p)

    def tables(self, options: RecordOptions) -> _core.RadianceTables | None:
        """Return the tables of lobes that radiance caching reads, or None for other options and purposes."""
        if not isinstance(options, RadianceOptions) or self.functions.fill_radiance is None:
            return None
        return radiance_tables(self.scene, options, threads=self.work.threads or None, progress=self.work.progress)

    def _alone(self) -> Work:
        """Return the work without what concerns this process only."""
        return replace(self.work, progress=None, threads=0)

    def _exchange(self, work: SharedWork) -> tuple[Share, Tell] | None:
        """Return the two functions by which the farm whose block is entered shares a computation; None without a farm."""
        farm = current_farm()
        if farm is None:
            return None
        sharing = Sharing(farm, work)
        return sharing.share, sharing.tell

    def _photons(self, options: RecordOptions) -> tuple[_core.PhotonMaps | None, float]:
        """Trace the photons from which gather rays read the light at their ends, if `far_photons` requests them; return
        them and the number of rays.
        """
        if not options.far_photons or self.work.max_depth >= 0:
            return None, 0.0
        if self.scene.environment is not None:
            raise EclatError(
                "far_photons: expected a scene without an environment image: photons do not carry its light; "
                "set far_photons=0 to use far records"
            )
        photons = trace(
            self.scene, PhotonMap(photons=options.far_photons, caustic_photons=max(1000, options.far_photons // 4)),
            self.work,
        )  # fmt: skip
        maps = photons.maps(self.scene, gather=True, threads=self.work.threads, progress=self.work.progress)
        return maps, photons.statistics["rays"]

    def solve(self, options: RecordOptions, check_share: float) -> Solution:
        """Solve once, and estimate the error with up to the given share of the rays of the solve; 0 estimates no
        error.

        With `keep_partial`, an interrupt has the Solution of the finished passes as its attribute `partial`, if there are
        any records; a TimeoutError of the progress function always has it.
        """
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
            if isinstance(options, RadianceOptions):
                statistics["radiance_records"] = float(caches.radiance_count)
            return solved_from_core(
                self.scene, options, caches, statistics, max_depth=self.work.max_depth, complete=complete
            )

        try:
            exchange = (
                self._exchange(SharedSolve(self.scene, self.purpose, options, self._alone()))
                if photons is None
                else None
            )
            run("solve", self.fill(options, caches, photons, exchange), self.work.progress, counted)
        except KeyboardInterrupt as stop:
            if self.keep_partial and caches.near_count:
                stop.partial = solution(False)  # type: ignore[attr-defined]
            raise
        except TimeoutError as late:
            if self.keep_partial:
                late.partial = solution(False)  # type: ignore[attr-defined]
            raise
        return self.checked(solution(True), check_share, caches) if check_share > 0 else solution(True)

    def checked(
        self, solution: Solution, share: float, caches: _core.SolvedCaches | None = None, max_error: float | None = None
    ) -> Solution:
        """Estimate the error of a solution and add the estimate to its statistics.

        The estimate takes at most the given share of the rays of the solve. It takes fewer if it becomes clear sooner
        whether the error is above `max_error`, which by default is that of the options.
        """
        started, counted, check = clock.perf_counter(), _core.Progress(), _core.ErrorCheck()
        check.rays = int(share * solution.statistics["rays"])
        check.wanted = solution.options.max_error if max_error is None else max_error
        check.max_depth, check.seed, check.threads = self.work.max_depth, self.work.seed, self.work.threads
        shared = SharedCheck(self.scene, self.purpose, solution, self._alone(), check.rays, check.wanted)
        if (exchange := self._exchange(shared)) is not None:
            check.share_work(*exchange)
        read = solution.core() if caches is None else caches
        tables = self.tables(solution.options)
        try:
            found = run("check", lambda p: self.functions.estimate(read, check, p, tables), self.work.progress, counted)
        except KeyboardInterrupt as stop:
            if self.keep_partial:
                stop.partial = solution  # type: ignore[attr-defined]
            raise
        statistics = (
            solution.statistics | ErrorEstimate.of_squared(found.squared, found.deviation, found.missed).statistics()
        )
        focused = _core.focused_light(
            compiled(self.scene).core, self.work.max_depth, self.work.seed, self.work.threads, counted
        )
        statistics |= with_light_by_chance(statistics, light_by_chance(focused.by_chance, focused.spread))
        if tables is not None:
            statistics["gloss_estimated"] = float(self.functions.estimates_gloss)
        statistics["check_rays"] = float(counted.rays)
        statistics["rays"] += float(counted.rays)
        statistics["seconds"] += clock.perf_counter() - started
        return replace(solution, statistics=statistics)

    def refined(self, solution: Solution, max_error: float) -> Solution:
        """Solve with finer settings until the upper end of the confidence interval is below `max_error`, or warn why
        that is not possible."""
        refinements, rays, seconds = 0, solution.statistics["rays"], solution.statistics["seconds"]
        while (estimate := solution.estimate) is not None and estimate.high > max_error:
            ratio = laws.step_towards(estimate, max_error)
            options = finer(solution.options, ratio)
            needed = laws.rays_after(solution.statistics["rays"], ratio)
            stopped = (
                f"refine: stopped at an error of {100 * estimate.quoted:.2g} %, not the wanted {100 * max_error:.2g} %"
            )
            if needed > laws.MOST_RAYS:
                limit = f"more than the limit of {laws.MOST_RAYS / 1e6:,.0f} million"
                warn(f"{stopped}: another refinement would take {needed / 1e6:,.0f} million rays, {limit}")
                break
            if replace(options, max_error=solution.options.max_error) == solution.options:
                warn(f"{stopped}: all settings are at the limits of their ranges")
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


@dataclass(frozen=True, eq=False)
class SharedSolve(SharedWork):
    """A solve whose passes are shared."""

    scene: Scene
    purpose: Purpose
    options: RecordOptions
    work: Work

    def follow(self, share: Share, tell: Tell, threads: int) -> None:
        job = Job(self.scene, self.purpose, replace(self.work, threads=threads))
        job.fill(self.options, _core.SolvedCaches(), None, (share, tell))(_core.Progress())


@dataclass(frozen=True, eq=False)
class SharedCheck(SharedWork):
    """An estimate of the error of a solution, of which the probes are shared."""

    scene: Scene
    purpose: Purpose
    solution: Solution
    work: Work
    rays: int
    wanted: float

    def follow(self, share: Share, tell: Tell, threads: int) -> None:
        job = Job(self.scene, self.purpose, replace(self.work, threads=threads))
        check = _core.ErrorCheck()
        check.rays, check.wanted = self.rays, self.wanted
        check.max_depth, check.seed, check.threads = self.work.max_depth, self.work.seed, threads
        check.share_work(share, tell)
        tables = job.tables(self.solution.options)
        job.functions.estimate(self.solution.core(), check, _core.Progress(), tables)
