# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How records are solved for a view, for points or for all surfaces, and how they are checked and refined."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.bridge.running import run
from eclat.errors import EclatError, warn
from eclat.measure.error_estimate import CHECK_SHARE, ErrorEstimate, with_light_by_chance
from eclat.methods.photon_map import PhotonMap, trace
from eclat.methods.records import laws
from eclat.methods.records.laws import CHECK_SHARE_OF_REFINEMENT, core_options, core_radiance_options, finer
from eclat.methods.records.options import RadianceOptions, RecordOptions
from eclat.methods.records.radiance_tables import radiance_tables
from eclat.methods.records.solution import Solution, solved_from_core
from eclat.methods.work import AtPoints, Care, Everywhere, Purpose, Work
from eclat.scene import Scene

SURFACE_POINTS = 1 << 14
"""At which irradiance everywhere is checked, evenly spread over all surfaces."""


def solve_records(scene: Scene, options: RecordOptions, purpose: Purpose, work: Work, care: Care) -> Solution:
    """Solve records for a purpose, and check and refine them as `care` says."""
    job = Job(scene, purpose, work, care.keep_partial)
    solution = job.solve(options, CHECK_SHARE_OF_REFINEMENT if care.refine else CHECK_SHARE if care.check else 0.0)
    return job.refined(solution, options.max_error) if care.refine else solution


def refine_records(
    solution: Solution, scene: Scene, purpose: Purpose, work: Work, care: Care, max_error: float | None
) -> Solution:
    """Solve finer records until their error meets `max_error`. None takes one step, to half the error."""
    job = Job(scene, purpose, work, care.keep_partial)
    if max_error is None:
        return job.solve(finer(solution.options, 0.5), CHECK_SHARE if care.check else 0.0)
    if solution.estimate is None:
        solution = job.checked(solution, CHECK_SHARE_OF_REFINEMENT)
    return job.refined(solution, max_error)


@dataclass(frozen=True)
class Where:
    """The purpose of records, which decides how caches are filled and how their error is estimated."""

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


