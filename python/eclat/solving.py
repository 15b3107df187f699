# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb solve: records of a scene, for a view, for points, or for all of its surfaces."""

from __future__ import annotations

import time as clock
from collections.abc import Callable

import numpy as np

from eclat import _core
from eclat.arguments import (
    checked_max_depth,
    checked_seed,
    chosen_camera,
    picture_size,
    points_with_normals,
    thread_count,
)
from eclat.compiled import Compiled, compiled
from eclat.errors import EclatError
from eclat.options import IrradianceCache
from eclat.running import ProgressReport, run
from eclat.scene import Camera, FloatArray, Scene
from eclat.solution import Solution, core_options, solved_from_core

Fill = Callable[[_core.SolvedCaches, _core.Progress], None]
"""Fills caches in place; what it has done when it is stopped stays in them."""


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
    progress: ProgressReport | None = None,
) -> Solution:
    """Compute irradiance records where they are wanted: in a view (the default), at points, or everywhere.

    Parameters
    ----------
    camera, size : the view, and its (width, height) in pixels; records are spaced by projected pixels. Default: the
        scene's first camera and that camera's size.
    points : positions and normals, (N, 3) each, instead of a view. They need not lie on a surface; each gets a record
        unless another one serves it.
    view_independent : records for all diffuse surfaces instead of a view, on each side that reflects. Without a
        view a pixel of `options` is a thousandth of the scene's diameter.
    max_depth : edges of a path: 2 direct light only, −1 unlimited.
    keep_partial : Ctrl-C still raises KeyboardInterrupt, but its attribute `partial` is then the Solution of the
        passes that were finished, for a view, points or everywhere alike, marked incomplete; absent as long as there
        are far records only, which the first passes make.

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
    options = options or IrradianceCache()
    settings = core_options(
        options, max_depth=checked_max_depth(max_depth), seed=checked_seed(seed), threads=thread_count(threads)
    )
    if (camera is not None or size is not None) + (points is not None) + view_independent > 1:
        raise EclatError("solve: expected one of camera (with size), points and view_independent, got several")
    started = clock.perf_counter()
    prepared = compiled(scene)
    if points is not None:
        fill = _fill_points(prepared, *points_with_normals(*points), settings)
    elif view_independent:

        def fill(caches: _core.SolvedCaches, p: _core.Progress) -> None:
            _core.solve_everywhere(prepared.core, settings, caches, p)
    else:
        view = chosen_camera(scene, 0 if camera is None else camera)
        core_camera = prepared.camera(view, picture_size(view, size))

        def fill(caches: _core.SolvedCaches, p: _core.Progress) -> None:
            _core.solve_for_camera(prepared.core, core_camera, settings, caches, p)

    caches = _core.SolvedCaches()

    def solution(complete: bool, rays: float) -> Solution:
        statistics = {
            "records": float(caches.near_count),
            "far_records": float(caches.far_count),
            "rays": rays,
            "seconds": clock.perf_counter() - started,
        }
        return solved_from_core(scene, options, caches, statistics, max_depth=max_depth, complete=complete)

    counted = _core.Progress()
    try:
        run("solve", lambda p: fill(caches, p), progress, counted)
    except KeyboardInterrupt as stop:
        if keep_partial and caches.near_count:
            stop.partial = solution(False, float(counted.rays))  # type: ignore[attr-defined]
        raise
    return solution(True, float(counted.rays))


def _fill_points(
    prepared: Compiled, points: FloatArray, normals: FloatArray, settings: _core.IrradianceCacheOptions
) -> Fill:
    positions, directions = prepared.to_core(points), np.ascontiguousarray(normals, np.float32)
    return lambda caches, p: _core.solve_at_points(prepared.core, positions, directions, settings, caches, p)
