# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `render`, which makes a picture of a scene."""

from __future__ import annotations

import inspect
import os
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

from eclat import _core
from eclat.bridge.arguments import (
    checked_crop,
    checked_max_depth,
    checked_max_error,
    checked_samples,
    checked_seed,
    checked_time,
    chosen_camera,
    picture_size,
    thread_count,
)
from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError, did_you_mean, shown, warn
from eclat.images import denoiser
from eclat.images.image import Image
from eclat.measure.error_estimate import ErrorEstimate
from eclat.methods import IrradianceCache, Method, Prepared, Source, as_method
from eclat.methods.work import Care, View, Work
from eclat.sampling.adaptive_sampling import checked_adaptive
from eclat.sampling.convergence import MOST_SAMPLES, Goal, Sampling, noise_beside_records
from eclat.scene import Camera, Scene
from eclat.stage.staging import staged
from eclat.tev.display import Display
from eclat.typed import typed
from eclat.verbs.continuing import FROM_PICTURE, Begun, make_continuable
from eclat.verbs.gathered_picture import AIM, gathered
from eclat.verbs.part_of_picture import part_of_picture
from eclat.verbs.picture import Picture, warn_of_error
from eclat.verbs.picture_of_groups import picture_of_groups
from eclat.verbs.picture_samples import sampling_of
from eclat.verbs.previews import previewing, show_looks
from eclat.verbs.shown_while_rendered import shown_while_rendered, with_display
from eclat.verbs.solve import require_check
from eclat.verbs.tiles_on_farm import TILE

FILTERS = ("box", "tent")

SHARE_OF_PROBES = 0.15
"""The share of the time for samples that is reserved for the probes of the finished picture, which take as many paths
as 0.15 of the samples, or fewer if the time is over before.
"""


MOST_GATHERED = 1 << 27
"""Number of paths from which on a final gather ends though its error is still too large. Furnished rooms take some ten
minutes for them on two cores. At least `LEAST_GATHERED` samples per pixel are allowed."""

LEAST_GATHERED = 256


