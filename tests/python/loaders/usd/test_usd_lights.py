# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""UsdLux lights against closed forms: luminances are in cd·m⁻², so that irradiance is in lux."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import UsdLux

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.loaders.usd.shaping import Shaping
from eclat.scene import DirectionalLight, PointLight, SpotLight
from support.usd_files import direct_light, load_usda

Point = tuple[float, float, float]
CENTIMETRES = 'upAxis = "Y"\n    metersPerUnit = 0.01'


def lamp(kind: str, inputs: str, extra: str = "", apis: str = "") -> str:
    return f'def {kind} "lamp" {f"(prepend apiSchemas = [{apis}])" if apis else ""}\n{{\n{inputs}\n{extra}\n}}'


def lux(folder: Path, body: str, point: Point, normal: Point, head: str | None = None) -> float:
    scene = load_usda(folder, body) if head is None else load_usda(folder, body, head)
    assert scene.photometric
    return float(direct_light(scene, point, normal)[1])


@pytest.mark.parametrize(
    ("angle", "normalize"), [(0.53, False), (10.0, False), (40.0, True), (0.0, False), (0.0, True)]
)
def test_a_distant_light_is_in_nits_or_normalized_in_lux(tmp_path: Path, angle: float, normalize: bool) -> None:
    """E = L π sin²(angle / 2); normalised, and without a diameter, E is the intensity. At 60 degrees, half of it."""
    text = lamp(
        "DistantLight", f"float inputs:angle = {angle}\nfloat inputs:intensity = 1000", "bool inputs:normalize = 1"
    )
    body = text if normalize else text.replace("bool inputs:normalize = 1", "")
    expected = 1000.0 if normalize or angle == 0 else 1000 * math.pi * math.sin(math.radians(angle / 2)) ** 2
    assert lux(tmp_path, body, (0, 0, 0), (0, 0, 1)) == pytest.approx(expected, rel=0.01)
    tilted = (0, math.sin(math.radians(30)), math.cos(math.radians(30)))
    assert lux(tmp_path, body, (0, 0, 0), tilted) == pytest.approx(expected * tilted[2], rel=0.01)
    assert lux(tmp_path, body, (0, 0, 0), (0, 0, -1)) == pytest.approx(0, abs=1e-3 * expected)


def test_a_distant_light_has_the_brightness_of_the_schema(tmp_path: Path) -> None:
    light = load_usda(tmp_path, lamp("DistantLight", "")).lights[0]
    assert isinstance(light, DirectionalLight)
    size = math.pi * math.sin(math.radians(0.53 / 2)) ** 2
    assert light.irradiance == pytest.approx((50000 * size,) * 3, rel=1e-6)
    assert light.angular_radius == pytest.approx(0.265)


def rectangle_lux(luminance: float, width: float, height: float, distance: float) -> float:
    """The irradiance in front of the middle of a rectangle: four times the configuration factor of a quarter."""
    a, b = width / 2 / distance, height / 2 / distance
    u, v = math.hypot(1, a), math.hypot(1, b)
    quarter = (a / u * math.atan(b / u) + b / v * math.atan(a / v)) / (2 * math.pi)
    return math.pi * luminance * 4 * quarter


@pytest.mark.parametrize(("head", "unit"), [(None, 1.0), (CENTIMETRES, 0.01)])
def test_a_rectangle_shines_along_minus_z_in_nits(tmp_path: Path, head: str | None, unit: float) -> None:
    """Luminance does not depend on the unit of length: the same numbers in another unit give the same light."""
    body = lamp(
        "RectLight",
        "float inputs:width = 2\nfloat inputs:height = 1\nfloat inputs:intensity = 50\nfloat inputs:exposure = 2",
    )
    point = (0.0, 0.0, -1.5 * unit)
    expected = rectangle_lux(50 * 2**2, 2, 1, 1.5)
    assert lux(tmp_path, body, point, (0, 0, 1), head) == pytest.approx(expected, rel=0.01)
    assert lux(tmp_path, body, (0.0, 0.0, 1.5 * unit), (0, 0, -1), head) == 0


