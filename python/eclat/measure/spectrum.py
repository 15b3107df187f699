# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Conversion of spectra to linear sRGB (Rec. 709 primaries, D65 white).

The colour matching functions are the multi-lobe Gaussian fits of C. Wyman, P.-P. Sloan, P. Shirley, "Simple Analytic
Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013, section 2.2. For smooth spectra, integrals are
within 1 % of those of the CIE's tables, which is far below the differences between monitors. D65 is the table of the
CIE in steps of 10 nm.

There are two conversions, as in the RGB mode of Mitsuba 3:

- `reflectance_to_rgb` gives the colour of a reflector under D65; a constant reflectance r becomes (r, r, r);
- `emission_to_rgb` gives the colour of the light itself with Y = ∫ L ȳ dλ / ∫ ȳ dλ; the equal-energy spectrum is
  slightly reddish, (1.205, 0.948, 0.909).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat.errors import EclatError

Floats = NDArray[np.float64]

WAVELENGTHS: Floats = np.arange(360.0, 831.0)
"""Wavelengths in nanometres at which integrals over the visible range are sampled: every nanometre of the range
360..830 nm of the CIE."""

XYZ_TO_RGB: Floats = np.array(
    [
        [3.240479, -1.537150, -0.498535],
        [-0.969256, 1.875991, 0.041556],
        [0.055648, -0.204043, 1.057311],
    ]
)

# CIE standard illuminant D65, relative, 360..830 nm in steps of 10.
_D65 = np.array(
    [
        *(46.6383, 52.0891, 49.9755, 54.6482, 82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861),
        *(115.923, 108.811, 109.354, 107.802, 104.79, 107.689, 104.405, 104.046, 100.0, 96.3342, 95.788, 88.6856),
        *(90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349),
        *(61.604, 69.8856, 75.087, 63.5927, 46.4182, 66.8054, 63.3828, 64.304, 59.4519, 51.959, 57.4406, 60.3125),
    ]
)

# Wyman et al. 2013: amplitude, centre, width below and above the centre (nm), for x̄, ȳ, z̄.
_LOBES = (
    ((1.056, 599.8, 37.9, 31.0), (0.362, 442.0, 16.0, 26.7), (-0.065, 501.1, 20.4, 26.2)),
    ((0.821, 568.8, 46.9, 40.5), (0.286, 530.9, 16.3, 31.1)),
    ((1.217, 437.0, 11.8, 36.0), (0.681, 459.0, 26.0, 13.8)),
)

_PLANCK = 6.62607015e-34
_LIGHT_SPEED = 299792458.0
_BOLTZMANN = 1.380649e-23


def color_matching(wavelengths: ArrayLike) -> Floats:
    """Compute the CIE 1931 functions x̄, ȳ and z̄, (3, N), at wavelengths (N,) in nanometres."""
    nm = np.asarray(wavelengths, dtype=np.float64)
    return np.stack([sum(_lobe(nm, *lobe) for lobe in lobes) for lobes in _LOBES])


def reflectance_to_rgb(wavelengths: ArrayLike, values: ArrayLike) -> tuple[float, float, float]:
    """Convert a reflectance spectrum to linear sRGB under D65, clamped to 0..1.

    Parameters
    ----------
    wavelengths, values : (N,) samples of the spectrum and their wavelengths in nanometres. The spectrum is linear
        between samples, and 0 outside of their range.

    Raises
    ------
    EclatError : the same as for `resample`.
    """
    red, green, blue = np.clip(_REFLECTANCE_WEIGHTS @ resample(wavelengths, values), 0.0, 1.0).tolist()
    return red, green, blue


def reflectance_weights(wavelengths: ArrayLike) -> Floats:
    """Return the weights (3, N) of samples of a reflectance spectrum at `wavelengths` (N,) in its linear sRGB under D65.

    The spectrum is linear between samples, and keeps its first and last value outside of them, so that each row adds up to 1.

    Raises
    ------
    EclatError : there are no wavelengths, one is not finite, or they do not increase.
    """
    nm = np.asarray(wavelengths, dtype=np.float64)
    resample(nm, np.zeros(nm.shape))
    samples = np.eye(nm.size)
    return _REFLECTANCE_WEIGHTS @ np.stack([np.interp(WAVELENGTHS, nm, sample) for sample in samples], axis=1)


