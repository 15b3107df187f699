# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Sun and sky against the paper's numbers, black bodies and what light meters say of a clear day."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest

from eclat.daylight import sky
from eclat.daylight.sky import horizontal_irradiance, sun_direction, sun_sky
from eclat.errors import EclatError, EclatWarning
from eclat.measure.photometry import LUMENS_PER_WATT, LUMINANCE


def lux(rgb: object) -> float:
    return float(np.asarray(rgb) @ LUMINANCE) * LUMENS_PER_WATT


def directions_of(width: int, height: int) -> np.ndarray:
    """World directions of an environment's texels by the contract's words alone: u = ½ + atan2(x, −z) / 2π."""
    phi = ((np.arange(width) + 0.5) / width - 0.5) * 2 * np.pi
    theta = (np.arange(height) + 0.5) / height * np.pi
    x, z = np.outer(np.sin(theta), np.sin(phi)), -np.outer(np.sin(theta), np.cos(phi))
    return np.stack([x, np.outer(np.cos(theta), np.ones(width)), z], axis=-1)


@pytest.mark.parametrize(
    ("degrees", "turbidity", "kcd"),
    # The paper's formula for Y_z, worked with a pocket calculator.
    [(0.0, 2.0, 15.501), (30.0, 3.0, 10.413), (60.0, 3.0, 5.139), (90.0, 4.0, 1.5572), (45.0, 6.0, 14.893)],
)
def test_luminance_of_the_zenith(degrees: float, turbidity: float, kcd: float) -> None:
    assert sky.zenith_luminance(math.radians(degrees), turbidity) == pytest.approx(1000 * kcd, rel=1e-3)


def test_zenith_has_the_luminance_and_chromaticity_of_the_tables() -> None:
    """Turbidity 2, sun 45° from the zenith: the polynomial of the paper's appendix, evaluated term by term."""
    t, s = 2.0, math.pi / 4
    x = (
        (0.00166 * s**3 - 0.00375 * s**2 + 0.00209 * s) * t**2
        + (-0.02903 * s**3 + 0.06377 * s**2 - 0.03202 * s + 0.00394) * t
        + (0.11693 * s**3 - 0.21196 * s**2 + 0.06052 * s + 0.25886)
    )
    rgb = sky.sky_radiance(np.array([[0.0, 1.0, 0.0]]), np.array([math.sin(s), math.cos(s), 0.0]), t)[0]
    xyz = np.linalg.solve(sky.XYZ_TO_RGB, rgb)
    assert xyz[1] * LUMENS_PER_WATT == pytest.approx(sky.zenith_luminance(s, t), rel=1e-3)
    assert xyz[0] / xyz.sum() == pytest.approx(x, abs=1e-4)
    assert 0.23 < x < 0.27, "a clear zenith is blue: about 20 000 K"


def test_color_matching_integrals_are_those_of_the_cie() -> None:
    integrals = sky._color_matching(np.arange(360.0, 831.0)).sum(axis=1)
    np.testing.assert_allclose(integrals, [106.865, 106.857, 106.892], rtol=0.01)


def test_sun_outside_the_atmosphere_gives_the_solar_illuminance_constant(monkeypatch: pytest.MonkeyPatch) -> None:
    """128 klx (Darula 2005: 133.3 klx); a black body of 5772 K has x = 0.3265, y = 0.3360."""
    monkeypatch.setattr(sky, "_air_mass", lambda sun_zenith: 0.0)
    rgb = sky.sun_irradiance(0.0, 3.0)
    xyz = np.linalg.solve(sky.XYZ_TO_RGB, rgb)
    assert lux(rgb) == pytest.approx(128e3, rel=0.06)
    assert xyz[:2] / xyz.sum() == pytest.approx([0.3265, 0.3360], abs=0.004)


