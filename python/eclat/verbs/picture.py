# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of the verb `render`: one takes samples, the other makes an Image with layers, metadata and a stated error."""

from __future__ import annotations

import time as clock
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import eclat
from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.bridge.notebook import notebook_report
from eclat.bridge.running import ProgressReport, run
from eclat.errors import warn
from eclat.images.image import Image
from eclat.images.record_overlay import record_density, visible_places
from eclat.measure.error_estimate import ErrorEstimate, error_text, with_light_by_chance
from eclat.methods import Prepared
from eclat.methods.work import View, Work
from eclat.sampling.adaptive_sampling import Adaptive, Counts
from eclat.sampling.convergence import Sampling
from eclat.sampling.denoised_halves import DenoisedHalves
from eclat.sampling.halves import Halves, Region, seed_of_half
from eclat.sampling.picture_probes import ProbedError, joined, number_of_paths, probed_error
from eclat.scene import Scene
from eclat.tev.display import Display
from eclat.tev.growing import GrowingPicture

FIRST_SEED_OF_PROBES = 2
"""The halves have the first two seeds of a picture, its probes the next ones."""

SEEDS = 5
"""The number of these seeds. The picture that is gathered for another one has those that follow."""

COMMON = 12**-0.5
"""What all paths of a final gather have in common of the squared error of the records may be any part of it between none and all:
nearly all in a room that is lit through a gap, where few records hold the light, and little in others. This is the standard
deviation of a number of which nothing else is known."""


class SampleTaker:
    """Adds samples to films, with one estimator for all samples or a new estimator for each sample.

    Parameters
    ----------
    pixels : the pixels and the seed of each film. Sample n of film k, of K films, is sample K n + k of the picture.
    growing : shows the tiles that these ranges of pixels let it know, or None.
    """

    def __init__(
        self,
        scene: Scene,
        prepared: Prepared,
        view: View,
        work: Work,
        films: list[_core.Film],
        pixels: list[_core.RenderRange],
        growing: GrowingPicture | None = None,
    ) -> None:
        self._camera = compiled(scene).camera(view.camera, view.size)
        self._films, self._pixels = films, pixels
        self._growing = growing
        self._estimator_of = prepared.passes(scene, work)
        if self._estimator_of is None:
            self._estimator = prepared.radiance_estimator(scene, work)

    def samples(self, first: Counts, end: Counts, report: ProgressReport | None) -> float:
        """Take samples [first, end) of each pixel of each film, which may differ between pixels; return the number of rays."""
        rays = 0.0
        for number in range(len(self._films)):
            counted = _core.Progress()
            part = self._watched(self._part_of_report(number, rays, report))
            film, pixels = self._films[number], self._pixels[number]

            def take(p: _core.Progress, film: Any = film, number: int = number, pixels: Any = pixels) -> None:
                self.take_into(film, number, pixels, (first, end), p)

            run("render", take, part, counted)
            if self._growing is not None:
                self._growing.show()
            rays += float(counted.rays)
        return rays

    def _watched(self, report: ProgressReport | None) -> ProgressReport | None:
        """Make a function that reports, and that shows the tiles which were finished meanwhile, if someone wants to see them."""
        growing = self._growing
        if growing is None:
            return report
        told = report or notebook_report()

        def watched(phase: str, fraction: float, statistics: dict[str, float]) -> None:
            growing.show()
            if told is not None:
                told(phase, fraction, statistics)

        return watched

    def _part_of_report(self, number: int, rays: float, report: ProgressReport | None) -> ProgressReport | None:
        """Make a function that turns reports about one film into reports about all films."""
        if report is None or len(self._films) == 1:
            return report

        def part(phase: str, fraction: float, statistics: dict[str, float]) -> None:
            report(phase, (number + fraction) / len(self._films), statistics | {"rays": rays + statistics["rays"]})

        return part

    def take_into(
        self,
        film: _core.Film,
        number: int,
        pixels: _core.RenderRange,
        counts: tuple[Counts, Counts],
        progress: _core.Progress,
    ) -> None:
        """Take the samples between two numbers of each pixel into a film that is, or is a part of, film `number`."""
        first, end = counts
        if self._estimator_of is None:
            _core.render(self._camera, film, self._estimator, pixels, first, end, progress)
            return
        for sample in range(int(first.min()), int(end.max())):
            estimator = self._estimator_of(len(self._films) * sample + number, progress)
            begins, ends = (np.clip(counts, sample, sample + 1) for counts in (first, end))
            _core.render(self._camera, film, estimator, pixels, begins, ends, progress)


