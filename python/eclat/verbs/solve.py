# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb solve: what a method learns about a scene, as a value."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, overload

from eclat.bridge.arguments import (
    checked_max_depth,
    checked_max_error,
    checked_seed,
    chosen_camera,
    picture_size,
    points_with_normals,
    thread_count,
)
from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError
from eclat.methods import IrradianceCache, Method, Solved, as_method
from eclat.methods.work import AtPoints, Care, Everywhere, Purpose, View, Work
from eclat.scene import Camera, FloatArray, Scene
from eclat.stage.staging import staged

if TYPE_CHECKING:
    from eclat.methods.photon_map import PhotonMap, Photons
    from eclat.methods.radiosity import Radiosity, RadiositySolution
    from eclat.methods.records.solution import Solution


@overload
def solve(
    scene: Scene | str | os.PathLike[str],
    what: IrradianceCache | type[IrradianceCache] | None = None,
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
    scene: Scene | str | os.PathLike[str],
    what: PhotonMap | type[PhotonMap],
    *,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> Photons: ...


@overload
def solve(
    scene: Scene | str | os.PathLike[str],
    what: Radiosity | type[Radiosity],
    *,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> RadiositySolution: ...


@overload
def solve(
    scene: Scene | str | os.PathLike[str],
    what: Method | type[Method] | str,
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
) -> Solved: ...


def solve(
    scene: Scene | str | os.PathLike[str],
    what: Method | type[Method] | str | None = None,
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
) -> Solved:
    """Compute what a method learns about a scene, to be kept and read by `render`, `irradiance` and `bake`.

    Records of irradiance and radiance caching are made for a view (the default), for points, or for all surfaces. Photons
    and radiosity are for the whole scene, so that of the following only `max_depth`, `seed`, `threads` and `progress` apply.

    Parameters
    ----------
    what : a method, its class or its name; None is irradiance caching.
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
        step would take more than `laws.MOST_RAYS`, which is said in a warning. The statistics then hold the number of
        `refinements`; rays and seconds are those of all.

    Same arguments, same bits, whatever `threads`.

    Raises
    ------
    EclatError : a method that has nothing to solve, arguments out of range, arrays that do not fit or are not finite, more
        than one of view, points and view_independent.

    Examples
    --------
    >>> import eclat
    >>> scene = eclat.load("furnace")
    >>> desk = eclat.solve(scene, points=([[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
    >>> len(desk)
    1
    """
    method = as_method(what, IrradianceCache()).options
    scene = staged(scene)
    where_given = camera is not None or size is not None or points is not None or view_independent
    if method.for_whole_scene and (where_given or refine or keep_partial):
        raise EclatError(
            f"solve: {method.name} is for the whole scene: expected no view, no points, no refinement and no keep_partial"
        )
    require_check(check, refine)
    purpose: Purpose = Everywhere()
    if not method.for_whole_scene:
        purpose = purpose_of(scene, camera=camera, size=size, points=points, view_independent=view_independent)
    work = Work(checked_max_depth(max_depth), checked_seed(seed), thread_count(threads), progress)
    return method.solve(scene, purpose, work, Care(check=check, refine=refine, keep_partial=keep_partial))


def refine(
    solution: Solved,
    scene: Scene | str | os.PathLike[str],
    max_error: float | None = None,
    *,
    camera: int | Camera | None = None,
    size: tuple[int, int] | None = None,
    points: tuple[FloatArray, FloatArray] | None = None,
    view_independent: bool = False,
    seed: int = 0,
    threads: int | None = None,
    keep_partial: bool = False,
    check: bool = True,
    progress: ProgressReport | None = None,
) -> Solved:
    """Go on from a Solution with finer settings: towards the exact light, the more often it is called.

    Every setting that the error depends on is made finer (`laws.finer`), that of records and that of the far records
    in which their gathers end, and records are gathered anew with more rays: none of the old noise stays.

    Parameters
    ----------
    max_error : go on until the estimated error with its margin meets it, as `solve` does with `refine`; None: one step,
        to half the error.
    keep_partial, check : as in `solve`; a solve that goes on towards `max_error` cannot do without its check.
    camera, size, points, view_independent : what the Solution was solved for, as in `solve`.

    Raises
    ------
    EclatError : a Solution of another scene; else as `solve`.
    """
    scene = staged(scene)
    solution.require_match(scene, solution.max_depth)
    if max_error is not None:
        checked_max_error(max_error)
    require_check(check, max_error is not None)
    purpose = purpose_of(scene, camera=camera, size=size, points=points, view_independent=view_independent)
    work = Work(solution.max_depth, checked_seed(seed), thread_count(threads), progress)
    care = Care(check=check, refine=max_error is not None, keep_partial=keep_partial)
    return solution.options.refine(solution, scene, purpose, work, care, max_error)


def require_check(check: bool, refine: bool) -> None:
    """Raises EclatError for a refinement without a check."""
    if refine and not check:
        raise EclatError("refine: expected check beside it, since an estimate of the error says when to stop")


def purpose_of(
    scene: Scene,
    *,
    camera: int | Camera | None = None,
    size: tuple[int, int] | None = None,
    points: tuple[FloatArray, FloatArray] | None = None,
    view_independent: bool = False,
) -> Purpose:
    """For what a scene is solved, by the arguments of `solve`. Raises EclatError where they contradict each other."""
    if (camera is not None or size is not None) + (points is not None) + view_independent > 1:
        raise EclatError("solve: expected one of camera (with size), points and view_independent, got several")
    if points is not None:
        return AtPoints(*points_with_normals(*points))
    if view_independent:
        return Everywhere()
    view = chosen_camera(scene, 0 if camera is None else camera)
    return View(view, picture_size(view, size))
