# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Unfinished pictures for those who wait: looks before anything is solved, and the samples between passes."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable

from eclat import _core
from eclat.images.image import Image
from eclat.methods import Method, Path, Source
from eclat.methods.work import View, Work
from eclat.sampling.convergence import Goal, Sampling
from eclat.sampling.halves import Halves
from eclat.scene import Scene
from eclat.tev.display import Display
from eclat.verbs.first_look import first_look, is_reduced
from eclat.verbs.picture import Picture
from eclat.verbs.picture_samples import sampling_of

SECOND_LOOK_SAMPLES = 2
"""Paths per pixel of the second picture that is shown, one for each half. With the denoiser they take some 12 s of two
processors at 1280 × 720 in a furnished room, where the records take a minute or more."""

PREVIEW_SECONDS = 4.0
"""The least number of seconds between two previews. The picture is then updated often enough for a viewer, and rarely
enough that writing it takes little time.
"""


def show_looks(
    scene: Scene, source: Source, view: View, work: Work, denoise: bool, preview: Callable[[Image], None]
) -> None:
    """Show what there is before anything is solved."""
    started = clock.perf_counter()
    preview(first_look(scene, source, view, work))
    if denoise and isinstance(source, Method) and source.solved is not None and is_reduced(view):
        preview(_second_look(scene, view, work, started))


def _second_look(scene: Scene, view: View, work: Work, started: float) -> Image:
    """Render a picture of all pixels from few paths, denoised and with its measured error, to show while records are
    solved, which takes a minute or more for the pictures that need it.
    """
    region = (0, 0, *view.size)
    prepared = Path().prepare(scene, view, work)
    picture = Picture(scene, prepared, view, region, work, False, True, _core.Filter.box, None, started)
    sampling = sampling_of(picture, Halves.each, [], False, None, None)
    sampling.run(Goal(SECOND_LOOK_SAMPLES, 1.0, None, denoised=True))
    image = picture.finished(sampling)
    image.metadata.update(unfinished=True, samples_done=sampling.taken)
    return image


def previewing(
    picture: Picture, sampling: Sampling, preview: Callable[[Image], None], display: Display | None
) -> Callable[[], None]:
    """Make the function that is called between passes. It shows the unfinished picture, unless another was shown
    shortly before.
    """
    last = -math.inf

    def show() -> None:
        nonlocal last
        if clock.perf_counter() - last < PREVIEW_SECONDS:
            return
        shown = sampling.denoised or not picture.denoise
        film, taken = sampling.film, sampling.taken
        image = picture.finished(sampling) if shown else picture.unfinished(film, sampling, taken)
        image.metadata.update(unfinished=True, samples_done=sampling.taken)
        preview(image)
        if display is not None:
            picture.mark_records(display, image)
        last = clock.perf_counter()

    return show
