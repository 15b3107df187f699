# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A small, quick picture that is shown until the first samples of the real one are there."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage

from eclat import _core
from eclat.images import denoiser
from eclat.images.image import Image
from eclat.methods import Path, Source
from eclat.methods.work import View, Work
from eclat.scene import Scene
from eclat.verbs.picture import SampleTaker

PIXELS = 1 << 17
"""Most pixels of a first look, 480 × 270 of 16:9. Tuned: a furnished room of 1280 × 720 then has one within two seconds on two
processors, of which the denoiser takes a third."""

SAMPLES = 2
"""Paths per pixel; the denoiser makes much of a second one, and little of a third."""


def first_look(scene: Scene, source: Source, view: View, work: Work) -> Image:
    """Render a rough picture of the view.

    Path tracing replaces methods that must first be solved, because solving takes too long for a preview. The picture
    is rendered with at most `PIXELS` pixels, denoised if a denoiser is installed, and enlarged to the size of the view.
    Its metadata hold `unfinished`.
    """
    shown = source.options if source.options.solved is None else Path()
    small = View(view.camera, _small(view.size))
    prepared = shown.prepare(scene, small, work)
    film = _core.Film(*small.size)
    pixels = _core.RenderRange(
        crop=(0, 0, *small.size), seed=work.seed, threads=work.threads, filter=_core.Filter.box, tile_order=[]
    )
    first, end = (np.array([count], dtype=np.uint32) for count in (0, SAMPLES))
    SampleTaker(scene, prepared, small, work, [film], [pixels]).samples(first, end, work.progress)
    picture = film.radiance
    if denoiser.has_denoiser():
        picture = denoiser.denoise(picture, film.rough_albedo, film.rough_normal)
    metadata = {"scene": scene.name, "method": shown.name, "unfinished": True}
    return Image(_enlarged(picture, view.size), {}, metadata)


def is_reduced(view: View) -> bool:
    """Return whether the first look of a view has fewer pixels than the view."""
    return _small(view.size) != view.size


def _small(size: tuple[int, int]) -> tuple[int, int]:
    """Return the size with the same proportions and at most `PIXELS` pixels."""
    scale = min(1.0, math.sqrt(PIXELS / (size[0] * size[1])))
    return max(1, int(scale * size[0])), max(1, int(scale * size[1]))


def _enlarged(picture: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.float32]:
    """Return the picture (h, w, 3) with bilinear interpolation at another size (width, height)."""
    channels = [PillowImage.fromarray(picture[..., k]).resize(size, PillowImage.Resampling.BILINEAR) for k in range(3)]
    return np.stack([np.asarray(channel, dtype=np.float32) for channel in channels], axis=-1)
