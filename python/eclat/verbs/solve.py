# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verbs `solve` and `refine`, which compute the solution of a method for a scene, to keep it and use it again."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, overload

from numpy.typing import ArrayLike

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
from eclat.errors import EclatError, shown
from eclat.methods import IrradianceCache, Method, Solved, as_method
from eclat.methods.work import AtPoints, Care, Everywhere, Purpose, View, Work
from eclat.scene import Camera, Scene
from eclat.stage.staging import staged
from eclat.typed import typed

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
    points: tuple[ArrayLike, ArrayLike] | None = None,
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
    points: tuple[ArrayLike, ArrayLike] | None = None,
    view_independent: bool = False,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    keep_partial: bool = False,
    check: bool = True,
    refine: bool = False,
    progress: ProgressReport | None = None,
) -> Solved: ...


@typed
def solve(
    scene: Scene | str | os.PathLike[str],
    what: Method | type[Method] | str | None = None,
    *,
    camera: int | Camera | None = None,
    size: tuple[int, int] | None = None,
    points: tuple[ArrayLike, ArrayLike] | None = None,
    view_independent: bool = False,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    keep_partial: bool = False,
    check: bool = True,
    refine: bool = False,
    progress: ProgressReport | None = None,
) -> Solved:
    """Solve a scene by a method. `render`, `irradiance` and `bake` can read the solution.

    The records of irradiance caching and radiance caching are made for a view (the default), for points, or for all
    surfaces. Photon maps and radiosity are solved for the whole scene; only the arguments `max_depth`, `seed`,
    `threads` and `progress` apply to them.

    Parameters
    ----------
    what : a method, its class or its name; None means irradiance caching.
    camera, size : the view and its (width, height) in pixels, which determine the spacing of the records. The defaults
        are the first camera of the scene and its size.
    points : positions and normals, (N, 3) each, for which records are made instead of for a view. The points need not
        lie on a surface. Each point gets a record, unless it is within the radius of another record.
    view_independent : whether records are made on all diffuse surfaces instead of for a view, on each side that
        reflects. Radiance caching also makes records on all glossy surfaces, for all view directions. A pixel in the
        options then means 0.0016 times the distance that a record sees (the harmonic mean of the farther half of the
        distances of its gather rays), which in a room is about a thousandth of its diagonal.
    max_depth : greatest number of edges of a path: 2 is direct light only, −1 sets no limit.
    keep_partial : whether Ctrl-C keeps what is finished. The KeyboardInterrupt then has an attribute `partial`, the
        Solution of the finished passes, marked as incomplete. The attribute is absent during the first passes, which
        make only far records.
    check : whether the error of the records is estimated, by path-traced gathers that never end in a cache. They take
        up to the share `CHECK_SHARE` of the rays of the solve. The statistics then hold `estimated_error` with
        `estimated_error_low` and `estimated_error_high`, the ends of its 95 % confidence interval. It is the error of
        the light from records, relative to all light as in `metrics.relative_rmse`, over the pixels of the view, the
        points or all surfaces. For a view it includes gloss from records of radiance. For all surfaces it covers
        irradiance alone, and `gloss_estimated` in the statistics is 0.
    refine : whether to solve again with finer settings until the upper end of the confidence interval is below the
        `max_error` of the options. Refining stops with a warning before a step that would take more than
        `laws.MOST_RAYS` rays. The statistics then hold the number of `refinements`, and the rays and seconds of all
        solves together.

    Returns
    -------
    The solution: a `Solution`, `Photons` or a `RadiositySolution`. The same arguments give the same bits with any number
    of `threads`.

    Raises
    ------
    EclatError : the method has nothing to solve, an argument is out of range, the arrays differ in shape or are not
        finite, or more than one of camera, points and view_independent is given.

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
            f"solve: {method.name} is solved for the whole scene: expected no camera, size, points, view_independent, "
            "refine or keep_partial"
        )
    require_check(check, refine)
    purpose: Purpose = Everywhere()
    if not method.for_whole_scene:
        purpose = purpose_of(scene, camera=camera, size=size, points=points, view_independent=view_independent)
    work = Work(checked_max_depth(max_depth), checked_seed(seed), thread_count(threads), progress)
    return method.solve(scene, purpose, work, Care(check=check, refine=refine, keep_partial=keep_partial))


@typed
def refine(
    solution: Solved,
    scene: Scene | str | os.PathLike[str],
    max_error: float | None = None,
    *,
    camera: int | Camera | None = None,
    size: tuple[int, int] | None = None,
    points: tuple[ArrayLike, ArrayLike] | None = None,
    view_independent: bool = False,
    seed: int = 0,
    threads: int | None = None,
    keep_partial: bool = False,
    check: bool = True,
    progress: ProgressReport | None = None,
) -> Solved:
    """Solve again with finer settings than those of a Solution. The results of repeated calls converge to the exact
    light.

    All settings that the error depends on become finer (`laws.finer`), also those of the far records in which gather
    rays end. All records are gathered anew with more rays, so none of the old noise remains.

    Parameters
    ----------
    max_error : refine until the upper end of the confidence interval is below this value, as `solve` does with
        `refine`. With None, one step is taken, to half the error.
    keep_partial, check : as in `solve`. `check` must be True if `max_error` is given.
    camera, size, points, view_independent : the view, the points or the surfaces that the Solution was solved for, as
        in `solve`.

    Raises
    ------
    EclatError : the Solution belongs to another scene, or for the reasons given in `solve`.
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
    """Raise EclatError if refinement is requested without the estimate of the error that it needs."""
    if refine and not check:
        raise EclatError("refine: expected check=True, because refining stops at an estimated error, got check=False")


def purpose_of(
    scene: Scene,
    *,
    camera: int | Camera | None = None,
    size: tuple[int, int] | None = None,
    points: tuple[ArrayLike, ArrayLike] | None = None,
    view_independent: bool = False,
) -> Purpose:
    """Return the purpose that the arguments of `solve` describe. Raises EclatError if they contradict each other."""
    if (camera is not None or size is not None) + (points is not None) + view_independent > 1:
        raise EclatError("solve: expected at most one of camera (with size), points and view_independent, got several")
    if points is not None:
        if not isinstance(points, tuple | list) or len(points) != 2:
            raise EclatError(f"points: expected a pair of arrays, points and normals, got {shown(points)}")
        return AtPoints(*points_with_normals(*points))
    if view_independent:
        return Everywhere()
    view = chosen_camera(scene, 0 if camera is None else camera)
    return View(view, picture_size(view, size))