def emission_to_rgb(wavelengths: ArrayLike, values: ArrayLike) -> tuple[float, float, float]:
    """Convert the spectrum of a light, or of any unbounded quantity, to linear sRGB; negative channels are clamped to
    0.

    Parameters and errors are those of `reflectance_to_rgb`; the result has the unit of `values`.
    """
    red, green, blue = np.maximum(_EMISSION_WEIGHTS @ resample(wavelengths, values), 0.0).tolist()
    return red, green, blue


def blackbody_to_rgb(temperature: float) -> tuple[float, float, float]:
    """Compute the linear sRGB radiance of a black body in W·sr⁻¹·m⁻²·nm⁻¹ at `temperature` kelvin.

    Raises
    ------
    EclatError : the temperature is not finite, or not above 0.
    """
    if not (np.isfinite(temperature) and temperature > 0):
        raise EclatError(f"black body: expected a finite temperature above 0 K, got {temperature:g}")
    metres = WAVELENGTHS * 1e-9
    with np.errstate(
        over="ignore", divide="ignore"
    ):  # For cold bodies the exponential overflows to ∞, and the radiance is 0.
        exponent = _PLANCK * _LIGHT_SPEED / (metres * _BOLTZMANN * temperature)
        radiance = 2 * _PLANCK * _LIGHT_SPEED**2 / metres**5 / np.expm1(exponent) * 1e-9
    return emission_to_rgb(WAVELENGTHS, radiance)


def srgb_to_linear(encoded: ArrayLike) -> Floats:
    """Decode sRGB values (IEC 61966-2-1) in 0..1 to linear values."""
    value = np.asarray(encoded, dtype=np.float64)
    return np.where(value <= 0.04045, value / 12.92, (np.maximum(value, 0.04045) / 1.055 + 0.055 / 1.055) ** 2.4)


def resample(wavelengths: ArrayLike, values: ArrayLike) -> Floats:
    """Resample a piecewise linear spectrum at `WAVELENGTHS`; it is 0 outside of its range.

    Raises
    ------
    EclatError : there are no samples, the two arrays differ in length, a number is not finite, or the wavelengths do
        not increase.
    """
    nm, samples = np.asarray(wavelengths, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if nm.ndim != 1 or nm.shape != samples.shape or nm.size == 0:
        raise EclatError(
            f"spectrum: expected as many wavelengths as values, at least one, got {nm.size} and {samples.size}"
        )
    if not (np.isfinite(nm).all() and np.isfinite(samples).all()):
        where = int(np.argmin(np.isfinite(nm) & np.isfinite(samples)))
        raise EclatError(
            f"spectrum: expected finite numbers, got the value {samples[where]:g} at {nm[where]:g} nm (sample {where})"
        )
    if (np.diff(nm) <= 0).any():
        row = int(np.argmax(np.diff(nm) <= 0))
        raise EclatError(f"spectrum: expected increasing wavelengths, got {nm[row]:g} nm before {nm[row + 1]:g} nm")
    return np.interp(WAVELENGTHS, nm, samples, left=0.0, right=0.0)


def _lobe(nm: Floats, amplitude: float, centre: float, below: float, above: float) -> Floats:
    return amplitude * np.exp(-0.5 * ((nm - centre) / np.where(nm < centre, below, above)) ** 2)


def _emission_weights() -> Floats:
    matching = color_matching(WAVELENGTHS)
    # Each function is normalised by its own integral, so that the equal-energy spectrum has X = Y = Z exactly, as in
    # the tables of the CIE.
    weights: Floats = XYZ_TO_RGB @ (matching / matching.sum(axis=1, keepdims=True))
    return weights


def _reflectance_weights() -> Floats:
    illuminant = np.interp(WAVELENGTHS, np.arange(360.0, 831.0, 10.0), _D65)
    weights: Floats = XYZ_TO_RGB @ (color_matching(WAVELENGTHS) * illuminant)
    weights /= weights.sum(axis=1, keepdims=True)
    return weights


_EMISSION_WEIGHTS = _emission_weights()
_REFLECTANCE_WEIGHTS = _reflectance_weights()