def test_the_texture_of_a_rectangle_stands_upright_and_multiplies_its_light(tmp_path: Path) -> None:
    """Seen from the side that shines, with +y above, row 0 is on top and column 0 on the left, at +x."""
    image = np.zeros((2, 2, 3), np.float32)
    image[0, 0], image[0, 1], image[1, 0] = (3, 0, 0), (0, 2, 0), (0, 0, 1)
    image = image.repeat(32, axis=0).repeat(
        32, axis=1
    )  # Texels are interpolated, so the quarters blend over one of 64.
    eclat.Image(image).save(tmp_path / "colours.exr")
    inputs = "float inputs:width = 2\nfloat inputs:height = 2\nfloat inputs:intensity = 5\n"
    scene = load_usda(tmp_path, lamp("RectLight", inputs + "asset inputs:texture:file = @colours.exr@"))
    near = [(x, y, -0.01) for x, y in ((0.5, 0.5), (-0.5, 0.5), (0.5, -0.5), (-0.5, -0.5))]
    found = eclat.irradiance(scene, near, [(0, 0, 1)] * 4, "direct", samples=256)
    assert found == pytest.approx(
        5 * math.pi * np.array([(3, 0, 0), (0, 2, 0), (0, 0, 1), (0, 0, 0)]), rel=0.03, abs=0.15
    )
    far = eclat.irradiance(scene, [(0, 0, -1.5)], [(0, 0, 1)], "direct", samples=65536)[0]
    assert far == pytest.approx(np.array([3, 2, 1]) / 4 * rectangle_lux(5, 2, 2, 1.5), rel=0.02)


def test_a_rectangle_whose_texture_is_missing_is_even(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="none.exr"):
        scene = load_usda(tmp_path, lamp("RectLight", "asset inputs:texture:file = @none.exr@"))
    emission = scene.meshes[0].material.emission
    assert emission is not None and emission.texture is None


def test_a_disk_and_a_scaled_disk(tmp_path: Path) -> None:
    """E = π L r² / (r² + d²)."""
    body = lamp("DiskLight", "float inputs:radius = 0.5\nfloat inputs:intensity = 7")
    expected = math.pi * 7 * 0.25 / (0.25 + 4)
    assert lux(tmp_path, body, (0, 0, -2), (0, 0, 1)) == pytest.approx(expected, rel=0.01)
    scaled = 'double3 xformOp:scale = (3, 3, 1)\nuniform token[] xformOpOrder = ["xformOp:scale"]'
    body = lamp("DiskLight", "float inputs:radius = 0.5\nfloat inputs:intensity = 7", scaled)
    expected = math.pi * 7 * 2.25 / (2.25 + 4)
    assert lux(tmp_path, body, (0, 0, -2), (0, 0, 1)) == pytest.approx(expected, rel=0.01)


def test_a_sphere(tmp_path: Path) -> None:
    """E = π L (r / d)²."""
    body = lamp("SphereLight", "float inputs:radius = 0.5\nfloat inputs:intensity = 7")
    assert lux(tmp_path, body, (0, 0, -2), (0, 0, 1)) == pytest.approx(math.pi * 7 / 16, rel=0.01)
    assert lux(tmp_path, body, (3, 0, 0), (-1, 0, 0)) == pytest.approx(math.pi * 7 / 36, rel=0.01)


def test_a_thin_cylinder_shines_around_the_x_axis(tmp_path: Path) -> None:
    """E = 2 r L (h / (d² + h²) + atan(h / d) / d), where h is half the length and d ≫ r the distance."""
    body = lamp("CylinderLight", "float inputs:radius = 0.01\nfloat inputs:length = 3\nfloat inputs:intensity = 900")
    half, distance = 1.5, 1.0
    expected = 2 * 0.01 * 900 * (half / (distance**2 + half**2) + math.atan(half / distance) / distance)
    assert lux(tmp_path, body, (0, -1, 0), (0, 1, 0)) == pytest.approx(expected, rel=0.015)
    assert lux(tmp_path, body, (0, 0, 1), (0, 0, -1)) == pytest.approx(expected, rel=0.015)


AREAS = {"RectLight": 6.0, "DiskLight": math.pi / 4, "SphereLight": math.pi, "CylinderLight": 2 * math.pi * 0.5 * 4}


