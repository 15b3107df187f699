# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb solve: it computes the part of a method's work that can be kept and used again."""

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
    """Solve a scene by a method; `render`, `irradiance` and `bake` can read the solution.

    Records of irradiance and radiance caching are made for a view (the default), for points, or for all surfaces.
    Photons and radiosity are solved for the whole scene, so only `max_depth`, `seed`, `threads` and `progress` apply to
    them.

    Parameters
    ----------
    what : a method, its class or its name; None is irradiance caching.
    camera, size : the view, and its (width, height) in pixels, which determine the spacing of records. The defaults are
        the scene's first camera and that camera's size.
    points : positions and normals, (N, 3) each, instead of a view. The points need not lie on a surface. Each point
        gets a record unless another record serves it.
    view_independent : make records on all diffuse surfaces instead of for a view, on each side that reflects. Radiance
        caching also makes records on all glossy surfaces, for all view directions. Lengths in pixels in the options are
        then in 0.0016 of the distance that a record sees: in a room about a thousandth of its diagonal.
    max_depth : edges of a path: 2 direct light only, −1 unlimited.
    keep_partial : on Ctrl-C, give the KeyboardInterrupt an attribute `partial`: the Solution of the finished passes,
        marked incomplete. The attribute is absent while there are only far records, which the first passes make.
    check : estimate the error of the records by path-traced gathers that never end in a cache. This takes up to
        `CHECK_SHARE` of the solve's rays. The statistics then hold `estimated_error` with `estimated_error_low` and
        `_high` (95 %). The measure is that of `metrics.relative_rmse` over all pixels of the view, over the points, or
        over all surfaces: the error of the light that records provide, relative to all light there. For a view this
        includes gloss from records of radiance. For all surfaces it covers irradiance alone, and the statistics say so.
    refine : solve again with finer settings until the estimate and its margin meet the `max_error` of the options. It
        stops with a warning before a step that would take more than `laws.MOST_RAYS`. The statistics then hold the
        number of `refinements`, and the rays and seconds of all solves together.

    The same arguments give the same bits for any number of `threads`.

    Raises
    ------
    EclatError : the method has nothing to solve, arguments are out of range, arrays do not fit or are not finite, or
        more than one of view, points and view_independent is given.

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
    """Solve again with finer settings than those of a Solution. Repeated calls approach the exact light.

    Every setting that the error depends on becomes finer (`laws.finer`), for records and for the far records in which
    their gathers end. All records are gathered anew with more rays, so none of the old noise stays.

    Parameters
    ----------
    max_error : refine until the estimated error and its margin meet this value, as `solve` does with `refine`. None
        takes one step, to half the error.
    keep_partial, check : as in `solve`. Refinement towards a `max_error` needs the check.
    camera, size, points, view_independent : what the Solution was solved for, as in `solve`.

    Raises
    ------
    EclatError : the Solution is for another scene, or for the same reasons as in `solve`.
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
    """The purpose that the arguments of `solve` describe. Raises EclatError if they contradict each other."""
    if (camera is not None or size is not None) + (points is not None) + view_independent > 1:
        raise EclatError("solve: expected one of camera (with size), points and view_independent, got several")
    if points is not None:
        return AtPoints(*points_with_normals(*points))
    if view_independent:
        return Everywhere()
    view = chosen_camera(scene, 0 if camera is None else camera)
    return View(view, picture_size(view, size))
