# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Compute the daylight of Mitsuba's emitters `sun`, `sky` and `sunsky`, with Mitsuba's scale and colours.

Mitsuba's radiance of daylight is a mean spectral radiance in W·sr⁻¹·m⁻²·nm⁻¹. The mean is weighted with the colour
matching functions x̄, ȳ and z̄, whose integrals are 106.857 nm. Éclat's own daylight is a radiance of visible light in
W·sr⁻¹·m⁻² with 179 lm/W. Its numbers are therefore 683 · 106.857 / 179 = 408 times as large as Mitsuba's. (Under a
clear sky, the ratio of the suns of both renderers is between 403 and 420.)

The other lights of a Mitsuba file are adjusted to Mitsuba's daylight, so this module uses Mitsuba's scale. It cannot
use the sky of [Preetham99], which Éclat has, because Mitsuba uses the model of Hosek and Wilkie, whose zenith is only
two thirds as bright.

The sky is a fit to the radiance that the function `eval` of `sunsky` in Mitsuba 3.9.1 returns for 24,000 directions and
150 positions of the sun, with turbidities from 1.7 to 10. The logarithm of the radiance is a polynomial of degree 5 in
the turbidity, the sun's elevation, the height of the direction, and the angle between the direction and the sun. The
relative error of the fit has a standard deviation of 3 %, or 2 % for turbidities from 2 to 4 and a sun above 15°. The
error of the sun's irradiance is 2 % of the irradiance of a high sun.
"""

from __future__ import annotations

import itertools
import math
from typing import Literal

import numpy as np

from eclat.daylight.sky import SUN_ANGULAR_RADIUS, Direction, dusk, sun_sky
from eclat.scene import DirectionalLight, Environment, FloatArray

_FITTED_TURBIDITY = (1.7, 10.0)
"""The range of turbidities of the fit. Turbidities outside it are clipped to it."""
_LEAST_ELEVATION = 1.0
"""The lowest elevation of the sun in the fit, in degrees. A lower sun has the same brightness down to the horizon.
Below it, the sky fades with the factor `dusk`."""
_ALBEDO_SLOPE, _FITTED_ALBEDO = 0.71, 0.3
"""The slope s and the ground albedo of the fit. A ground of albedo a makes the sky brighter by a factor 1 + s · a. Under a
sun at 53°, Mitsuba's sky agrees with this factor within 1 % at the albedos 0, 0.3 and 1."""

