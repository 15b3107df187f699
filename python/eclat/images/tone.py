# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Convert scene-linear radiance to bytes for display: exposure, tone mapping, sRGB transfer function and rounding."""

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
"""The largest absolute value of an exposure, in stops. The range of float32 spans about four times this number of stops
in total, so a larger exposure is probably a typing error."""

NOT_FINITE = (255, 0, 255)
"""The sRGB colour of pixels that are NaN or infinite: magenta, so that they are noticed."""

MID_GREY = 0.18
"""The reflectance of a photographic grey card. The filmic curve maps this value to itself."""


def srgb_encode(linear: FloatArray) -> FloatArray:
    """Convert linear values to sRGB values in 0..1 (IEC 61966-2-1, section 5.2). Values outside 0..1 are clipped."""
    clipped = np.clip(linear, 0.0, 1.0)
    return np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)


def srgb_decode(encoded: FloatArray) -> FloatArray:
    """Convert sRGB values to linear values in 0..1, as the inverse of `srgb_encode`. Values outside 0..1 are clipped."""
    clipped = np.clip(encoded, 0.0, 1.0)
    return np.where(clipped <= 0.04045, clipped / 12.92, ((clipped + 0.055) / 1.055) ** 2.4)


def filmic(linear: FloatArray) -> FloatArray:
    """Apply a tone curve like that of film, with a dark toe and a long shoulder. It maps 0..∞ to 0..1.

    It is applied to each channel separately, so that highlights become less saturated. The curve is
    y = xⁿ / (xⁿ + sⁿ), which describes the response of photoreceptors (Naka and Rushton 1966, *S-potentials from colour
    units in the retina of fish*). Two conditions determine its constants, so that neither is tuned. Mid grey g is mapped
    to itself, and its contrast is 1: d ln y / d ln x = n (1 − y) = 1. It follows that n = 1 / (1 − g) and
    sⁿ = gⁿ (1 − g) / g.
    """
    exponent = 1.0 / (1.0 - MID_GREY)
    semi_saturation = MID_GREY**exponent * (1.0 - MID_GREY) / MID_GREY
    # The power cannot overflow: the n-th power of the largest float32 is in the range of float64.
    power = np.maximum(np.asarray(linear, dtype=np.float64), 0.0) ** exponent
    return np.asarray(power / (power + semi_saturation))


def _clip(linear: FloatArray) -> FloatArray:
    return linear


TONE_MAPPINGS: dict[str, Callable[[FloatArray], FloatArray]] = {"none": _clip, "filmic": filmic}
"""The tone curves, from exposed radiance to linear display values. Values outside 0..1 are clipped afterwards."""


def auto_exposure(pixels: FloatArray) -> float:
    """Compute the exposure that maps the log-average luminance of an image to mid grey (0.18).

    The formula is from Reinhard et al. 2002, *Photographic Tone Reproduction for Digital Images*, equations 1 and 2.
    Black pixels, which have no logarithm, and pixels that are not finite are left out.

    Parameters
    ----------
    pixels : (H, W, 3) radiance.

    Returns
    -------
    The exposure in stops, rounded to half a stop and clipped to ±`MAX_EXPOSURE`. It is 0 if all pixels are left out.
    """
    brightness = luminance(pixels)
    lit = brightness[np.isfinite(brightness) & (brightness > 0)]
    if lit.size == 0:
        return 0.0
    stops = math.log2(0.18) - float(np.log2(lit).mean())
    return min(max(round(2 * stops) / 2, -MAX_EXPOSURE), MAX_EXPOSURE)


def exposure_stops(exposure: float | Literal["auto"], pixels: FloatArray) -> float:
    """Return the exposure in stops: `exposure`, or `auto_exposure(pixels)` if it is "auto".

    Raises EclatError if it is another word.
    """
    if isinstance(exposure, str):
        if exposure != "auto":
            raise EclatError(f"exposure: expected a number of stops or 'auto', got {exposure!r}")
        return auto_exposure(pixels)
    return exposure


def check_display(exposure: float, tone_mapping: str) -> None:
    """Raise EclatError if `to_display` does not accept the exposure (in stops) or the tone mapping."""
    if not math.isfinite(exposure) or abs(exposure) > MAX_EXPOSURE:
        raise EclatError(
            f"exposure: expected a number of stops between −{MAX_EXPOSURE:g} and {MAX_EXPOSURE:g}, got {exposure}"
        )
    if tone_mapping not in TONE_MAPPINGS:
        known = ", ".join(TONE_MAPPINGS)
        hint = did_you_mean(tone_mapping, TONE_MAPPINGS)
        raise EclatError(f"tone_mapping: expected one of {known}, got {tone_mapping!r}{hint}")


def to_display(pixels: FloatArray, exposure: float = 0.0, tone_mapping: str = "none") -> NDArray[np.uint8]:
    """Convert scene-linear radiance to 8-bit sRGB values.

    Values are rounded to the nearest byte without dithering. Each byte therefore only depends on its own pixel, so that
    images can be compared byte by byte, and areas of constant radiance stay constant.

    Parameters
    ----------
    pixels : (H, W, 3) radiance with Rec. 709 primaries. Pixels with a channel that is not finite become `NOT_FINITE`.
    exposure : the exposure in stops. Radiance is multiplied by 2^exposure. Without tone mapping, 1 is then white.
    tone_mapping : a key of `TONE_MAPPINGS`.

    Returns
    -------
    (H, W, 3) bytes.

    Raises
    ------
    EclatError : the exposure is not finite or beyond ±`MAX_EXPOSURE`, or the tone mapping is unknown.
    """
    check_display(exposure, tone_mapping)
    finite = np.asarray(np.isfinite(pixels).all(axis=-1))
    radiance = np.where(finite[..., None], pixels, 0.0).astype(np.float64) * 2.0**exposure
    encoded = srgb_encode(TONE_MAPPINGS[tone_mapping](radiance))
    display: NDArray[np.uint8] = np.rint(encoded * 255.0).astype(np.uint8)
    display[~finite] = NOT_FINITE
    return display
