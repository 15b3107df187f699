# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Photometric files in place of lights, from Python and from the command line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.cli import main
from eclat.measure.photometry import LUMENS_PER_WATT
from eclat.scene import PointLight, ProfileLight, Scene, SpotLight
from eclat.stage.light_overrides import override_lights, parsed_light_override
from support.luminaires import DOWNLIGHT, cosine_lamp

LIGHTS = (
    PointLight((0, 2, 0), (4, 2, 1), name="bulb"),
    SpotLight((1, 2, 0), (0, 0, -3), (1, 1, 1), 10, 20, name="spot"),
)


def test_the_place_the_aim_and_the_colour_stay() -> None:
    scene = Scene(lights=LIGHTS, photometric=True)
    bulb, spot = override_lights(scene, {"bulb": cosine_lamp(), "spot": cosine_lamp()}).lights
    assert isinstance(bulb, ProfileLight) and isinstance(spot, ProfileLight)
    assert (bulb.position, bulb.name, bulb.scale) == ((0, 2, 0), "bulb", (1, 0.5, 0.25))
    aim = np.array([0, 0, -1.0])
    np.testing.assert_allclose(bulb.to_world @ aim, (0, -1, 0), atol=1e-12)
    np.testing.assert_allclose(spot.to_world @ aim, (0, 0, -1), atol=1e-12)
    (radiometric, _) = override_lights(Scene(lights=LIGHTS), {"bulb": cosine_lamp()}).lights
    assert isinstance(radiometric, ProfileLight)
    np.testing.assert_allclose(radiometric.scale, np.array([1, 0.5, 0.25]) / LUMENS_PER_WATT)


def test_mistakes() -> None:
    with pytest.raises(
        eclat.EclatError, match=r"light 'blub': expected the name of a point or spot light \(bulb, spot\), got"
    ):
        override_lights(Scene(lights=LIGHTS), {"blub": cosine_lamp()})
    with pytest.raises(eclat.EclatError, match="light 'bulb': the scene has no point or spot light with a name"):
        override_lights(Scene(), {"bulb": cosine_lamp()})
    with pytest.raises(eclat.EclatError, match="light 'bulb': expected a profile or the path of a file, got 3"):
        override_lights(Scene(lights=LIGHTS), {"bulb": 3})  # type: ignore[dict-item]
    with pytest.raises(eclat.EclatError, match="expected LIGHT=FILE"):
        parsed_light_override("bulb")


def test_the_flag(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    Path("lamp.ies").write_text(DOWNLIGHT)
    square = '<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/></transform></shape>'
    bulb = '<emitter type="point" id="bulb"><point name="position" x="0" y="1" z="0"/></emitter>'
    Path("room.xml").write_text(f'<scene version="3.0.0">{square}{bulb}</scene>')
    Path("points.csv").write_text("0 0 0 0 1 0\n")
    arguments = ["irradiance", "room.xml", "--points", "points.csv", "--method", "direct", "-o", "e.npy", "--quiet"]
    assert main([*arguments, "--ies", "bulb=lamp.ies"]) == 0
    # 200 cd straight down from one metre.
    np.testing.assert_allclose(np.load("e.npy")[:, 3], [200], rtol=1e-4)  # lux
    assert main([*arguments, "--ies", "bulb=lamp.ies", "--ies", "bulb=lamp.ies"]) == 2
    assert main([*arguments, "--ies", "bulb"]) == 2
    assert main([*arguments, "--ies", "bulb=absent.ies"]) == 2
    assert "absent.ies" in capsys.readouterr().err