@pytest.mark.parametrize("kind", AREAS)
@pytest.mark.parametrize("head", ['upAxis = "Y"\n    metersPerUnit = 1', CENTIMETRES])
def test_a_normalized_light_is_divided_by_its_area_in_units(tmp_path: Path, kind: str, head: str) -> None:
    inputs = {
        "RectLight": "float inputs:width = 2\nfloat inputs:height = 3",
        "CylinderLight": "float inputs:length = 4",
    }
    body = lamp(kind, inputs.get(kind, "") + "\nbool inputs:normalize = 1\nfloat inputs:intensity = 12")
    emission = load_usda(tmp_path, body, head).meshes[0].material.emission
    assert emission is not None
    assert emission.constant == pytest.approx((12 / AREAS[kind],) * 3, rel=1e-4)


def test_colour_and_temperature_multiply(tmp_path: Path) -> None:
    inputs = "color3f inputs:color = (1, 0.5, 0.25)\nfloat inputs:colorTemperature = 3000\nbool inputs:enableColorTemperature = 1"
    emission = load_usda(tmp_path, lamp("SphereLight", inputs)).meshes[0].material.emission
    assert emission is not None
    warm = np.array(UsdLux.BlackbodyTemperatureAsRgb(3000))
    assert emission.constant == pytest.approx(tuple(warm * [1, 0.5, 0.25]), rel=1e-6)
    # A colour of a temperature has the luminance 1, so that it changes the colour only.
    assert warm @ [0.2126, 0.7152, 0.0722] == pytest.approx(1, abs=0.01)
    off = inputs.replace("enableColorTemperature = 1", "enableColorTemperature = 0")
    emission = load_usda(tmp_path, lamp("SphereLight", off)).meshes[0].material.emission
    assert emission is not None and emission.constant == pytest.approx((1, 0.5, 0.25))


@pytest.mark.parametrize("normalize", [False, True])
def test_a_point_has_the_intensity_of_its_sphere(tmp_path: Path, normalize: bool) -> None:
    """Far away, the point and the sphere give the same light."""
    inputs = f"float inputs:radius = 0.05\nfloat inputs:intensity = 1e4\nbool inputs:normalize = {int(normalize)}"
    sphere = lux(tmp_path, lamp("SphereLight", inputs), (0, 0, -3), (0, 0, 1))
    scene = load_usda(tmp_path, lamp("SphereLight", inputs, "bool treatAsPoint = 1"))
    assert isinstance(scene.lights[0], PointLight)
    assert float(direct_light(scene, (0, 0, -3), (0, 0, 1))[1]) == pytest.approx(sphere, rel=0.01)


CONE = "float inputs:shaping:cone:angle = 30\nfloat inputs:intensity = 1e4\nfloat inputs:radius = 0.02"


def at_angle(degrees: float) -> Point:
    return (math.sin(math.radians(degrees)), 0.0, -math.cos(math.radians(degrees)))


def test_a_hard_cone_becomes_a_spot(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="spheres with a cone or a focus become spot lights at their centres"):
        scene = load_usda(tmp_path, lamp("SphereLight", CONE, apis='"ShapingAPI"'))
    assert isinstance(scene.lights[0], SpotLight)
    for angle, share in ((0, 1), (20, 1), (29.5, 1), (30.5, 0), (90, 0)):
        point = at_angle(angle)
        normal = (-point[0], -point[1], -point[2])
        expected = share * math.pi * 1e4 * 0.02**2
        assert float(direct_light(scene, point, normal)[1]) == pytest.approx(expected, rel=1e-3), angle


def test_softness_and_focus_are_those_of_the_schema(tmp_path: Path) -> None:
    """The luminance falls by a smooth step from 15 to 30 degrees, times cos³ of the angle."""
    extra = "float inputs:shaping:cone:softness = 0.5\nfloat inputs:shaping:focus = 3\nbool treatAsPoint = 1"
    scene = load_usda(tmp_path, lamp("SphereLight", CONE, extra, apis='"ShapingAPI"'))
    for angle in (0.0, 10.0, 18.0, 22.5, 27.0, 31.0):
        point = at_angle(angle)
        t = min(max((angle - 15) / 15, 0), 1)
        share = (1 - (3 * t**2 - 2 * t**3)) * math.cos(math.radians(angle)) ** 3 if angle <= 30 else 0
        got = float(direct_light(scene, point, (-point[0], 0.0, -point[2]))[1])
        assert got == pytest.approx(share * math.pi * 1e4 * 0.02**2, rel=2e-3, abs=1e-4), angle