_SKY = np.array(
    [
        [
            *(-5.152, -0.701, 16.373, 6.081, 10.901, 25.790, 45.381, -7.692, -7.150, -53.776),
            *(-10.413, -13.609, -18.184, -8.463, -24.597, -72.461, -30.588, -1.708, 27.629, -83.259),
            *(18.183, -12.174, 4.402, 22.196, -67.959, 68.189, 30.093, 77.390, -6.323, -4.486),
            *(-29.789, 27.403, -12.423, 37.352, 26.642, 68.120, 10.235, 4.630, -15.950, 44.762),
            *(-27.439, 32.235, 12.314, 16.157, 1.188, 59.997, 2.322, 5.551, -1.464, -40.980),
            *(-10.562, -10.589, -10.838, -18.662, 95.697, -57.360, -18.920, -18.797, 15.406, -57.756),
            *(-62.377, -6.680, 19.284, 37.105, 59.769, -15.931, 9.502, 1.501, -45.752, -12.663),
            *(-23.640, 0.116, 2.843, -1.152, -3.225, 1.879, -9.353, -5.460, -7.492, 17.808),
            *(-25.220, 7.337, 0.980, 3.863, 11.281, -25.213, -2.114, -9.167, -7.308, -19.502),
            *(-10.746, -2.147, -13.448, -6.576, 10.639, 17.543, 3.566, 9.080, 8.899, 11.990),
            *(3.524, 5.332, 5.734, 10.431, -34.022, 14.868, 13.304, 14.486, -8.302, -4.853),
            *(-5.721, -3.894, 1.787, 44.267, 15.826, 5.480, -0.503, -17.779, -28.998, -25.644),
            *(1.655, 0.638, -10.428, 11.453, 13.914, 2.999),
        ],
        [
            *(-5.680, 1.911, 14.616, 8.946, 4.281, 11.328, 45.843, -15.948, -11.056, -43.937),
            *(-11.401, 15.578, -20.308, -6.084, -9.982, -41.223, -15.119, 6.118, 20.310, -84.103),
            *(7.581, -38.419, 11.981, 43.135, -47.273, 44.653, 33.479, 52.423, 5.009, -39.752),
            *(-69.802, 20.678, -1.296, 29.104, 13.425, 36.799, -2.365, -0.085, 8.353, 28.465),
            *(-15.725, 33.478, 5.307, -0.384, -27.312, 62.730, 12.109, 35.655, -1.132, -39.719),
            *(2.130, -11.951, -18.624, -29.066, 96.747, -34.775, -15.095, -7.376, -8.817, -31.463),
            *(-53.468, 0.283, 12.423, 85.245, 89.989, -11.540, 9.779, -14.335, -37.889, -15.168),
            *(-13.520, 4.983, 7.220, -8.417, -1.088, -6.959, -1.352, -5.048, -7.252, 9.236),
            *(-17.660, 9.874, -5.530, 7.264, 3.117, -26.910, -2.207, -0.496, 2.522, 4.635),
            *(-16.663, -3.411, -11.726, -12.052, 4.014, 0.750, 5.350, 6.993, 21.873, 10.660),
            *(3.570, 5.130, 5.450, 5.900, -46.497, 11.777, 4.028, -0.917, 3.341, -0.779),
            *(7.761, -2.038, 7.330, 16.572, 9.781, 1.150, -2.995, -13.561, -47.698, -32.900),
            *(1.476, -0.755, -6.411, 16.161, 12.820, 8.566),
        ],
        [
            *(-7.476, -2.373, 25.149, 7.230, 0.607, 10.619, 40.293, -12.826, -3.996, -54.986),
            *(-13.282, 3.110, -9.866, 13.506, 1.080, -25.777, -8.526, 2.488, 8.363, -57.536),
            *(-7.040, -57.118, 17.008, 32.595, -25.023, 48.091, 31.698, 54.632, 4.648, -53.654),
            *(-35.280, -0.898, -7.550, -10.367, -5.252, 18.219, 1.533, -0.100, 18.618, 4.935),
            *(-2.137, 21.407, 2.216, -3.137, -35.990, 39.613, 18.155, 52.635, -1.843, -12.289),
            *(16.474, -15.556, -15.418, -21.450, 70.877, -31.253, -10.208, -3.629, -15.659, -14.894),
            *(-75.902, 13.501, 2.691, 104.649, 60.194, 2.467, 17.248, -11.687, -2.017, -3.804),
            *(-6.879, 5.949, 3.528, -7.242, -4.484, -5.269, -6.588, -1.000, -3.197, 0.619),
            *(-0.513, 1.971, -0.055, 5.615, -2.294, -10.971, -2.987, 0.145, 5.564, 17.435),
            *(-17.316, 1.537, -5.304, -7.465, -17.142, -16.477, 1.711, 4.828, 23.060, 2.248),
            *(6.243, 4.324, 3.555, -1.863, -39.817, 10.892, 0.050, -5.376, 4.420, -1.521),
            *(12.195, -2.132, 10.535, 6.797, 23.762, -3.764, -4.470, -7.092, -59.609, -23.057),
            *(-1.832, -2.798, -7.451, 14.728, 2.940, 6.537),
        ],
    ]
)
"""The coefficients of the sky's logarithmic radiance, (3, 126), for red, green and blue.

They belong to the `_monomials` up to degree 5 of turbidity / 10, √(elevation / 90°), √(cosine of the angle to the
zenith) and √(angle to the sun / π). `_sky_image` uses them.
"""
_SUN = np.array(
    [
        [
            *(0.69689, -1.78179, -0.03036, 4.18631, 0.01581, -0.00507, -2.70867, -0.37907, 0.00121, 0.00017),
        ],
        [
            *(0.61923, -1.74173, -0.12011, 3.98994, 0.05819, -0.00366, -2.56925, -0.43946, 0.00082, 0.00017),
        ],
        [
            *(0.51084, -1.45187, -0.27881, 3.33928, 0.07239, -0.00986, -2.09795, -0.48831, 0.00900, 0.00039),
        ],
    ]
)
"""The coefficients of the sun's logarithmic irradiance, (3, 10), for red, green and blue.

They belong to the `_monomials` up to degree 3 of turbidity / 10 and the relative air mass. `_sun_irradiance` uses them.
"""


