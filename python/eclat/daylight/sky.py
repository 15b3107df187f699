# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The sun and a clear sky [Preetham99]: A. Preetham, P. Shirley, B. Smits, "A practical analytic model for daylight",
1999.

The scale is absolute. The model gives luminance in cd/m²; radiance here is RGB in W·sr⁻¹·m⁻², with luminance = 179 lm/W
× Y. The irradiance of a high sun is about 600 W·m⁻² (105 klx), that of the sky 50 to 150 W·m⁻². These are watts of
*visible* light; the 1000 W·m⁻² of meteorology include the infrared.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, did_you_mean, warn
from eclat.measure.photometry import LUMENS_PER_WATT
from eclat.scene import DirectionalLight, Environment, FloatArray

SUN_ANGULAR_RADIUS = 0.2665
"""Angular radius of the sun as seen from Earth, in degrees."""

Direction = tuple[float, float, float]

TURBIDITY_RANGE = (1.7, 10.0)
"""Range of the turbidity: below 1.7 the model gives negative luminance near the zenith, and its authors do not
recommend values above 10."""

XYZ_TO_RGB = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])

# [Preetham99 A.2]: each coefficient A..E of Perez' function is slope · turbidity + offset; the rows are for Y, x and y.
PEREZ_SLOPE = np.array(
    [
        [0.1787, -0.3554, -0.0227, 0.1206, -0.0670],
        [-0.0193, -0.0665, -0.0004, -0.0641, -0.0033],
        [-0.0167, -0.0950, -0.0079, -0.0441, -0.0109],
    ]
)
PEREZ_OFFSET = np.array(
    [
        [-1.4630, 0.4275, 5.3251, -2.5771, 0.3703],
        [-0.2592, 0.0008, 0.2125, -0.8989, 0.0452],
        [-0.2608, 0.0092, 0.2102, -1.6537, 0.0529],
    ]
)

# Chromaticity of the zenith: (T², T, 1) · matrix · (θ³, θ², θ, 1), where T is the turbidity and θ the sun's zenith angle.
ZENITH_X = np.array(
    [[0.00166, -0.00375, 0.00209, 0.0], [-0.02903, 0.06377, -0.03202, 0.00394], [0.11693, -0.21196, 0.06052, 0.25886]]
)
ZENITH_Y = np.array(
    [[0.00275, -0.00610, 0.00317, 0.0], [-0.04214, 0.08970, -0.04153, 0.00516], [0.15346, -0.26756, 0.06670, 0.26688]]
)

# Ozone absorption in cm⁻¹ every 10 nm from 440 nm, the Chappuis band [Preetham99].
OZONE_WAVELENGTHS = np.arange(440.0, 761.0, 10.0)
OZONE_ABSORPTION = np.array(
    [
        *(0.000, 0.003, 0.006, 0.009, 0.014, 0.021, 0.030, 0.040, 0.048, 0.063, 0.075, 0.085, 0.103, 0.120, 0.120),
        *(0.115, 0.125, 0.120, 0.105, 0.090, 0.079, 0.067, 0.057, 0.048, 0.036, 0.028, 0.023, 0.018, 0.014, 0.011),
        *(0.010, 0.009, 0.007),
    ]
)


def sun_direction(azimuth_deg: float, elevation_deg: float, up: Direction = (0.0, 1.0, 0.0)) -> Direction:
    """Compute the unit vector towards a sun.

    Parameters
    ----------
    azimuth_deg
        Azimuth in degrees, clockwise from north as seen from above. If `up` is +y, north is −z and east is +x; if `up`
        is +z, north is +y and east is +x.
    elevation_deg
        Elevation in degrees above the horizon, −90 to 90.
    up
        Upward direction of the world, of any length.

    Raises
    ------
    EclatError
        An angle is not finite, the elevation is outside of ±90°, or `up` is zero.
    """
    if not math.isfinite(azimuth_deg) or not math.isfinite(elevation_deg) or abs(elevation_deg) > 90:
        raise EclatError(
            f"sun: expected an azimuth and an elevation from −90 to 90 in degrees, got {azimuth_deg},{elevation_deg}"
        )
    azimuth, elevation = math.radians(azimuth_deg), math.radians(elevation_deg)
    local = (
        math.sin(azimuth) * math.cos(elevation),
        math.sin(elevation),
        -math.cos(azimuth) * math.cos(elevation),
    )
    x, y, z = upright_frame(up) @ local
    return float(x), float(y), float(z)


