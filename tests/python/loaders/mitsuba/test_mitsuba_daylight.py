# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Daylight of Mitsuba's files against Mitsuba itself: numbers of version 3.9.1, and the one that is installed."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.loaders.mitsuba.daylight import mitsuba_sun_sky
from eclat.scene import DirectionalLight, Environment, FloatArray, Scene

FILE = """<scene version="3.0.0"><emitter type="{kind}">
<float name="turbidity" value="3"/><vector name="sun_direction" x="0" y="0.6" z="0.8"/>{more}
</emitter></scene>"""


def daylight(folder: Path, kind: str = "sunsky", **scales: float) -> Scene:
    more = "".join(f'<float name="{name}" value="{value}"/>' for name, value in scales.items())
    path = folder / "scene.xml"
    path.write_text(FILE.format(kind=kind, more=more))
    return eclat.load(path)


def seen(sky: Environment | None, direction: FloatArray) -> FloatArray:
    """The texel of the environment in a world direction."""
    assert sky is not None
    x, y, z = np.asarray(sky.to_world)[:3, :3].T @ direction
    height, width = sky.image.shape[:2]
    row = min(int(math.acos(min(1.0, max(-1.0, y))) / math.pi * height), height - 1)
    column = int((math.atan2(x, -z) / (2 * math.pi) + 0.5) * width) % width
    texel: FloatArray = sky.image[row, column]
    return texel


def test_the_zenith_37_degrees_from_the_sun(tmp_path: Path) -> None:
    """Éclat once gave (32.6, 49.8, 93.9), at which all other lights of the file were lost."""
    scene = daylight(tmp_path)
    np.testing.assert_allclose(seen(scene.environment, np.array([0, 0, 1.0])), (0.029, 0.048, 0.096), rtol=0.07)


def test_the_sun_on_a_wall(tmp_path: Path) -> None:
    """A white of reflectance 0.5 that faces +z shows (0.189, 0.157, 0.119) there."""
    (sun,) = daylight(tmp_path, sky_scale=0.0).lights
    assert isinstance(sun, DirectionalLight)
    shown = 0.5 / math.pi * 0.8 * np.array(sun.irradiance)
    np.testing.assert_allclose(shown, (0.18940, 0.15749, 0.11932), rtol=0.03)


def test_scales_and_parts(tmp_path: Path) -> None:
    whole = daylight(tmp_path)
    (sun,) = whole.lights
    assert isinstance(sun, DirectionalLight)
    assert whole.environment is not None
    scaled = daylight(tmp_path, sun_scale=2.0, sky_scale=0.5)
    assert isinstance(scaled.lights[0], DirectionalLight) and scaled.environment is not None
    np.testing.assert_allclose(scaled.lights[0].irradiance, 2 * np.array(sun.irradiance))
    np.testing.assert_allclose(scaled.environment.image, 0.5 * whole.environment.image, rtol=1e-6)
    assert not daylight(tmp_path, "sky").lights
    assert daylight(tmp_path, "sun").environment is None
    assert seen(whole.environment, np.array([0, 0.6, -0.8])).max() == 0, "below the horizon Mitsuba's sky is black"


def test_a_wider_sun_has_the_same_irradiance(tmp_path: Path) -> None:
    (sun,), (wide,) = daylight(tmp_path).lights, daylight(tmp_path, sun_aperture=5.0).lights
    (scaled,) = daylight(tmp_path, sunRadiusScale=10.0).lights
    for light, radius in ((sun, 0.2665), (wide, 2.5), (scaled, 2.665)):
        assert isinstance(light, DirectionalLight)
        assert light.angular_radius == pytest.approx(radius)
        assert isinstance(sun, DirectionalLight) and light.irradiance == sun.irradiance
    with pytest.raises(
        eclat.EclatError, match="expected an angular radius of the sun of at least 0 and below 90 degrees, got 100"
    ):
        daylight(tmp_path, sun_aperture=200.0)


@pytest.mark.parametrize("turbidity", [2.0, 3.0, 5.5, 9.0])
@pytest.mark.parametrize("elevation", [8.0, 40.0, 85.0])
def test_the_sky_is_that_of_the_mitsuba_that_is_installed(turbidity: float, elevation: float) -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    angle = math.radians(elevation)
    to_sun = (0.0, math.cos(angle), math.sin(angle))
    emitter = {"type": "sunsky", "sun_scale": 0.0, "turbidity": turbidity, "sun_direction": list(to_sun)}
    theirs = mi.load_dict({"type": "scene", "light": emitter}).environment()
    _, sky = mitsuba_sun_sky(
        to_sun, turbidity=turbidity, up=(0.0, 0.0, 1.0), albedo=0.3, sun_scale=1.0, sky_scale=1.0, parts="sky"
    )
    ours, true = [], []
    for z in (0.1, 0.3, 0.5, 0.7, 0.9):
        for turn in np.arange(0.13, 2 * math.pi, math.pi / 4):
            across = math.sqrt(1 - z * z)
            direction = np.array([across * math.cos(turn), across * math.sin(turn), z])
            interaction = mi.SurfaceInteraction3f()
            interaction.wi = mi.Vector3f(*-direction)
            true.append(np.array(theirs.eval(interaction)))
            ours.append(seen(sky, direction))
    ratio = np.log(np.array(ours) / np.array(true))
    # The fit errs by 3 %; a texel is half a degree away.
    assert np.sqrt((ratio**2).mean()) < 0.08
    assert abs(ratio.mean()) < 0.05


def test_dusk_fades(tmp_path: Path) -> None:
    def zenith(elevation: float) -> float:
        angle = math.radians(elevation)
        with pytest.warns(eclat.EclatWarning, match="below the horizon"):
            sun, sky = mitsuba_sun_sky(
                (0.0, math.cos(angle), math.sin(angle)),
                turbidity=3.0, up=(0.0, 0.0, 1.0), albedo=0.3, sun_scale=1.0, sky_scale=1.0, parts="sunsky",
            )  # fmt: skip
        assert sun is None
        return float(seen(sky, np.array([0.0, 0, 1]))[1])

    assert 0 < zenith(-6) < 0.02 * zenith(-0.01)