@typed
def render(
    scene: Scene | str | os.PathLike[str],
    what: Source | type[Method] | str | None = None,
    *,
    samples: int | None = None,
    max_error: float = 0.03,
    time: float | None = None,
    size: tuple[int, int] | None = None,
    crop: tuple[int, int, int, int] | None = None,
    camera: int | Camera = 0,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    filter: str = "box",
    adaptive: bool | Literal["noise", "denoised"] | None = None,
    denoise: bool | None = None,
    halves: bool | None = None,
    gathered_samples: int | None = None,
    continued: Image | str | os.PathLike[str] | None = None,
    continuable: bool = False,
    shard: tuple[int, int] | None = None,
    light_groups: bool | Mapping[str, str | Sequence[str]] = False,
    keep_partial: bool = False,
    check: bool = True,
    refine: bool = False,
    progress: ProgressReport | None = None,
    preview: Callable[[Image], None] | None = None,
    display_server: str | Display | None = None,
    tile_order: list[int] | None = None,
) -> Image:
    """Render a picture of the scene.

    Parameters
    ----------
    scene : a scene, the path of a scene file, or the name of a built-in scene. If the scene has no camera or no light,
        `render` adds one and warns, as do the command line and the other verbs.
    what : a method with its options, the class or the name of a method, or a solution that `solve` returned. A method
        is prepared for this picture first. None chooses irradiance caching. For a class or a name, the method's option
        `max_error`, if it has one, is set to `max_error`.
    samples : number of paths per pixel; with `adaptive`, the mean number over all pixels. With None, samples are taken
        until the error is below `max_error`.
    max_error : relative error of the picture, at which sampling stops. The noise is estimated from the passes over the
        picture, and the number of samples is doubled until the noise is small enough or `convergence.MOST_SAMPLES` is
        reached. If records are solved for this picture, `max_error` bounds the error of the whole picture: the noise
        may take the part that the estimated error of the records leaves, and always at least half. If the picture is
        denoised, `max_error` bounds the error that is left after the denoiser, and from 0.02 on irradiance caching makes a
        final gather (`IrradianceCache.final_gather`). If records are read at sight, the picture is in halves and `check` finds
        its error above `max_error` although its noise is low enough, paths that read the records only after a matte surface are
        added, and are blended with it region by region, until the error of the blend is below `max_error` or too many samples
        would be needed (`gathered_picture`); the statistics then hold their number as `gathered_samples`.
    time : stop after about this many seconds instead. The elapsed time then decides how fine the records are and how
        many samples are taken (`time_budget`). The metadata store both decisions; a render with these settings
        reproduces the picture bit for bit.
    size : (width, height) of the picture in pixels. None takes the size that the camera has, or 1280 × 720.
    crop : the rectangle (x0, y0, x1, y1) of pixels to render, x1 and y1 exclusive; all other pixels stay black.
    camera : the index of one of the scene's cameras, or a camera.
    max_depth : greatest number of edges of a path: 1 shows emission only, 2 adds direct light, −1 sets no limit. A
        solution must have been solved with the same value.
    seed : seed of the random numbers. The same seed gives the same picture, bit for bit.
    threads : number of threads; None uses all processors. The number does not change the picture.
    filter : the pixel filter, "box" or "tent".
    adaptive : whether pixels that err more get more samples and the others fewer (`adaptive_sampling`): by their noise,
        "noise", or by the error that the denoiser leaves, "denoised", which needs `halves`. True means the latter if the
        picture is denoised and `time` is not given, because it denoises between passes, and otherwise the former. None means
        True for methods with records if there is no `crop`, and otherwise False. Adaptive sampling biases the picture a
        little, so `Path` uses it only on request. The metadata say which it was.
    denoise : whether Open Image Denoise removes the noise of the picture. The picture is then rendered in two halves,
        from which the remaining error is measured. Where denoising would increase the error, the samples are kept as
        they are (`sampling.denoised_halves`). While `max_error` decides when to stop, a picture whose samples alone
        meet it is not denoised. None means True if Open Image Denoise is installed and neither `samples` nor `crop` is
        given, and otherwise False. The denoiser uses all processors, whatever `threads` is; their number does not
        change its result.
    halves : whether the picture is the mean of two halves, which have half of the samples each and different random
        numbers. The error of a denoised picture is measured from such halves. An odd number of `samples` is then
        rounded up. None means the same as `denoise`.
    gathered_samples : with `samples` and `halves`, the number of samples per pixel that paths add which read records only after a
        matte surface, as `max_error` does otherwise. A picture with such numbers in its statistics can so be repeated.
    continued : a picture that was rendered with `continuable`, or the name of its .exr file, to which samples are added;
        `samples` is the total number. Size, crop, depth, seed, filter, adaptive and halves are those of the picture; scene,
        camera and method must be the same. With the same options, the picture has the same bits as one that took all samples at
        once (with adaptive sampling, if the first number of samples was a power of two). The options of the method may
        differ, so that finer records serve the new samples. Rays and seconds in the statistics are those of this call.
    continuable : whether the picture gets layers with the sums of its samples (`sums_*`, `sample_*`), so that it can be
        continued later. An .exr file is then about three times as large. Continued pictures can be continued again.
    shard : (i, n) renders the i-th of n bands of rows, counted from 1, and `merge_pictures` joins all n to a picture with
        the bits of one that was rendered at once. Each job of an array of n renders one. It needs `samples`; parts are
        `continuable` and have neither adaptive sampling nor halves. Records are solved for the whole picture by each job,
        unless all read one solution.
    light_groups : whether each lamp, or each group of lamps, becomes a layer `light.<name>`, whose strength and colour can be
        changed afterwards (`mix`). True makes a group of each name of a lamp; a dict gives groups by name
        (`eclat.light_groups`). The picture is the sum of the layers, also if it is denoised, because each group is then
        denoised on its own. Each group is solved and sampled on its own, so that `max_error` holds for each, and the cost is
        that of a picture of each. `samples` is the number of each group, and the groups share `time` equally.
    keep_partial : whether Ctrl-C keeps what is finished. The KeyboardInterrupt then has an attribute `partial`, an
        Image of the samples taken so far, whose metadata give their number as `samples_done`. The attribute is absent
        until every pixel has a sample.
    check : whether the error of records that are solved for this picture is estimated, as `solve` does, and that of a
        picture in halves at some of its pixels, by paths that never end in a cache and that are drawn after the last
        sample (`sampling.picture_probes`). The statistics of the picture then hold `cache_error`, the error of the
        records alone, and `estimated_error`, the error of the whole picture, with `estimated_error_low` and
        `estimated_error_high`, the ends of its 95 % confidence interval. `error_in_one_tile` is the share of its square
        that one tile of the picture carries; if it is large there are likely to be more such places that no probe met.
        The error of the whole picture includes the noise of the samples if there are at least two samples.
    refine : whether records that are solved for this picture are refined until their estimated error is below their
        `max_error`.
    progress : a function that is called with the progress of the work, or None.
    preview : a function that is called with unfinished pictures, or None. It is first called with a rough picture of
        fewer pixels, before anything is solved, then, if the picture is large and denoised and its method has
        something to solve, with one of all pixels from few paths, and then between passes, at most once in
        `previews.PREVIEW_SECONDS`. The
        metadata of all these pictures hold `unfinished`, and all except the first also hold `samples_done`.
    display_server : where the picture is shown while it grows: "host:port" of tev (https://github.com/Tom94/tev), such as
        "localhost:14158", or a Display, or None. What `preview` gets is shown there, and between such pictures each tile of
        them as it is finished, with all layers; if the picture is denoised, the tiles are shown as the layer `noisy`. Records are
        marked. A server that is absent, too slow or goes away causes one warning, and the picture is the same as without it.
    tile_order : the order in which tiles are rendered, as a permutation of their indices. The order does not change
        the picture; tests use this argument to check that.

    Returns
    -------
    An Image with the layers direct, indirect, albedo, normal and depth; methods with records add record_density.
    Pictures in halves add error, the relative error around each pixel; denoised ones add noisy, the samples as they were,
    denoiser_weight, the weight of the denoised picture, and rough_albedo and rough_normal, those of the first surface
    that is neither mirror nor clear glass, which guide the denoiser. direct and indirect are not denoised. The
    statistics then hold `noise_left`, the error that the halves measure, with the ends of its 95 % confidence interval,
    and `estimated_error`, which includes the error of the records. Where paths were added to a picture of records,
    record_weight is the weight of the latter; all layers but error are those of the records.
    Radiance caching adds gloss_cached, the share of a pixel's samples in which records gave the light of all visible
    glossy lobes, and gloss_traced, the share in which some lobes were traced. Samples whose value is not finite are
    left out with a warning, and the metadata count them as `bad_samples`.

    Raises
    ------
    EclatError : an argument is out of range, the method is unknown, a solution belongs to another scene or another
        `max_depth`, a picture is to be denoised and Open Image Denoise is not installed, or `continued` cannot be continued or
        shows another scene.

    Examples
    --------
    >>> import eclat
    >>> image = eclat.render(eclat.load("furnace"), eclat.Path(), samples=4, size=(8, 8))
    >>> image.pixels.shape, image.metadata["statistics"]["samples"]
    ((8, 8, 3), 4.0)
    """
    if isinstance(display_server, str) or shard is not None or light_groups is not False:
        return _rendered_by_other_calls(dict(locals()))
    preview = with_display(preview, display_server)
    _refuse_contradictions(samples, time, refine, check)
    scene = staged(scene)
    started = clock.perf_counter()
    begun, settings = _begun(continued, (size, crop, max_depth, seed, filter, adaptive, halves))
    size, crop, max_depth, seed, filter, adaptive, halves = settings
    denoise, halves = _denoise_and_halves(denoise, halves, samples is None and crop is None)
    by_error = checked_adaptive(crop is None if adaptive is None else adaptive, denoise and time is None, halves)
    goal = _goal(samples, gathered_samples, max_error, time, started, denoise, halves)
    view = _view(scene, camera, size)
    region = checked_crop(crop, *view.size)
    order, pixel_filter = _checked_order(tile_order, region), _checked_filter(filter)
    work = Work(checked_max_depth(max_depth), checked_seed(seed), thread_count(threads), progress)
    source = _source(what, max_error, refine)
    if begun is not None:
        begun.require_match(scene, view.camera, source.options.name, samples)
    elif preview is not None:
        show_looks(scene, source, view, work, denoise, preview)
    prepared = source.prepare(scene, view, work, Care(check, refine, denoised=denoise, deadline=goal.deadline))
    by_error = by_error if adaptive is not None or prepared.options.has_records else False
    picture = Picture(
        scene, prepared, view, region, work, by_error, denoise, pixel_filter, _own_estimate(prepared, source), started
    )
    sampling = sampling_of(picture, 1 + halves, order, keep_partial, display_server, begun)
    image, samplings = _rendered(picture, sampling, goal, halves and check, preview, display_server, begun)
    if continuable or begun is not None:
        make_continuable(image, begun, samplings, scene, view.camera, (view.size, *settings[1:5], by_error, halves))
    return image