def upright_frame(up: Direction) -> FloatArray:
    """Compute the smallest rotation (3×3) that maps +y to `up`. Raises EclatError if `up` is zero."""
    x, y, z = _unit(up, "up")
    if y < -1 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    k = 1 / (1 + y)
    return np.array([[1 - k * x * x, x, -k * x * z], [-x, y, -z], [-k * x * z, z, 1 - k * z * z]])


def sun_sky(
    sun_direction: Direction,
    turbidity: float = 3.0,
    up: Direction = (0.0, 1.0, 0.0),
    albedo: float = 0.3,
    sun_scale: float = 1.0,
    sky_scale: float = 1.0,
    parts: Literal["sunsky", "sky", "sun"] = "sunsky",
    size: tuple[int, int] = (512, 256),
) -> tuple[DirectionalLight | None, Environment | None]:
    """Make the sun, as a disc, and the sky, as an environment, of a clear day.

    Parameters
    ----------
    sun_direction
        A vector of any length towards the sun. If it points below the horizon, there is no sun and the sky is that of
        dusk, with a warning.
    turbidity
        Haze of the air: 2 is very clear, 3 clear and 6 hazy. Values outside of 1.7..10 are clamped, with a warning.
    up
        Upward direction of the world; the environment is rotated accordingly.
    albedo
        Albedo of the ground, 0..1. Below the horizon, the environment shows the ground, which is lit uniformly by the
        parts that are computed.
    sun_scale, sky_scale
        Factors of at least 0 by which the absolute values are multiplied.
    parts
        The parts to compute; a part that is not computed is None in the result.
    size
        Size (width, height) of the environment in pixels.

    Raises
    ------
    EclatError
        A vector is zero, a number is not finite or out of range, or `parts` is unknown.
    """
    _check(parts, albedo, sun_scale, sky_scale, size)
    turbidity = _valid_turbidity(turbidity)
    to_world = upright_frame(up)
    to_sun = to_world.T @ _unit(sun_direction, "sun_direction")
    elevation = math.degrees(math.asin(min(1.0, max(-1.0, to_sun[1]))))
    fade = 1.0
    if elevation <= 0:
        warn(
            f"sky: the sun is {-elevation:.1f}° below the horizon: there is no direct sunlight, and the brightness of the sky "
            "is only a rough guess"
        )
        fade = dusk(elevation)
        to_sun = np.array([to_sun[0], 0.0, to_sun[2]])
        length = float(np.linalg.norm(to_sun))
        to_sun = to_sun / length if length > 1e-9 else np.array([0.0, 0.0, -1.0])

    irradiance: FloatArray = np.zeros(3)
    light = environment = None
    if parts != "sky" and elevation > 0:
        irradiance = sun_scale * sun_irradiance(math.radians(90 - elevation), turbidity)
        r, g, b = (float(c) for c in irradiance)
        x, y, z = (float(c) for c in -(to_world @ to_sun))
        light = DirectionalLight((x, y, z), (r, g, b), SUN_ANGULAR_RADIUS)
    if parts != "sun":
        image = _sky_image(to_sun, turbidity, size, fade * sky_scale, albedo, irradiance * to_sun[1])
        environment = Environment(image, to_world)
    return light, environment


def zenith_luminance(sun_zenith: float, turbidity: float) -> float:
    """Compute the luminance of the sky at the zenith in cd/m²; `sun_zenith` is the zenith angle of the sun in
    radians."""
    chi = (4 / 9 - turbidity / 120) * (math.pi - 2 * sun_zenith)
    return 1000 * ((4.0453 * turbidity - 4.9710) * math.tan(chi) - 0.2155 * turbidity + 2.4192)