@pytest.mark.parametrize("elevation", [30.0, 45.0, 60.0, 75.0])
def test_a_clear_day_is_as_bright_as_measured(elevation: float) -> None:
    """Direct normal 60–110 klx, sky 10–40 klx (the model is on the bright side), global about 127 sin^1.2 klx."""
    light, environment = sun_sky(sun_direction(70, elevation), turbidity=2.5)
    assert light is not None and environment is not None
    sine = math.sin(math.radians(elevation))
    direct, diffuse = lux(light.irradiance), lux(horizontal_irradiance(environment))
    assert 60e3 < direct < 110e3
    assert 10e3 < diffuse < 40e3
    assert direct * sine + diffuse == pytest.approx(127e3 * sine**1.2, rel=0.3)


def test_the_sun_reddens_and_dims_towards_the_horizon_and_in_haze() -> None:
    def light(elevation: float, turbidity: float) -> np.ndarray:
        sun, _ = sun_sky(sun_direction(0, elevation), turbidity, parts="sun")
        assert sun is not None
        return np.array(sun.irradiance)

    suns = [light(e, 3.0) for e in (80, 50, 20, 5)] + [light(5, 6.0)]
    warmth = [s[0] / max(s[2], 1e-9) for s in suns]
    assert warmth == sorted(warmth)
    assert [lux(s) for s in suns] == sorted((lux(s) for s in suns), reverse=True)


def test_sun_is_a_disc_that_shines_away_from_itself() -> None:
    towards = sun_direction(120, 40)
    light, _ = sun_sky(tuple(3 * c for c in towards))
    assert light is not None
    assert light.angular_radius == 0.2665
    np.testing.assert_allclose(light.direction, [-c for c in towards], atol=1e-12)


def test_azimuth_runs_from_north_through_east() -> None:
    np.testing.assert_allclose(sun_direction(0, 0), (0, 0, -1), atol=1e-12)
    np.testing.assert_allclose(sun_direction(90, 0), (1, 0, 0), atol=1e-12)
    np.testing.assert_allclose(sun_direction(0, 0, (0, 0, 1)), (0, 1, 0), atol=1e-12)
    np.testing.assert_allclose(sun_direction(90, 0, (0, 0, 2)), (1, 0, 0), atol=1e-12)
    np.testing.assert_allclose(sun_direction(33, 90, (0, -1, 0)), (0, -1, 0), atol=1e-12)


