# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Frames that take the samples of the frames around them as well, along the motion vectors, before they are denoised.

Each frame is first rendered alone, so that the result does not depend on the order of the frames. Pixels at edges keep their
own samples, because a pixel there sees two surfaces, of which only one is followed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from eclat.frames.followed import Look, accumulated
from eclat.images import denoiser
from eclat.images.image import Image
from eclat.measure.metrics import away_from_edges

Layer = NDArray[np.floating]


def with_samples_of(image: Image, objects: Layer, others: Sequence[tuple[Image, Layer, Layer]], reach: int) -> Image:
    """Return a frame with the mean of its own samples and those of others.

    Parameters
    ----------
    image : the frame alone.
    objects : (H, W) the numbers of the objects that it shows.
    others : frames before and after it, each with its objects and the motion (H, W, 3) that leads to it.
    reach : the number of frames before and after, for the metadata.

    Returns
    -------
    The frame, denoised if it was. Its errors in the statistics remain those of the frame alone.
    """
    own = _samples(image)
    mean = accumulated(_look(image, objects), [(_look(other, there), motion) for other, there, motion in others])
    inside = away_from_edges(image.layers["depth"], image.layers["normal"]).reshape(objects.shape)
    mean = np.where((inside & _alike(objects))[..., None], mean, own).astype(np.float32)
    pixels, layers = mean, dict(image.layers)
    if "denoiser_weight" in layers:
        clean = denoiser.denoise(mean, layers["rough_albedo"], layers["rough_normal"])
        weight = layers["denoiser_weight"].reshape(objects.shape)[..., None]
        pixels = (weight * clean + (1 - weight) * mean).astype(np.float32)
        layers["noisy"] = mean
    return replace(image, pixels=pixels, layers=layers, metadata=image.metadata | {"accumulated": reach})


def _samples(image: Image) -> Layer:
    return image.layers.get("noisy", image.pixels)


def _look(image: Image, objects: Layer) -> Look:
    return Look(_samples(image), objects, image.layers["normal"], image.layers["depth"].reshape(objects.shape))


def _alike(objects: Layer) -> NDArray[np.bool_]:
    """Return the pixels (H, W) whose eight neighbours show the same object."""
    around = sliding_window_view(np.pad(objects, 1, mode="edge"), (3, 3))
    return np.asarray(around.max(axis=(-1, -2)) == around.min(axis=(-1, -2)))
