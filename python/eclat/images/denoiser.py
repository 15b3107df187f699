# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Remove noise from images with Open Image Denoise, an optional dependency (`pip install eclat[denoise]`).

Its neural network was trained on path-traced images. With the albedo and the normals of the visible surfaces, it can
distinguish edges from noise. All the same it carries 3 to 5 % of a bright lamp over its edge, to pixels that become up to
twenty times too bright. Beside what is far brighter, its result is therefore limited by the samples (`within_edges`).
"""

from __future__ import annotations

import importlib
import importlib.util
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat.errors import EclatError
from eclat.images.nines import Real, most_of_nine, own_or_median

Picture = NDArray[np.float32]

PACKAGE = "pyoidn"
"""The Python package that contains Open Image Denoise."""

LEAK = 0.1
"""Part of the brightest denoised value of the 3 × 3 pixels around, below which a denoised value is limited by the samples. It is
above the 3 to 5 % that Open Image Denoise carries over the edges of lamps."""

BRIGHTER = 2.0
"""Largest factor by which a denoised value that is limited may be above the samples, and by which samples that are shown beside
denoised ones may be above these. By judgement."""


def has_denoiser() -> bool:
    """Return whether Open Image Denoise is installed."""
    return importlib.util.find_spec(PACKAGE) is not None


def require_denoiser() -> None:
    """Raise EclatError if Open Image Denoise is not installed. Call it before a long computation.

    The message says how to install it.
    """
    if not has_denoiser():
        raise EclatError(
            f"denoising needs Open Image Denoise, which is not installed; install it with: pip install {PACKAGE}, or "
            "install Éclat with its extra `denoise`"
        )


def denoise(
    radiance: ArrayLike,
    albedo: ArrayLike | None = None,
    normal: ArrayLike | None = None,
    kind: Literal["picture", "lightmap"] = "picture",
) -> Picture:
    """Remove the noise from an image, with the highest quality of Open Image Denoise, and keep lamps within their edges.

    Parameters
    ----------
    radiance : (H, W, 3) linear radiance of an image or irradiance of a light map. Values that are not finite become 0.
    albedo : (H, W, 3) the albedo of the surface at each pixel in 0..1, averaged over the same samples as the image.
    normal : (H, W, 3) the normal of the surface at each pixel in −1..1, averaged likewise. It is only useful together
        with `albedo`.
    kind : the network to use: "picture" for images, or "lightmap" for light maps, which have no albedo and no normals.

    Returns
    -------
    (H, W, 3) float32, at least 0. The same input always gives the same bits.

    Raises
    ------
    EclatError : the package pyoidn is not installed, the shapes differ, or `albedo` or `normal` is given for a light map.
    """
    require_denoiser()
    guides = {"albedo": (albedo, 0.0, 1.0), "normal": (normal, -1.0, 1.0)}
    if kind == "lightmap" and (albedo is not None or normal is not None):
        raise EclatError("denoise: expected neither albedo nor normals for a light map, got at least one of them")
    color = _layer(radiance, 0.0, np.inf)
    layers = {name: _layer(guide, low, high) for name, (guide, low, high) in guides.items() if guide is not None}
    for name, layer in {"radiance": color, **layers}.items():
        if layer.ndim != 3 or layer.shape != (*color.shape[:2], 3):
            raise EclatError(
                f"denoise: expected an array {name} of the shape {(*color.shape[:2], 3)}, got {layer.shape}"
            )
    oidn = importlib.import_module(PACKAGE)
    filter_type = oidn.OIDN_FILTER_TYPE_RT_LIGHTMAP if kind == "lightmap" else oidn.OIDN_FILTER_TYPE_RT
    out = oidn.denoise(color, hdr=True, quality="high", filter_type=filter_type, **layers)
    return within_edges(color, np.maximum(np.asarray(out, dtype=np.float32), np.float32(0)))


def within_edges(samples: NDArray[Real], denoised: NDArray[Real]) -> NDArray[Real]:
    """Limit denoised pixels (H, W, 3) beside far brighter ones to `BRIGHTER` times the samples, channel by channel.

    Limited are pixels that in some channel are below `LEAK` times the brightest of the nine around. The samples are the pixel's
    own or the median of the nine, whichever is brighter, because its own may have missed the light by chance.
    """
    beside = np.any(denoised < LEAK * most_of_nine(denoised), axis=-1)
    out = denoised.copy()
    out[beside] = np.minimum(denoised[beside], BRIGHTER * own_or_median(samples, beside))
    return out


def _layer(values: ArrayLike, low: float, high: float) -> Picture:
    """Convert `values` to float32 in `low`..`high`. Values that are not finite become 0."""
    finite = np.nan_to_num(np.asarray(values, dtype=np.float32), nan=0.0, posinf=0.0, neginf=0.0)
    return np.ascontiguousarray(np.clip(finite, low, high))