def sky_radiance(directions: FloatArray, to_sun: FloatArray, turbidity: float) -> FloatArray:
    """Compute the linear RGB radiance (N, 3) in W·sr⁻¹·m⁻² of the sky in the unit `directions` (N, 3).

    `directions` and `to_sun` are in a frame with +y up. Directions below the horizon give the radiance of the horizon.
    Colours outside of the Rec. 709 gamut are clamped to 0.
    """
    sun_zenith = math.acos(min(1.0, max(0.0, float(to_sun[1]))))
    cos_theta = np.maximum(directions[:, 1], 1e-3)
    gamma = np.arccos(np.clip(directions @ to_sun, -1.0, 1.0))
    t = np.array([turbidity**2, turbidity, 1.0])
    s = np.array([sun_zenith**3, sun_zenith**2, sun_zenith, 1.0])
    zenith = (zenith_luminance(sun_zenith, turbidity), t @ ZENITH_X @ s, t @ ZENITH_Y @ s)
    luminance, x, y = (
        z * _perez(c, cos_theta, gamma) / _perez(c, np.ones(1), np.full(1, sun_zenith))
        for z, c in zip(zenith, PEREZ_SLOPE * turbidity + PEREZ_OFFSET, strict=True)
    )
    xyz = np.stack([x / y, np.ones_like(x), (1 - x - y) / y], axis=1) * (luminance / LUMENS_PER_WATT)[:, None]
    rgb: FloatArray = np.maximum(xyz @ XYZ_TO_RGB.T, 0.0)
    return rgb


def sun_irradiance(sun_zenith: float, turbidity: float) -> FloatArray:
    """Compute the linear RGB irradiance in W·m⁻² of the sun, through the atmosphere, on a surface that faces it
    [Preetham99 A.1].

    The sun is a black body of 5772 K. Absorption by water vapour and mixed gases, which begins at 690 nm, is neglected.
    """
    wavelength = np.arange(380.0, 781.0, 5.0)
    micron = wavelength * 1e-3
    rayleigh = 0.008735 * micron**-4.08
    aerosol = (0.04608 * turbidity - 0.04586) * micron**-1.3
    ozone = 0.35 * np.interp(wavelength, OZONE_WAVELENGTHS, OZONE_ABSORPTION)
    solid_angle = 2 * math.pi * (1 - math.cos(math.radians(SUN_ANGULAR_RADIUS)))
    # This is Planck's law in W·sr⁻¹·m⁻² per nanometre.
    radiance = 1.191043e-16 / (wavelength * 1e-9) ** 5 / np.expm1(1.438777e-2 / (wavelength * 1e-9 * 5772.0)) * 1e-9
    spectrum = solid_angle * radiance * np.exp(-_air_mass(sun_zenith) * (rayleigh + aerosol + ozone))
    xyz = 683.0 * 5.0 * (_color_matching(wavelength) @ spectrum) / LUMENS_PER_WATT
    rgb: FloatArray = np.maximum(XYZ_TO_RGB @ xyz, 0.0)
    return rgb


def horizontal_irradiance(environment: Environment) -> FloatArray:
    """Compute the RGB irradiance in W·m⁻² of an environment on an unobstructed surface that faces its +y axis."""
    height, width = environment.image.shape[:2]
    edges = np.cos(np.linspace(0.0, math.pi, height + 1))
    weights = math.pi * np.maximum(edges[:-1], 0) ** 2 - math.pi * np.maximum(edges[1:], 0) ** 2
    irradiance: FloatArray = np.einsum("h,hwc->c", weights / width, environment.image.astype(np.float64))
    return irradiance


def _air_mass(sun_zenith: float) -> float:
    return float(1 / (math.cos(sun_zenith) + 0.15 * (93.885 - math.degrees(sun_zenith)) ** -1.253))


