# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Conversion of scene-linear radiance to display bytes: exposure, tone curve, sRGB transfer function and rounding."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, did_you_mean
from eclat.measure.photometry import luminance

FloatArray = NDArray[np.floating[Any]]

MAX_EXPOSURE = 64.0
"""Stops; twice that spans all of float32, so more is a slip of the keyboard."""

NOT_FINITE = (255, 0, 255)
"""The colour of pixels that are NaN or infinite: a bug must be seen, so it is neither black nor white."""

MID_GREY = 0.18
"""Reflectance of the photographer's grey card, the value that the filmic curve keeps."""


def srgb_encode(linear: FloatArray) -> FloatArray:
    """Display value in 0..1 of linear light in 0..1 (IEC 61966-2-1, section 5.2); values outside are clipped."""
    clipped = np.clip(linear, 0.0, 1.0)
    return np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)


def srgb_decode(encoded: FloatArray) -> FloatArray:
    """Linear light in 0..1 of a display value in 0..1: the inverse of `srgb_encode`."""
    clipped = np.clip(encoded, 0.0, 1.0)
    return np.where(clipped <= 0.04045, clipped / 12.92, ((clipped + 0.055) / 1.055) ** 2.4)


def filmic(linear: FloatArray) -> FloatArray:
    """A film-like curve: dark toe, long shoulder, no clipping; per channel, so that highlights lose colour gently.

    Naka and Rushton 1966, *S-potentials from colour units in the retina of fish*: y = xⁿ / (xⁿ + sⁿ), the response
    of photoreceptors. Two demands fix both constants, so that nothing is tuned: mid grey g stays g, and contrast
    there stays 1, i.e. d ln y / d ln x = n (1 − y) = 1, thus n = 1 / (1 − g) and sⁿ = gⁿ (1 − g) / g.
    """
    exponent = 1.0 / (1.0 - MID_GREY)
    semi_saturation = MID_GREY**exponent * (1.0 - MID_GREY) / MID_GREY
    # As 1 / (1 + sⁿ/xⁿ) nothing overflows: the largest float32 to the power n is still a float64.
    power = np.maximum(np.asarray(linear, dtype=np.float64), 0.0) ** exponent
    return np.asarray(power / (power + semi_saturation))


def _clip(linear: FloatArray) -> FloatArray:
    return linear


TONE_MAPPINGS: dict[str, Callable[[FloatArray], FloatArray]] = {"none": _clip, "filmic": filmic}
"""Curves from exposed radiance to linear display light; what they leave outside 0..1 is clipped."""


def auto_exposure(pixels: FloatArray) -> float:
    """Stops that take the log-average luminance of (H, W, 3) radiance to mid grey (0.18), to the nearest half stop.

    Reinhard et al. 2002, *Photographic Tone Reproduction for Digital Images*, equations 1 and 2; black pixels, which
    have no logarithm, are left out, as are those that are not finite. Within ±`MAX_EXPOSURE`.
    """
    brightness = luminance(pixels)
    lit = brightness[np.isfinite(brightness) & (brightness > 0)]
    if lit.size == 0:
        return 0.0
    stops = math.log2(0.18) - float(np.log2(lit).mean())
    return min(max(round(2 * stops) / 2, -MAX_EXPOSURE), MAX_EXPOSURE)


def stops_of(exposure: float | Literal["auto"], pixels: FloatArray) -> float:
    """The number of stops that `exposure` means for `pixels`. Raises EclatError for another word than "auto"."""
    if isinstance(exposure, str):
        if exposure != "auto":
            raise EclatError(f"exposure: expected a number of stops or 'auto', got {exposure!r}")
        return auto_exposure(pixels)
    return exposure


def check_display(exposure: float, tone_mapping: str) -> None:
    """Raise EclatError unless `to_display` accepts these."""
    if not math.isfinite(exposure) or abs(exposure) > MAX_EXPOSURE:
        raise EclatError(f"exposure: expected stops between −{MAX_EXPOSURE:g} and {MAX_EXPOSURE:g}, got {exposure}")
    if tone_mapping not in TONE_MAPPINGS:
        known = ", ".join(TONE_MAPPINGS)
        hint = did_you_mean(tone_mapping, TONE_MAPPINGS)
        raise EclatError(f"tone_mapping: expected one of {known}, got {tone_mapping!r}{hint}")


def to_display(pixels: FloatArray, exposure: float = 0.0, tone_mapping: str = "none") -> NDArray[np.uint8]:
    """8-bit sRGB bytes of scene-linear radiance.

    Rounded to the nearest byte without dithering: a byte depends on its own pixel only, so that pictures can be
    compared byte by byte and flat areas stay flat.

    Parameters
    ----------
    pixels : (H, W, 3) radiance, Rec. 709 primaries. Pixels with a channel that is not finite become `NOT_FINITE`.
    exposure : stops; radiance is multiplied by 2^exposure, and 1 is then white (before `filmic`).
    tone_mapping : a key of `TONE_MAPPINGS`.

    Raises
    ------
    EclatError : exposure not finite or beyond ±`MAX_EXPOSURE`, unknown tone mapping.
    """
    check_display(exposure, tone_mapping)
    finite = np.asarray(np.isfinite(pixels).all(axis=-1))
    radiance = np.where(finite[..., None], pixels, 0.0).astype(np.float64) * 2.0**exposure
    encoded = srgb_encode(TONE_MAPPINGS[tone_mapping](radiance))
    display: NDArray[np.uint8] = np.rint(encoded * 255.0).astype(np.uint8)
    display[~finite] = NOT_FINITE
    return display
