# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `render`, which makes a picture of a scene."""

from __future__ import annotations

import os
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

import eclat
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
from eclat.bridge.compiled import compiled
from eclat.bridge.running import ProgressReport, run
from eclat.errors import EclatError, did_you_mean, warn
from eclat.images.image import Image
from eclat.images.record_overlay import record_density
from eclat.measure.error_estimate import LIGHT_BY_CHANCE, ErrorEstimate, with_light_by_chance
from eclat.methods import IrradianceCache, Method, Prepared, Source, as_method
from eclat.methods.work import Care, View, Work
from eclat.sampling.adaptive_sampling import AdaptiveSamples, Counts
from eclat.sampling.convergence import Goal, Sampling
from eclat.scene import Camera, Scene
from eclat.stage.staging import staged
from eclat.verbs.solve import require_check

FILTERS = ("box", "tent")

Region = tuple[int, int, int, int]
"""A rectangle of pixels (x0, y0, x1, y1); x1 and y1 are exclusive."""


def render(
    scene: Scene | str | os.PathLike[str],
    what: Source | type[Method] | str | None = None,
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
    """Render a picture of the scene.

    Parameters
    ----------
    scene : a scene, the path of a scene file, or the name of a built-in scene. If the scene has no camera or no light,
        `render` adds one and warns, as do the command line and the other verbs.
    what : a method with its options, the class or the name of a method, or a solution that `solve` returned. A method
        is prepared for this picture first. None chooses irradiance caching. For a class or a name, the method's option
        `max_error`, if it has one, is set to `max_error`.
    samples : number of paths per pixel; with `adaptive`, the mean number over all pixels. With None, samples are taken
        until the noise is below `max_error`.
    max_error : relative error of the picture, at which sampling stops. The noise is estimated from the passes over the
        picture, and the number of samples is doubled until the noise is small enough or `convergence.MOST_SAMPLES` is
        reached. If records are solved for this picture, `max_error` bounds the error of the whole picture: the noise
        may take the part that the estimated error of the records leaves, and always at least half.
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
    adaptive : whether noisy pixels get more samples and the others fewer (`adaptive_sampling`). None means True for
        methods with records if there is no `crop`, and otherwise False. Adaptive sampling biases the picture a little,
        so `Path` uses it only on request.
    keep_partial : whether Ctrl-C keeps what is finished. The KeyboardInterrupt then has an attribute `partial`, an
        Image of the samples taken so far, whose metadata give their number as `samples_done`. The attribute is absent
        until every pixel has a sample.
    check : whether the error of records that are solved for this picture is estimated, as `solve` does. The statistics
        of the picture then hold `cache_error`, the error of the records alone, and `estimated_error`, the error of the
        whole picture, with `estimated_error_low` and `estimated_error_high`, the ends of its 95 % confidence interval.
        The error of the whole picture includes the noise of the samples if there are at least two samples.
    refine : whether records that are solved for this picture are refined until their estimated error is below their
        `max_error`.
    progress : a function that is called with the progress of the work, or None.
    tile_order : the order in which tiles are rendered, as a permutation of their indices. The order does not change
        the picture; tests use this argument to check that.

    Returns
    -------
    An Image with the layers direct, indirect, albedo, normal and depth; methods with records add record_density.
    Radiance caching adds gloss_cached, the share of a pixel's samples in which records gave the light of all visible
    glossy lobes, and gloss_traced, the share in which some lobes were traced. Samples whose value is not finite are
    left out with a warning, and the metadata count them as `bad_samples`.

    Raises
    ------
    EclatError : an argument is out of range, the method is unknown, or a solution belongs to another scene or another
        `max_depth`.

    Examples
    --------
    >>> import eclat
    >>> image = eclat.render(eclat.load("furnace"), eclat.Path(), samples=4, size=(8, 8))
    >>> image.pixels.shape, image.metadata["statistics"]["samples"]
    ((8, 8, 3), 4.0)
    """
    _refuse_contradictions(samples, time, refine, check)
    scene = staged(scene)
    started = clock.perf_counter()
    deadline = None if checked_time(time) is None else started + float(time or 0)
    goal = Goal(None if samples is None else checked_samples(samples), checked_max_error(max_error), deadline)
    chosen = chosen_camera(scene, camera)
    view = View(chosen, picture_size(chosen, size))
    region = checked_crop(crop, *view.size)
    work = Work(checked_max_depth(max_depth), checked_seed(seed), thread_count(threads), progress)
    pixels = _core.RenderRange(
        crop=region, seed=seed, threads=work.threads, filter=_checked_filter(filter), tile_order=tile_order or []
    )
    source = as_method(what, IrradianceCache(max_error=max_error), max_error=max_error)
    if refine and source.options.for_whole_scene:
        raise EclatError(f"refine: expected a method with records, got {source.options.name}")
    prepared = source.prepare(scene, view, work, Care(check=check, refine=refine, deadline=deadline))
    # The error of a solution that the caller gave may have been estimated for another view, so it is not used here.
    estimate = None if prepared is source else prepared.estimate
    if estimate is not None:
        goal = replace(goal, max_error=max_error * max(0.5, 1 - (estimate.quoted / max_error) ** 2) ** 0.5)
    if adaptive is None:
        adaptive = prepared.options.has_records and crop is None
    picture = _Picture(scene, prepared, view, region, work, adaptive, estimate, started)
    film = _core.Film(*view.size)
    take = _SampleTaker(scene, prepared, view, work, film, pixels)
    sampling = Sampling(
        film, take.samples, keep_partial, progress, AdaptiveSamples(view.size, region) if adaptive else None
    )
    with picture.kept(sampling):
        sampling.run(goal)
    if samples is None and deadline is None and sampling.noise > goal.max_error:
        noise = f"the noise is still {sampling.noise:.2g}, above the wanted {goal.max_error:.2g}"
        warn(f"render: stopped after {sampling.taken:,} samples, where {noise}")
    image = picture.image(film, sampling, sampling.taken)
    picture.tell_bad_samples(image, film, sampling.taken)
    return image


def _refuse_contradictions(samples: int | None, time: float | None, refine: bool, check: bool) -> None:
    if samples is not None and time is not None:
        raise EclatError("render: expected samples or time, got both")
    if refine and time is not None:
        raise EclatError("render: expected refine or time, got both")
    require_check(check, refine)


def _checked_filter(name: str) -> _core.Filter:
    if name not in FILTERS:
        known = ", ".join(FILTERS)
        raise EclatError(f"filter must be one of {known}, got {name!r}{did_you_mean(str(name), FILTERS)}")
    return _core.Filter[name]


class _SampleTaker:
    """Adds samples to a film, with one estimator for all samples or a new estimator for each sample."""

    def __init__(
        self,
        scene: Scene,
        prepared: Prepared,
        view: View,
        work: Work,
        film: _core.Film,
        pixels: _core.RenderRange,
    ) -> None:
        self._camera = compiled(scene).camera(view.camera, view.size)
        self._film, self._pixels = film, pixels
        self._estimator_of = prepared.passes(scene, work)
        if self._estimator_of is None:
            self._estimator = prepared.radiance_estimator(scene, work)

    def samples(self, first: Counts, end: Counts, report: ProgressReport | None) -> float:
        """Take samples [first, end) of each pixel, which may differ between pixels; return the number of rays."""
        counted = _core.Progress()
        run("render", lambda p: self._take(first, end, p), report, counted)
        return float(counted.rays)

    def _take(self, first: Counts, end: Counts, progress: _core.Progress) -> None:
        if self._estimator_of is None:
            _core.render(self._camera, self._film, self._estimator, self._pixels, first, end, progress)
            return
        for number in range(int(first.min()), int(end.max())):
            estimator = self._estimator_of(number, progress)
            begins, ends = (np.clip(counts, number, number + 1) for counts in (first, end))
            _core.render(self._camera, self._film, estimator, self._pixels, begins, ends, progress)


@dataclass(frozen=True, eq=False)
class _Picture:
    """The scene, view and settings of one picture, from which its Image with layers and metadata is made."""

    scene: Scene
    prepared: Prepared
    view: View
    region: Region
    work: Work
    adaptive: bool
    estimate: ErrorEstimate | None
    """The estimated error of the records that were solved for this view, or None."""
    started: float

    @contextmanager
    def kept(self, sampling: Sampling) -> Iterator[None]:
        """Attach the picture of the samples taken so far to a KeyboardInterrupt, if `keep_partial` was given."""
        try:
            yield
        except KeyboardInterrupt as stop:
            if sampling.partial is not None:
                image = self.image(sampling.partial, sampling, sampling.partial_taken)
                image.metadata["samples_done"] = sampling.partial_taken
                stop.partial = image  # type: ignore[attr-defined]
            raise

    def image(self, film: _core.Film, sampling: Sampling, taken: int) -> Image:
        """Make the Image of a film that holds `taken` samples per pixel, with its layers and metadata."""
        radiance, direct = film.radiance, film.direct
        layers = {
            "direct": direct, "indirect": radiance - direct,
            "albedo": film.albedo, "normal": film.normal, "depth": film.depth,
        }  # fmt: skip
        options = self.prepared.options
        metadata = {
            "scene": self.scene.name, "method": options.name, "options": asdict(options),
            "seed": self.work.seed, "max_depth": self.work.max_depth, "adaptive": self.adaptive,
            "version": eclat.__version__, "statistics": self._statistics(film, sampling, taken),
        }  # fmt: skip
        image = Image(radiance, layers | self.prepared.layers(film), metadata)
        records = self.prepared.record_positions
        if records is not None:
            image.layers["record_density"] = self._inside(record_density(image, self.view.camera, records))
        return image

    def _inside(self, layer: NDArray[np.float32]) -> NDArray[np.float32]:
        x0, y0, x1, y1 = self.region
        inside = np.zeros_like(layer)
        inside[y0:y1, x0:x1] = layer[y0:y1, x0:x1]
        return inside

    def _statistics(self, film: _core.Film, sampling: Sampling, taken: int) -> dict[str, float]:
        rays = sampling.rays + self.prepared.statistics.get("rays", 0.0)
        statistics = {"samples": float(taken), "rays": rays, "seconds": clock.perf_counter() - self.started}
        if sampling.noise == sampling.noise:
            statistics["noise"] = sampling.noise
        statistics |= self.prepared.picture_statistics(film)
        if self.estimate is not None:
            whole = self.estimate.with_noise(statistics.get("noise", 0.0))
            statistics |= whole.statistics() | {"cache_error": self.estimate.quoted}
            statistics |= with_light_by_chance(statistics, self.prepared.statistics.get(LIGHT_BY_CHANCE, 0.0))
        return statistics

    def tell_bad_samples(self, image: Image, film: _core.Film, taken: int) -> None:
        """Report the samples that were left out because they were not finite, in the metadata and in a warning."""
        if not film.bad_count:
            return
        x, y, sample = film.bad_samples[0]
        x0, y0, x1, y1 = self.region
        image.metadata["bad_samples"] = {"count": int(film.bad_count), "first": [x, y, sample]}
        warn(
            f"{film.bad_count:,} of {taken * (x1 - x0) * (y1 - y0):,} samples were not finite and are left out; "
            f"the first is sample {sample} of pixel ({x}, {y})\n"
            f"         to repeat it, call eclat.render(…) with the same arguments and samples={sample + 1}, "
            f"crop=({x}, {y}, {x + 1}, {y + 1}), size=({self.view.size[0]}, {self.view.size[1]})"
        )