def _perez(coefficients: FloatArray, cos_theta: FloatArray, gamma: FloatArray) -> FloatArray:
    a, b, c, d, e = coefficients
    value: FloatArray = (1 + a * np.exp(b / cos_theta)) * (1 + c * np.exp(d * gamma) + e * np.cos(gamma) ** 2)
    return value


def _sky_image(
    to_sun: FloatArray, turbidity: float, size: tuple[int, int], scale: float, albedo: float, sun_on_ground: FloatArray
) -> NDArray[np.float32]:
    width, height = size
    theta = (np.arange(height) + 0.5) * (math.pi / height)
    phi = ((np.arange(width) + 0.5) / width - 0.5) * (2 * math.pi)
    above = theta[:, None] < math.pi / 2
    directions = np.stack(
        [
            np.sin(theta)[:, None] * np.sin(phi),
            np.repeat(np.cos(theta)[:, None], width, axis=1),
            -np.sin(theta)[:, None] * np.cos(phi),
        ],
        axis=2,
    )
    sky = scale * sky_radiance(directions.reshape(-1, 3), to_sun, turbidity).reshape(height, width, 3)
    image = np.where(above[..., None], sky, 0.0)
    ground = albedo / math.pi * (horizontal_irradiance(Environment(image)) + sun_on_ground)
    return np.where(above[..., None], sky, ground).astype(np.float32)


def dusk(elevation: float) -> float:
    """Estimate the brightness of the sky relative to sunset for a sun at `elevation` degrees (0 or less). It is about
    1/200 at the end of civil twilight (−6°), and constant below the end of astronomical twilight (−18°)."""
    return float(200.0 ** (max(elevation, -18.0) / 6))


def _color_matching(wavelength: FloatArray) -> FloatArray:
    """Compute the CIE 1931 functions x̄, ȳ and z̄, (3, N), as sums of Gaussians [Wyman13]; wavelengths are in
    nanometres."""

    def lobe(height: float, mean: float, below: float, above: float) -> FloatArray:
        return height * np.exp(-0.5 * ((wavelength - mean) / np.where(wavelength < mean, below, above)) ** 2)

    x = lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2)
    y = lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1)
    z = lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8)
    return np.stack([x, y, z])


def _valid_turbidity(turbidity: float) -> float:
    if not math.isfinite(turbidity):
        raise EclatError(f"sky: expected a finite turbidity, got {turbidity}")
    clamped = min(max(turbidity, TURBIDITY_RANGE[0]), TURBIDITY_RANGE[1])
    if clamped != turbidity:
        low, high = TURBIDITY_RANGE
        warn(
            f"sky: the turbidity {turbidity:g} is outside of the range {low:g} to {high:g} of the model; {clamped:g} is used"
        )
    return clamped


def _unit(vector: Direction, name: str) -> FloatArray:
    v = np.asarray(vector, dtype=np.float64)
    length = float(np.linalg.norm(v)) if v.shape == (3,) else math.nan
    if not math.isfinite(length) or length == 0:
        raise EclatError(f"sky: expected {name} to be three finite numbers that are not all 0, got {vector}")
    return v / length


def _check(parts: str, albedo: float, sun_scale: float, sky_scale: float, size: tuple[int, int]) -> None:
    if parts not in ("sunsky", "sky", "sun"):
        known = ("sunsky", "sky", "sun")
        raise EclatError(f"sky: expected parts 'sunsky', 'sky' or 'sun', got {parts!r}{did_you_mean(parts, known)}")
    if not 0 <= albedo <= 1:
        raise EclatError(f"sky: expected an albedo from 0 to 1, got {albedo}")
    for name, scale in (("sun_scale", sun_scale), ("sky_scale", sky_scale)):
        if not math.isfinite(scale) or scale < 0:
            raise EclatError(f"sky: expected a finite {name} of at least 0, got {scale}")
    if not (1 <= size[0] <= 16384 and 2 <= size[1] <= 8192):
        raise EclatError(f"sky: expected a size from 1×2 to 16384×8192 pixels, got {size[0]}×{size[1]}")