@pytest.mark.parametrize("up", [(0, 1, 0), (0, 0, 1), (0, -1, 0), (1, 2, -3)])
def test_brightest_is_the_sky_around_the_sun_whatever_is_up(up: tuple[float, float, float]) -> None:
    towards = sun_direction(200, 35, up)
    _, environment = sun_sky(towards, up=up, size=(256, 128), sun_scale=0)
    assert environment is not None
    world = directions_of(256, 128) @ np.asarray(environment.to_world).T
    above = world @ (np.array(up) / np.linalg.norm(up)) > 0
    peak = world[above][np.argmax((environment.image @ LUMINANCE)[above])]
    assert float(peak @ towards) > math.cos(math.radians(2))
    np.testing.assert_allclose(environment.to_world @ environment.to_world.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(environment.to_world) == pytest.approx(1)


def test_ground_reflects_sky_and_sun() -> None:
    towards = sun_direction(10, 50)
    light, both = sun_sky(towards, albedo=0.4)
    _, alone = sun_sky(towards, albedo=0.4, parts="sky")
    assert light is not None and both is not None and alone is not None
    sine = math.sin(math.radians(50))
    falling = horizontal_irradiance(both) + np.array(light.irradiance) * sine
    np.testing.assert_allclose(both.image[-1, 0], 0.4 / math.pi * falling, rtol=1e-5)
    np.testing.assert_allclose(alone.image[-1, 0], 0.4 / math.pi * horizontal_irradiance(alone), rtol=1e-5)
    assert np.ptp(both.image[128:], axis=(0, 1)).max() == 0, "uniform"
    np.testing.assert_array_equal(both.image[:128], alone.image[:128])


def test_horizontal_irradiance_of_a_constant_environment_is_pi() -> None:
    environment = sky.Environment(np.ones((31, 7, 3), dtype=np.float32))
    np.testing.assert_allclose(horizontal_irradiance(environment), math.pi, rtol=1e-3)


@pytest.mark.parametrize("elevation", [-40, -6, -0.1, 0, 0.01, 1, 20, 89.99, 90])
@pytest.mark.parametrize("turbidity", [1.7, 3, 10])
@pytest.mark.parametrize("size", [(1, 2), (16, 9)])
def test_never_negative_nor_nan(elevation: float, turbidity: float, size: tuple[int, int]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EclatWarning)
        light, environment = sun_sky(sun_direction(77, elevation), turbidity, size=size)
    assert environment is not None
    assert environment.image.dtype == np.float32 and environment.image.shape == (size[1], size[0], 3)
    assert np.isfinite(environment.image).all() and (environment.image >= 0).all()
    assert light is None or (np.isfinite(light.irradiance).all() and min(light.irradiance) >= 0)


def test_dusk_is_dim_without_a_sun_and_says_so() -> None:
    with pytest.warns(EclatWarning, match="below the horizon"):
        light, dusk = sun_sky(sun_direction(0, -6))
    _, day = sun_sky(sun_direction(0, 6))
    assert light is None and dusk is not None and day is not None
    assert 1 < lux(horizontal_irradiance(dusk)) < 0.02 * lux(horizontal_irradiance(day))


def test_parts_and_scales() -> None:
    towards = sun_direction(10, 30)
    sun, nothing = sun_sky(towards, parts="sun")
    none, only_sky = sun_sky(towards, parts="sky", sky_scale=2)
    _, half = sun_sky(towards, parts="sky", sky_scale=1)
    twice, _ = sun_sky(towards, sun_scale=2)
    assert nothing is None and none is None
    assert sun is not None and twice is not None and only_sky is not None and half is not None
    np.testing.assert_allclose(only_sky.image, 2 * half.image, rtol=1e-5)
    np.testing.assert_allclose(twice.irradiance, 2 * np.array(sun.irradiance))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"sun_direction": (0, 0, 0)}, "sun_direction"),
        ({"sun_direction": (0, math.nan, 0)}, "sun_direction"),
        ({"up": (0, 0, 0)}, "up"),
        ({"turbidity": math.inf}, "turbidity"),
        ({"albedo": 1.5}, "albedo"),
        ({"albedo": math.nan}, "albedo"),
        ({"sun_scale": -1}, "sun_scale"),
        ({"sky_scale": math.nan}, "sky_scale"),
        ({"parts": "suns"}, "did you mean 'sun'"),
        ({"size": (0, 4)}, "size"),
        ({"size": (10**6, 10**6)}, "size"),
    ],
)
def test_bad_arguments_are_named(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(EclatError, match=message):
        sun_sky(**{"sun_direction": (0, 1, 0), **arguments})  # type: ignore[arg-type]


@pytest.mark.parametrize("angles", [(math.nan, 10), (10, math.inf), (10, 91)])
def test_bad_angles_are_refused(angles: tuple[float, float]) -> None:
    with pytest.raises(EclatError, match="expected an azimuth and an elevation"):
        sun_direction(*angles)


@pytest.mark.parametrize(("turbidity", "used"), [(1.0, 1.7), (50.0, 10.0)])
def test_turbidity_out_of_the_models_range_is_clamped(turbidity: float, used: float) -> None:
    with pytest.warns(EclatWarning, match="turbidity"):
        _, clamped = sun_sky((0, 1, 1), turbidity)
    _, expected = sun_sky((0, 1, 1), used)
    assert clamped is not None and expected is not None
    np.testing.assert_array_equal(clamped.image, expected.image)
