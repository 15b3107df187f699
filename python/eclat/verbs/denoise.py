# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `denoise`, which removes the noise of finished pictures and measures the error that remains."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.images import denoiser
from eclat.images.image import Image
from eclat.images.mixing import PREFIX, groups_of, sum_of
from eclat.sampling.denoised_halves import judged_halves
from eclat.typed import typed


@typed
def denoise(picture: Image, other: Image | None = None) -> Image:
    """Remove the noise of a picture with Open Image Denoise (`pip install pyoidn`).

    Parameters
    ----------
    picture : a picture that `render` made. Its layers `albedo` and `normal` show the denoiser where the edges of
        objects and textures are.
    other : a second picture of the same scene, with as many samples and another seed. The error of each denoised
        picture is then measured against the noisy samples of the other one, without a reference
        (`sampling.denoised_halves`), and where denoising would increase the error, the samples are kept as they are. An
        error that both pictures share, such as the error of a cache that both read, is not measured.

    Returns
    -------
    An Image whose layer `noisy` is the picture before denoising. If the picture has layers of groups of lamps, each is denoised
    by itself, and the pixels are their sum, so that they can still be mixed. With `other`, the statistics hold `estimated_error`,
    the error of the result, with `estimated_error_low` and `estimated_error_high`, the ends of its 95 % confidence
    interval; and `noise_before`, the error of the mean of both pictures before denoising.

    Raises
    ------
    EclatError : Open Image Denoise is not installed, or the two pictures differ in size, are the same picture, or have
        groups of lamps.
    """
    if other is None:
        layers = picture.layers | {"noisy": picture.pixels}
        groups = {name: _denoised(replace(picture, pixels=light)) for name, light in groups_of(picture).items()}
        pixels = sum_of(list(groups.values())) if groups else _denoised(picture)
        layers |= {PREFIX + name: light for name, light in groups.items()}
        return replace(picture, pixels=pixels, layers=layers, metadata=picture.metadata | {"denoised": True})
    if groups_of(picture) or groups_of(other):
        raise EclatError("denoise: expected one picture with groups of lamps, or two without, got two with groups")
    if picture.pixels.shape != other.pixels.shape:
        sizes = " and ".join(f"{image.width}x{image.height}" for image in (picture, other))
        raise EclatError(f"denoise: expected two pictures of the same size, got {sizes}")
    if np.array_equal(picture.pixels, other.pixels):
        raise EclatError("denoise: expected two pictures rendered with different seeds, got the same picture twice")
    found = judged_halves(picture.pixels, other.pixels, _denoised(picture), _denoised(other))
    low, high = (max(0.0, found.squared_error + sign * 1.96 * found.deviation) ** 0.5 for sign in (-1, 1))
    statistics = {
        "estimated_error": found.error,
        "estimated_error_low": low,
        "estimated_error_high": high,
        "noise_before": max(0.0, found.raw_squared_error) ** 0.5,
    }
    half = np.float32(0.5)
    layers = {name: half * (a + other.layers[name]) for name, a in picture.layers.items() if name in other.layers}
    layers |= {"noisy": half * (picture.pixels + other.pixels), "denoiser_weight": found.weight.astype(np.float32)}
    metadata = picture.metadata | {
        "denoised": True,
        "seeds": [image.metadata.get("seed") for image in (picture, other)],
    }
    metadata["statistics"] = dict(picture.metadata.get("statistics", {})) | statistics
    return Image(found.pixels.astype(np.float32), layers, metadata)


def _denoised(picture: Image) -> NDArray[np.float32]:
    albedo, normal = (picture.layers.get(f"rough_{name}", picture.layers.get(name)) for name in ("albedo", "normal"))
    return denoiser.denoise(picture.pixels, albedo, normal)