def _rendered_by_other_calls(arguments: dict[str, Any]) -> Image:
    """Render a picture that consists of others, is a part of one, or is shown by a display that must be connected first."""
    if isinstance(arguments["display_server"], str):
        return shown_while_rendered(render, arguments)
    return (picture_of_groups if arguments["shard"] is None else part_of_picture)(render, arguments)


def _own_estimate(prepared: Prepared, source: Source) -> ErrorEstimate | None:
    """Return the estimated error of what was prepared for this picture. That of a solution which the caller gave may have been
    estimated for another view, so it is not used.
    """
    return None if prepared is source else prepared.estimate


def _view(scene: Scene, camera: int | Camera, size: tuple[int, int] | None) -> View:
    chosen = chosen_camera(scene, camera)
    return View(chosen, picture_size(chosen, size))


def _begun(
    continued: Image | str | os.PathLike[str] | None, given: tuple[Any, ...]
) -> tuple[Begun | None, tuple[Any, ...]]:
    """Return the picture that is continued, if there is one, and the arguments that it determines: its own, or else those that
    were given.
    """
    if continued is None:
        return None, given
    begun, parameters = Begun.of(continued), inspect.signature(render).parameters
    return begun, begun.settings(tuple(parameters[name].default for name in FROM_PICTURE), given)