def test_shaping_is_even_without_a_cone() -> None:
    assert Shaping().is_even and Shaping().factor([0, 90, 179]).tolist() == [1, 1, 1]


def test_cones_of_flat_lights_are_warned_about(tmp_path: Path) -> None:
    body = lamp("RectLight", "float inputs:shaping:cone:angle = 40", apis='"ShapingAPI"')
    with pytest.warns(EclatWarning, match="the cone and the focus of a RectLight are not supported"):
        load_usda(tmp_path, body)


def test_a_dome_of_one_colour(tmp_path: Path) -> None:
    """E = π L from a half space."""
    body = lamp("DomeLight", "float inputs:intensity = 3\ncolor3f inputs:color = (1, 0.5, 0)")
    scene = load_usda(tmp_path, body)
    assert direct_light(scene, (0, 0, 0), (0, 1, 0)) == pytest.approx([3 * math.pi, 1.5 * math.pi, 0], rel=1e-3)


def dome_light(folder: Path, head: str, kind: str, extra: str = "") -> dict[str, float]:
    """The light from each side of a dome whose image is bright around the middle of its right half."""
    pixels = np.zeros((64, 128, 3), np.uint8)
    pixels[28:36, 92:100] = 255  # u = 0.75, v = 0.5
    pixels[:6, :] = 100  # the zenith
    Image.fromarray(pixels).save(folder / "sky.png")
    scene = load_usda(folder, lamp(kind, "asset inputs:texture:file = @sky.png@", extra), head)
    sides = {"+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0), "+z": (0, 0, 1), "-z": (0, 0, -1)}
    return {name: float(direct_light(scene, (0, 0, 0), side)[1]) for name, side in sides.items()}


def test_the_image_of_a_dome_has_z_in_its_middle(tmp_path: Path) -> None:
    """+y is up, and +z in the middle; so −x is to the right of it, at u = 0.75, as one looks along +z."""
    light = dome_light(tmp_path, 'upAxis = "Y"', "DomeLight")
    assert max(light, key=lambda name: light[name]) == "-x"
    assert light["+y"] > light["-y"] and light["+x"] < 0.3 * light["-x"]
    assert light["+z"] == pytest.approx(light["-z"], rel=0.1)


def test_the_pole_of_a_dome_may_be_the_axis_of_the_scene(tmp_path: Path) -> None:
    """The pole +z comes from +y by a quarter turn about x, so that −x stays, and the middle of the image is at −y."""
    light = dome_light(tmp_path, 'upAxis = "Z"', "DomeLight_1", 'uniform token poleAxis = "scene"')
    assert max(light, key=lambda name: light[name]) == "-x"
    assert light["+z"] > light["-z"]
    assert dome_light(tmp_path, 'upAxis = "Z"', "DomeLight")["+y"] == pytest.approx(light["+z"], rel=0.1)


def test_lights_that_are_not_supported_are_named(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="lights of the kind 'PortalLight' are not supported"):
        load_usda(tmp_path, lamp("PortalLight", ""))


def test_invalid_numbers_leave_a_light_out(tmp_path: Path) -> None:
    good = lamp("SphereLight", "").replace("lamp", "good")
    with pytest.warns(EclatWarning, match=r"/lamp: expected a radius of at least 0, got -1; this part .* left out"):
        scene = load_usda(tmp_path, lamp("SphereLight", "float inputs:radius = -1") + "\n" + good)
    assert [mesh.name for mesh in scene.meshes] == ["good"]
    with pytest.warns(EclatWarning, match="expected a luminance of at least 0 that is finite"):
        load_usda(tmp_path, lamp("DiskLight", "float inputs:exposure = 1e6") + "\n" + good)


def test_a_light_that_is_invisible_gives_no_light(tmp_path: Path) -> None:
    body = lamp("SphereLight", 'token visibility = "invisible"') + '\ndef Sphere "ball" {}'
    scene = load_usda(tmp_path, body)
    assert [mesh.name for mesh in scene.meshes] == ["ball"] and not scene.photometric


def test_missing_package_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pxr.Usd", None)
    (tmp_path / "a.usda").write_text("#usda 1.0\n")
    with pytest.raises(EclatError, match=r"USD files can be read only with .* pip install 'eclat\[usd\]'"):
        eclat.load(tmp_path / "a.usda")