@dataclass(frozen=True, eq=False)
class Job:
    """The solves of one scene for one purpose."""

    scene: Scene
    purpose: Purpose
    work: Work
    keep_partial: bool = False

    @cached_property
    def where(self) -> Where:
        """How caches are filled and checked for the purpose."""
        return where_wanted(self.scene, self.purpose)

    def _fill(
        self, options: RecordOptions, caches: _core.SolvedCaches, photons: _core.PhotonMaps | None
    ) -> Callable[[_core.Progress], None]:
        common = {"max_depth": self.work.max_depth, "seed": self.work.seed, "threads": self.work.threads}
        fill_radiance, tables = self.where.fill_radiance, self._tables(options)
        if isinstance(options, RadianceOptions) and fill_radiance is not None and tables is not None:
            with_radiance = core_radiance_options(options, **common)
            with_radiance.irradiance.far_photons = photons
            return lambda p: fill_radiance(caches, tables, with_radiance, p)
        settings = core_options(options, **common)
        settings.far_photons = photons
        return lambda p: self.where.fill(caches, settings, p)

    def _tables(self, options: RecordOptions) -> _core.RadianceTables | None:
        if not isinstance(options, RadianceOptions) or self.where.fill_radiance is None:
            return None
        return radiance_tables(self.scene, options, threads=self.work.threads or None, progress=self.work.progress)

    def _photons(self, options: RecordOptions) -> tuple[_core.PhotonMaps | None, float]:
        """The photons that gather rays end in, if any, and the number of rays that tracing them took."""
        if not options.far_photons or self.work.max_depth >= 0:
            return None, 0.0
        if self.scene.environment is not None:
            raise EclatError(
                "far_photons: expected a scene without an environment image, whose light gathers collect themselves"
            )
        photons = trace(
            self.scene, PhotonMap(photons=options.far_photons, caustic_photons=max(1000, options.far_photons // 4)),
            self.work,
        )  # fmt: skip
        maps = photons.maps(self.scene, gather=True, threads=self.work.threads, progress=self.work.progress)
        return maps, photons.statistics["rays"]

    def solve(self, options: RecordOptions, check_share: float) -> Solution:
        """One solve, whose check may take the given share of its rays."""
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
            run("solve", self._fill(options, caches, photons), self.work.progress, counted)
        except KeyboardInterrupt as stop:
            if self.keep_partial and caches.near_count:
                stop.partial = solution(False)  # type: ignore[attr-defined]
            raise
        return self.checked(solution(True), check_share, caches) if check_share > 0 else solution(True)

    def checked(
        self, solution: Solution, share: float, caches: _core.SolvedCaches | None = None, max_error: float | None = None
    ) -> Solution:
        """The solution with an estimate of its error in the statistics. The gathers for it take at most the given share
        of the solve's rays, and fewer if it is soon clear whether the error is above `max_error` (default: that of the
        options)."""
        started, counted, check = clock.perf_counter(), _core.Progress(), _core.ErrorCheck()
        check.rays = int(share * solution.statistics["rays"])
        check.wanted = solution.options.max_error if max_error is None else max_error
        check.max_depth, check.seed, check.threads = self.work.max_depth, self.work.seed, self.work.threads
        read = solution.core() if caches is None else caches
        tables = self._tables(solution.options)
        try:
            found = run("check", lambda p: self.where.estimate(read, check, p, tables), self.work.progress, counted)
        except KeyboardInterrupt as stop:
            if self.keep_partial:
                stop.partial = solution  # type: ignore[attr-defined]
            raise
        statistics = (
            solution.statistics | ErrorEstimate.of_squared(found.squared, found.deviation, found.missed).statistics()
        )
        by_chance, _ = _core.focused_light(
            compiled(self.scene).core, self.work.max_depth, self.work.seed, self.work.threads, counted
        )
        statistics |= with_light_by_chance(statistics, by_chance)
        if tables is not None:
            statistics["gloss_estimated"] = float(self.where.estimates_gloss)
        statistics["check_rays"] = float(counted.rays)
        statistics["rays"] += float(counted.rays)
        statistics["seconds"] += clock.perf_counter() - started
        return replace(solution, statistics=statistics)

    def refined(self, solution: Solution, max_error: float) -> Solution:
        """Solve with finer settings until the estimate and its margin meet `max_error`, or warn why they cannot."""
        refinements, rays, seconds = 0, solution.statistics["rays"], solution.statistics["seconds"]
        while (estimate := solution.estimate) is not None and estimate.high > max_error:
            ratio = laws.step_towards(estimate, max_error)
            options = finer(solution.options, ratio)
            needed = laws.rays_after(solution.statistics["rays"], ratio)
            stopped = f"stopped at {100 * estimate.quoted:.2g} %, expected {100 * max_error:.2g} %: another refinement"
            if needed > laws.MOST_RAYS:
                warn(f"{stopped} would take {needed / 1e6:,.0f} million rays, more than {laws.MOST_RAYS / 1e6:,.0f}")
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


def where_wanted(scene: Scene, purpose: Purpose) -> Where:
    """How caches are filled and checked for a purpose."""
    prepared = compiled(scene)
    if isinstance(purpose, AtPoints):
        positions = prepared.to_core(purpose.positions)
        directions = np.ascontiguousarray(purpose.normals, np.float32)
        return Where(
            lambda caches, o, p: _core.solve_at_points(prepared.core, positions, directions, o, caches, p),
            lambda caches, c, p, _: _core.estimate_error_at_points(prepared.core, positions, directions, caches, c, p),
        )
    if isinstance(purpose, Everywhere):
        return Where(
            lambda caches, o, p: _core.solve_everywhere(prepared.core, o, caches, p),
            lambda caches, c, p, _: _core.estimate_error_everywhere(prepared.core, SURFACE_POINTS, caches, c, p),
            lambda caches, tables, o, p: _core.solve_radiance_everywhere(prepared.core, tables, o, caches, p),
        )
    camera = prepared.camera(purpose.camera, purpose.size)
    return Where(
        lambda caches, o, p: _core.solve_for_camera(prepared.core, camera, o, caches, p),
        lambda caches, c, p, tables: _core.estimate_error_for_camera(prepared.core, camera, caches, c, p, tables),
        lambda caches, tables, o, p: _core.solve_radiance_for_camera(prepared.core, camera, tables, o, caches, p),
        estimates_gloss=True,
    )