def _source(what: Source | type[Method] | str | None, max_error: float, refine: bool) -> Source:
    """Return what computes the light. Raises EclatError if it is unknown or cannot be refined as it should be."""
    source = as_method(what, IrradianceCache(max_error=max_error), max_error=max_error)
    if refine and source.options.for_whole_scene:
        raise EclatError(f"refine: expected a method with records, got {source.options.name}")
    return source


def _rendered(
    picture: Picture,
    sampling: Sampling,
    wanted: Goal,
    probes: bool,
    preview: Callable[[Image], None] | None,
    display: Display | None,
    begun: Begun | None,
) -> tuple[Image, tuple[Sampling, Sampling | None]]:
    """Take all samples, measure the error until the deadline if there is one, make the Image and show it on the display, if
    there is one. If the error of the records is too large, add a final gather. Warn of noise and errors that are left above those
    wanted, and of bad samples. Return the samples and, if there is one, those of the final gather.
    """
    if preview is not None:
        sampling.after_pass = previewing(picture, sampling, preview, display)
    goal = _goal_of_samples(wanted, picture, probes)
    with picture.kept(sampling):
        sampling.run(goal)
        probed = picture.probed(sampling, wanted.deadline) if probes else None
    image, gather = picture.finished(sampling, probed), None
    if goal.samples is None and goal.deadline is None:
        least = goal if picture.estimate is not None else wanted
        if sampling.error > least.max_error:
            _warn_of_noise(sampling, least)
        else:
            if probed is not None:
                image, gather = gathered(picture, image, wanted, sampling, probed, preview, begun)
            warn_of_error(image.metadata["statistics"], wanted.max_error)
    elif wanted.gathered_samples is not None:
        image, gather = gathered(picture, image, wanted, sampling, probed, preview, begun)
    picture.tell_bad_samples(image)
    if display is not None:
        display.show(image)
        picture.mark_records(display, image)
    return image, (sampling, gather)