def mitsuba_sun_sky(
    to_sun: Direction,
    *,
    turbidity: float,
    up: Direction,
    albedo: float,
    sun_scale: float,
    sky_scale: float,
    parts: Literal["sunsky", "sky", "sun"],
    angular_radius: float = SUN_ANGULAR_RADIUS,
) -> tuple[DirectionalLight | None, Environment | None]:
    """Compute Mitsuba's sun and sky. The sky is black below the horizon.

    Parameters
    ----------
    to_sun, turbidity, up, albedo, sun_scale, sky_scale, parts : as in `eclat.daylight.sky.sun_sky`.
    angular_radius : the angular radius of the sun in degrees. The irradiance of the sun does not depend on it.

    Returns
    -------
    The sun and the sky. Either is None if `parts` does not include it.

    Raises
    ------
    EclatError : `sun_sky` refuses the arguments.
    """
    # Éclat's own model checks the arguments and provides the directions, the coordinate system and the image size.
    sun, sky = sun_sky(to_sun, turbidity, up, albedo, sun_scale, sky_scale, parts)
    turbidity = min(max(turbidity, _FITTED_TURBIDITY[0]), _FITTED_TURBIDITY[1])
    vertical = np.asarray(up, np.float64) / np.linalg.norm(up)
    towards = np.asarray(to_sun, np.float64) / np.linalg.norm(to_sun)
    elevation = math.degrees(math.asin(min(1.0, max(-1.0, float(towards @ vertical)))))
    if sun is not None:
        r, g, b = (float(x) for x in sun_scale * _sun_irradiance(turbidity, elevation))
        sun = DirectionalLight(sun.direction, (r, g, b), angular_radius)
    if sky is not None:
        to_world = np.asarray(sky.to_world, np.float64)[:3, :3]
        image = sky_scale * _sky_image(to_world.T @ towards, turbidity, elevation, albedo, sky.image.shape[:2])
        sky = Environment(image.astype(np.float32), sky.to_world)
    return sun, sky


def _sun_irradiance(turbidity: float, elevation: float) -> FloatArray:
    """Return the RGB irradiance (3,) of the sun on a surface that faces it. `elevation` is in degrees."""
    elevation = max(elevation, _LEAST_ELEVATION)
    air_mass = 1 / (math.sin(math.radians(elevation)) + 0.15 * (elevation + 3.885) ** -1.253)
    terms = _monomials(np.array([[turbidity / 10], [air_mass]]), 3)
    irradiance: FloatArray = np.exp(_SUN @ terms)[:, 0]
    return irradiance


def _sky_image(
    to_sun: FloatArray, turbidity: float, elevation: float, albedo: float, size: tuple[int, int]
) -> FloatArray:
    """Return the radiance of the sky as an environment map, (height, width, 3).

    Parameters
    ----------
    to_sun : (3,) unit vector towards the sun in the coordinates of the environment map, where +y is up.
    turbidity : the turbidity, in the range of the fit.
    elevation : the elevation of the sun in degrees.
    albedo : the albedo of the ground in 0..1.
    size : (height, width) of the image in texels.
    """
    height, width = size
    theta = (np.arange(height) + 0.5) * (math.pi / height)
    phi = ((np.arange(width) + 0.5) / width - 0.5) * (2 * math.pi)
    above = theta < math.pi / 2
    z, across = np.cos(theta[above])[:, None], np.sin(theta[above])[:, None]
    cosine = across * np.sin(phi) * to_sun[0] + z * to_sun[1] - across * np.cos(phi) * to_sun[2]
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    lit = max(elevation, _LEAST_ELEVATION)
    # Two of the four variables of the polynomial are the same for all texels.
    constant = np.full(cosine.size, turbidity / 10), np.full(cosine.size, math.sqrt(lit / 90))
    heights = np.sqrt(np.broadcast_to(z, cosine.shape)).ravel()
    terms = _monomials(np.stack([*constant, heights, np.sqrt(angle / math.pi).ravel()]), 5)
    ground = (1 + _ALBEDO_SLOPE * albedo) / (1 + _ALBEDO_SLOPE * _FITTED_ALBEDO)
    fade = dusk(elevation) if elevation <= 0 else 1.0
    image = np.zeros((height, width, 3))
    image[above] = ground * fade * np.exp(_SKY @ terms).T.reshape(-1, width, 3)
    return image


def _monomials(variables: FloatArray, degree: int) -> FloatArray:
    """Evaluate all monomials up to `degree` in V variables at N points.

    `variables` has the shape (V, N). The result has one row for each monomial and the shape (monomials, N). The rows
    are ordered by degree, and within a degree lexicographically.
    """
    rows = [np.ones(variables.shape[1])]
    for d in range(1, degree + 1):
        for chosen in itertools.combinations_with_replacement(range(len(variables)), d):
            rows.append(np.prod(variables[list(chosen)], axis=0))
    return np.stack(rows)