@dataclass(frozen=True, eq=False)
class Picture:
    """The scene, view and settings of one picture, from which its Image with layers and metadata is made."""

    scene: Scene
    prepared: Prepared
    view: View
    region: Region
    work: Work
    adaptive: Adaptive
    denoise: bool
    filter: _core.Filter
    estimate: ErrorEstimate | None
    """The estimated error of the records that were solved for this view, or None."""
    started: float
    first_seed: int = 0
    """The number of the first of its seeds (`seed_of_half`)."""

    @contextmanager
    def kept(self, sampling: Sampling) -> Iterator[None]:
        """Attach the picture of the samples taken so far to a KeyboardInterrupt, if `keep_partial` was given."""
        try:
            yield
        except KeyboardInterrupt as stop:
            if sampling.partial is not None:
                image = self.unfinished(sampling.partial, sampling, sampling.partial_taken)
                image.metadata["samples_done"] = sampling.partial_taken
                stop.partial = image  # type: ignore[attr-defined]
            raise

    def finished(self, sampling: Sampling, probed: ProbedError | None = None) -> Image:
        """Make the Image of all samples, from the last evaluation of the halves if there are any, with the error that
        the probes measured.
        """
        return self._image(sampling.film, sampling, sampling.taken, sampling.found, probed)

    def mark_records(self, display: Display, image: Image) -> None:
        """Mark on the display where the records are in an Image of this picture, finished or not."""
        records = self.prepared.record_positions
        if records is not None:
            display.mark_records(visible_places(image, self.view.camera, records))

    def probed(self, sampling: Sampling, deadline: float | None) -> ProbedError | None:
        """Measure the error of the picture at some pixels by paths of their own, once all samples are taken, at as many
        pixels as there is time for until `deadline`, a value of `time.perf_counter`, if it is given.

        Return None if the picture was not taken in halves, or if the method has no estimator that could judge it.
        """
        film, found = sampling.film, sampling.found
        reference = self.prepared.reference_estimator(self.scene, self.work)
        if reference is None or found is None or not isinstance(film, Halves):
            return None
        camera = compiled(self.scene).camera(self.view.camera, self.view.size)

        def take(counts: Counts, number: int) -> NDArray[np.float32]:
            taken, counted = _core.Film(*self.view.size), _core.Progress()
            end = film.pasted(counts).astype(np.uint32)
            seed = seed_of_half(self.work.seed, self.first_seed + FIRST_SEED_OF_PROBES + number)
            pixels = _core.RenderRange(
                crop=self.region, seed=seed, threads=self.work.threads, filter=self.filter, tile_order=[]
            )
            first = np.zeros(end.size, dtype=np.uint32)

            def work(progress: _core.Progress) -> None:
                _core.render(camera, taken, reference, pixels, first, end.ravel(), progress)

            run("check", work, self.work.progress, counted)
            sampling.rays += float(counted.rays)
            return film.within(taken.radiance)

        paths = number_of_paths(found.squared.size, sampling.taken)
        return probed_error(found, take, paths, seed_of_half(self.work.seed, self.first_seed), deadline)

    def unfinished(self, film: _core.Film | Halves, sampling: Sampling, taken: int) -> Image:
        """Make the Image of a film, or of a copy of it, that holds `taken` samples per pixel; it is denoised if that
        was requested.
        """
        found = None
        if isinstance(film, Halves):
            found = film.denoised() if self.denoise else film.sampled()
        return self._image(film, sampling, taken, found)

    def _image(
        self, film: _core.Film | Halves, sampling: Sampling, taken: int, found: DenoisedHalves | None,
        probed: ProbedError | None = None,
    ) -> Image:  # fmt: skip
        whole = film.whole() if isinstance(film, Halves) else film
        radiance, direct = whole.radiance, whole.direct
        layers = {
            "direct": direct, "indirect": radiance - direct,
            "albedo": whole.albedo, "normal": whole.normal, "depth": whole.depth,
        }  # fmt: skip
        options = self.prepared.options
        denoised = found is not None and bool(found.weight.any())
        metadata: dict[str, Any] = {
            "scene": self.scene.name, "method": options.name, "options": asdict(options),
            "seed": self.work.seed, "max_depth": self.work.max_depth, "adaptive": self.adaptive,
            "halves": isinstance(film, Halves), "denoised": denoised,
            "version": eclat.__version__, "statistics": self._statistics(whole, sampling, taken, found, probed),
        }  # fmt: skip
        pixels = radiance
        if isinstance(film, Halves) and found is not None:
            layers["error"] = film.pasted(found.local_error)
            if denoised:
                layers |= {
                    "noisy": radiance, "denoiser_weight": film.pasted(found.weight),
                    "rough_albedo": whole.rough_albedo, "rough_normal": whole.rough_normal,
                }  # fmt: skip
                pixels = film.pasted(found.pixels)
        image = Image(pixels, layers | self.prepared.layers(whole), metadata)
        records = self.prepared.record_positions
        if records is not None:
            image.layers["record_density"] = self._inside(record_density(image, self.view.camera, records))
        self._count_bad_samples(image, whole)
        return image

    def _inside(self, layer: NDArray[np.float32]) -> NDArray[np.float32]:
        x0, y0, x1, y1 = self.region
        inside = np.zeros_like(layer)
        inside[y0:y1, x0:x1] = layer[y0:y1, x0:x1]
        return inside

    def _statistics(
        self,
        film: _core.Film,
        sampling: Sampling,
        taken: int,
        found: DenoisedHalves | None,
        probed: ProbedError | None,
    ) -> dict[str, float]:
        rays = sampling.rays + self.prepared.statistics.get("rays", 0.0)
        statistics = {"samples": float(taken), "rays": rays, "seconds": clock.perf_counter() - self.started}
        if sampling.noise == sampling.noise:
            statistics["noise"] = sampling.noise
        statistics |= self.prepared.picture_statistics(film)
        if found is not None:
            statistics |= found.estimate.noise_statistics()
        if self.estimate is not None:
            statistics["cache_error"] = self.estimate.quoted
        whole = self.error_of(found, statistics.get("noise", 0.0), probed, self.reflected(film))
        if whole is not None:
            statistics |= whole.statistics()
            statistics |= with_light_by_chance(statistics, self.prepared.statistics)
        return statistics

    def reflected(self, film: _core.Film) -> float:
        """Return the share of the light in the picture that has been reflected."""
        x0, y0, x1, y1 = self.region
        light, direct = (float(layer[y0:y1, x0:x1].mean()) for layer in (film.radiance, film.direct))
        return min(1.0, max(0.0, 1 - direct / light)) if light > 0 else 0.0

    def error_of(
        self, found: DenoisedHalves | None, noise: float, probed: ProbedError | None, reflected: float = 1.0
    ) -> ErrorEstimate | None:
        """Return the estimated error of the whole picture, from that of its records, of its halves or its noise, and of its
        probes, as far as they are known; None if the error of its method is not. `reflected` is the share of reflected light.

        Halves do not show what all paths have in common: of the squared error of records that they read later, in the light
        that has been reflected, this may be any part (`COMMON`), so it makes the halves' estimate less certain.
        """
        own, whole = None if found is None else found.estimate, None
        if self.estimate is not None:
            whole = self.estimate.joined(own) if own is not None else self.estimate.with_noise(noise)
        elif self.prepared.errs_by_noise_alone:
            behind = self.prepared.error_behind
            whole = own
            if found is not None and own is not None and behind is not None and found.other_weight is None:
                whole = own.less_certain(COMMON * (reflected * behind.error) ** 2)
        return whole if probed is None else joined(probed, whole)

    def _count_bad_samples(self, image: Image, film: _core.Film) -> None:
        if film.bad_count:
            image.metadata["bad_samples"] = {"count": int(film.bad_count), "first": list(film.bad_samples[0])}

    def tell_bad_samples(self, image: Image) -> None:
        """Warn of the samples that were left out because they were not finite."""
        bad = image.metadata.get("bad_samples")
        if bad is None:
            return
        x, y, sample = bad["first"]
        x0, y0, x1, y1 = self.region
        taken = int(image.metadata["statistics"]["samples"]) * (x1 - x0) * (y1 - y0)
        halves = ", halves=True, denoise=False" if image.metadata["halves"] else ""
        warn(
            f"{bad['count']:,} of {taken:,} samples were not finite and are left out; "
            f"the first is sample {sample} of pixel ({x}, {y})\n"
            f"         to repeat it, call eclat.render(…) with the same arguments and samples={sample + 1}, "
            f"crop=({x}, {y}, {x + 1}, {y + 1}), size=({self.view.size[0]}, {self.view.size[1]}){halves}"
        )


CLEARLY_MORE = 1.25
"""Ratio of an estimated error to the wanted one above which it is not the estimate's own uncertainty: this is a fifth or more."""


def warn_of_error(statistics: Mapping[str, float], max_error: float) -> None:
    """Warn if the probes of a finished picture found clearly more than the wanted error, which its noise had reached."""
    found = statistics.get("estimated_error", 0.0)
    if found > CLEARLY_MORE * max_error:
        wanted = f"above the wanted {100 * max_error:.2g} %"
        if statistics.get("gathered_samples") and statistics["noise_left"] > max_error:
            warn(f"render: {error_text(statistics)}, {wanted}: too many samples would be needed")
            return
        warn(
            f"render: {error_text(statistics)}, {wanted}, although the noise is low enough: what is left are errors of "
            "records and of the denoiser, which a smaller max_error or refine=True lower"
        )