def _refuse_contradictions(samples: int | None, time: float | None, refine: bool, check: bool) -> None:
    if samples is not None and time is not None:
        raise EclatError("render: expected samples or time, got both")
    if refine and time is not None:
        raise EclatError("render: expected refine or time, got both")
    require_check(check, refine)


def _goal_of_samples(goal: Goal, picture: Picture, probes: bool) -> Goal:
    """Return the goal for the samples beside the records of the picture. A deadline is moved forward to leave time for the
    probes, if there are any.
    """
    if picture.estimate is not None:
        goal = replace(goal, max_error=noise_beside_records(goal.max_error, picture.estimate.quoted))
    elif picture.prepared.errs_by_noise_alone:
        if probes:
            goal = replace(goal, max_error=AIM * goal.max_error)
        if picture.prepared.options.has_records:
            width, height = picture.view.size
            goal = replace(goal, most_samples=min(MOST_SAMPLES, max(LEAST_GATHERED, MOST_GATHERED // (width * height))))
    if goal.deadline is None or not probes:
        return goal
    now = clock.perf_counter()
    return replace(goal, deadline=now + (1 - SHARE_OF_PROBES) * (goal.deadline - now))


def _goal(
    samples: int | None,
    gathered: int | None,
    max_error: float,
    time: float | None,
    started: float,
    denoise: bool,
    halves: bool,
) -> Goal:
    """Return the condition at which sampling stops. Raises EclatError if a number is out of range, or if there are no halves
    that samples could be gathered for.
    """
    if gathered is not None and (samples is None or not halves):
        raise EclatError("gathered_samples: expected samples and halves=True beside it")
    counts = [None if number is None else checked_samples(number) for number in (samples, gathered)]
    deadline = None if checked_time(time) is None else started + float(time or 0)
    return Goal(counts[0], checked_max_error(max_error), deadline, denoise, gathered_samples=counts[1])


def _denoise_and_halves(denoise: bool | None, halves: bool | None, whole: bool) -> tuple[bool, bool]:
    """Return whether the picture is denoised, and whether it is taken in halves. `whole` says that it is not cropped and that no
    number of samples was given. Raises EclatError if it should be denoised but cannot be.
    """
    if denoise is None:
        denoise = denoiser.has_denoiser() and whole and halves is not False
    if not denoise:
        return False, bool(halves)
    denoiser.require_denoiser()
    if halves is False:
        raise EclatError(
            "render: expected halves=True with denoise, because the halves measure the remaining error, got False"
        )
    return True, True


def _checked_order(order: list[int] | None, region: tuple[int, int, int, int]) -> list[int]:
    """Return the order of the tiles, or an empty list for the usual order. Raises EclatError if it is no permutation."""
    if order is None:
        return []
    x0, y0, x1, y1 = region
    count = (-(-x1 // TILE) - x0 // TILE) * (-(-y1 // TILE) - y0 // TILE)
    if sorted(order) != list(range(count)):
        raise EclatError(
            f"tile_order: expected a permutation of the {count} indices 0 to {count - 1}, got {shown(order)}"
        )
    return [int(index) for index in order]


def _warn_of_noise(sampling: Sampling, goal: Goal) -> None:
    """Warn that sampling stopped before it reached its goal."""
    what = "relative noise after denoising" if sampling.denoised else "relative noise"
    noise = f"the {what} is still {sampling.error:.2g}, above the wanted {goal.max_error:.2g}"
    warn(f"render: stopped after {sampling.taken:,} samples per pixel; {noise}")


def _checked_filter(name: str) -> _core.Filter:
    if name not in FILTERS:
        known = ", ".join(FILTERS)
        raise EclatError(f"filter must be one of {known}, got {name!r}{did_you_mean(str(name), FILTERS)}")
    return _core.Filter[name]
