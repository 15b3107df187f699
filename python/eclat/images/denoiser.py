# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Open Image Denoise, which takes the noise out of pictures: an extra, `pip install eclat[denoise]`.

The network was trained on path-traced pictures; albedo and normals beside a picture tell it which edges are real.
"""

from __future__ import annotations

import importlib
import importlib.util
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat.errors import EclatError

Picture = NDArray[np.float32]

PACKAGE = "pyoidn"


def has_denoiser() -> bool:
    """Return whether `denoise` can run."""
    return importlib.util.find_spec(PACKAGE) is not None


def require_denoiser() -> None:
    """Raise EclatError, which says what to install, unless `denoise` can work; call it before any work is done."""
    if not has_denoiser():
        raise EclatError(
            f"denoising needs Open Image Denoise, which is not installed: pip install {PACKAGE}, or Éclat with its extra "
            "`denoise`"
        )


def denoise(
    radiance: ArrayLike,
    albedo: ArrayLike | None = None,
    normal: ArrayLike | None = None,
    kind: Literal["picture", "lightmap"] = "picture",
) -> Picture:
    """The picture without its noise, with the highest quality that Open Image Denoise has.

    Parameters
    ----------
    radiance : (H, W, 3) linear radiance, or irradiance of a light map; what is not finite counts as black.
    albedo, normal : (H, W, 3) of the surface that each pixel sees, in 0..1 and −1..1, with the same samples as the
        picture; a normal without an albedo is of no use.
    kind : which network: for pictures, or for light maps, which have no albedo and no normals.

    Returns
    -------
    (H, W, 3) float32, not negative. The same input gives the same bits.

    Raises
    ------
    EclatError : the package pyoidn is not installed, shapes differ, or a light map with albedo or normals.
    """
    require_denoiser()
    guides = {"albedo": (albedo, 0.0, 1.0), "normal": (normal, -1.0, 1.0)}
    if kind == "lightmap" and (albedo is not None or normal is not None):
        raise EclatError("denoise: expected a light map without albedo and normals, but they were given")
    color = _layer(radiance, 0.0, np.inf)
    layers = {name: _layer(guide, low, high) for name, (guide, low, high) in guides.items() if guide is not None}
    for name, layer in {"radiance": color, **layers}.items():
        if layer.ndim != 3 or layer.shape != (*color.shape[:2], 3):
            raise EclatError(f"denoise: expected {name} of shape {(*color.shape[:2], 3)}, got {layer.shape}")
    oidn = importlib.import_module(PACKAGE)
    filter_type = oidn.OIDN_FILTER_TYPE_RT_LIGHTMAP if kind == "lightmap" else oidn.OIDN_FILTER_TYPE_RT
    out = oidn.denoise(color, hdr=True, quality="high", filter_type=filter_type, **layers)
    return np.maximum(np.asarray(out, dtype=np.float32), np.float32(0))


def _layer(values: ArrayLike, low: float, high: float) -> Picture:
    finite = np.nan_to_num(np.asarray(values, dtype=np.float32), nan=0.0, posinf=0.0, neginf=0.0)
    return np.ascontiguousarray(np.clip(finite, low, high))
