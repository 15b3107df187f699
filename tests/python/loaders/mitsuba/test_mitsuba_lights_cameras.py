# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Emitters and sensors of Mitsuba scenes: the same radiance and the same rays as in Mitsuba 3."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from eclat.errors import EclatError, EclatWarning
from eclat.loaders.mitsuba import load_dict, load_xml
from eclat.scene import Camera, DirectionalLight, Environment, PointLight, Scene, SpotLight

ROTATION = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def scene_of(**objects: object) -> Scene:
    return load_dict({"type": "scene", **objects})


def matrix(linear: np.ndarray, offset: tuple[float, float, float] = (0, 0, 0)) -> np.ndarray:
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = linear, offset
    return result


def lookup(environment: Environment, direction: np.ndarray) -> np.ndarray:
    """Nearest texel in a direction of the world, by the convention of `Environment`."""
    x, y, z = environment.to_world.T @ direction
    u, v = 0.5 + math.atan2(x, -z) / (2 * math.pi), math.acos(np.clip(y, -1, 1)) / math.pi
    height, width = environment.image.shape[:2]
    return environment.image[min(int(v * height), height - 1), int(u * width) % width]


@pytest.mark.parametrize("mirrored", [False, True])
def test_environments_are_turned_as_mitsubas(mirrored: bool) -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    height, width = 128, 256
    rows, columns = np.mgrid[0:height, 0:width]
    # Smooth and different in all directions; v is not compared closer than the half row by which Mitsuba shifts it.
    image = np.stack(
        [1 + np.cos(2 * np.pi * columns / width), 1 + np.sin(2 * np.pi * columns / width), rows / height], -1
    )
    to_world = matrix(ROTATION @ np.diag([-1 if mirrored else 1, 1, 1]))
    emitter = {"type": "envmap", "scale": 2.0, "to_world": mi.ScalarTransform4f(to_world)}
    theirs = mi.load_dict(emitter | {"bitmap": mi.Bitmap(image.astype(np.float32))})
    ours = scene_of(sky=emitter | {"bitmap": mi.Bitmap(image.astype(np.float32))}).environment
    assert ours is not None
    random = np.random.default_rng(3)
    for _ in range(50):
        direction = random.normal(size=3)
        direction /= np.linalg.norm(direction)
        interaction = mi.SurfaceInteraction3f()
        interaction.wi = -direction
        assert np.allclose(lookup(ours, direction), theirs.eval(interaction), atol=0.07)


def test_environments_come_from_files_too(tmp_path: Path) -> None:
    from PIL import Image

    Image.fromarray(np.full((2, 4, 3), 188, dtype=np.uint8)).save(tmp_path / "sky.png")
    scene = load_dict({"type": "scene", "sky": {"type": "envmap", "filename": "sky.png"}}, tmp_path)
    assert scene.environment is not None
    assert scene.environment.image.shape == (2, 4, 3)
    assert np.allclose(scene.environment.image, 0.5029, atol=1e-3)
    with pytest.warns(EclatWarning, match="file not found"):
        scene = load_dict({"type": "scene", "sky": {"type": "envmap", "filename": "none.exr"}}, tmp_path)
    assert scene.environment is not None


def test_points_spots_and_directions_as_in_mitsuba() -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    to_world = mi.ScalarTransform4f().look_at([1, 2, 3], [2, 0, 1], [0, 1, 0])
    intensity = {"type": "rgb", "value": [1, 2, 3]}
    spot = {"type": "spot", "to_world": to_world, "cutoff_angle": 30.0, "intensity": intensity}
    scene = scene_of(
        a=spot,
        b={"type": "point", "position": [1, 2, 3], "intensity": intensity},
        c={"type": "directional", "to_world": to_world},
        d={"type": "directional", "direction": [0, -2, 0], "irradiance": intensity},
        e={"type": "constant", "radiance": 0.5},
    )
    a, b, c, d = scene.lights
    assert isinstance(a, SpotLight) and isinstance(b, PointLight)
    assert isinstance(c, DirectionalLight) and isinstance(d, DirectionalLight)
    assert a.position == (1, 2, 3) and a.falloff == "linear" and a.intensity == (1, 2, 3)
    assert (a.inner_angle, a.outer_angle) == (22.5, 30)
    assert np.allclose(a.direction, np.array([1, -2, -2]) / 3, atol=1e-6)
    assert b == PointLight((1, 2, 3), (1, 2, 3), name="b")
    assert np.allclose(c.direction, a.direction) and c.irradiance == (1, 1, 1)
    assert d == DirectionalLight((0, -1, 0), (1, 2, 3), name="d")
    assert scene.environment is not None and np.allclose(scene.environment.image, 0.5)
    theirs = mi.load_dict(spot)
    for angle in (0, 20, 24, 28, 31):
        interaction = mi.Interaction3f()
        side = np.cross(a.direction, [0, 1, 0])
        side /= np.linalg.norm(side)
        axis = np.array(a.direction)
        interaction.p = a.position + math.cos(math.radians(angle)) * axis + math.sin(math.radians(angle)) * side
        falloff = min(max((a.outer_angle - angle) / (a.outer_angle - a.inner_angle), 0), 1)
        assert np.allclose(
            theirs.sample_direction(interaction, [0.5, 0.5])[1], np.array([1, 2, 3]) * falloff, atol=1e-4
        )


@pytest.mark.parametrize("when", [{}, {"hour": 12.0, "latitude": 45.0, "longitude": 0.0, "timezone": 0.0, "month": 3}])
def test_the_sun_stands_where_mitsuba_puts_it(when: dict) -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    theirs = np.array(mi.traverse(mi.load_dict({"type": "sunsky"} | when))["sun_direction"])
    (sun,) = scene_of(sky={"type": "sunsky"} | when).lights
    assert isinstance(sun, DirectionalLight)
    assert np.degrees(np.arccos(np.clip(-np.dot(sun.direction, theirs), -1, 1))) < 0.5


def test_skies_of_version_0_are_y_up_and_those_of_3_z_up(tmp_path: Path) -> None:
    for version, up in (("0.6.0", 1), ("3.0.0", 2)):
        path = tmp_path / "sky.xml"
        sky = '<emitter type="sky"><vector name="sunDirection" x="0" y="1" z="1"/></emitter>'
        path.write_text(f'<scene version="{version}">{sky}</scene>')
        scene = load_xml(path)
        assert scene.lights == () and scene.environment is not None
        assert np.allclose(scene.environment.to_world[:, 1], np.eye(3)[up])


def test_emitters_that_we_do_not_have_are_named_and_left_out() -> None:
    with pytest.warns(EclatWarning, match=r"dict\['e'\].*projector.*not supported; it is left out"):
        assert scene_of(e={"type": "projector"}).lights == ()
    with pytest.warns(EclatWarning, match="second environment"):
        scene_of(a={"type": "constant"}, b={"type": "constant"})
    with pytest.raises(EclatError, match=r"beam_width ≤ cutoff_angle.*got beam_width 2 and cutoff_angle -3"):
        scene_of(e={"type": "spot", "cutoff_angle": -3.0, "beam_width": 2.0})
    with pytest.raises(EclatError, match="expected a direction, got the zero vector"):
        scene_of(e={"type": "directional", "direction": [0, 0, 0]})


def our_ray(camera: Camera, x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
    """Origin and direction through (x, y) in fractions of the picture, by the convention of `Camera`."""
    assert camera.size is not None
    width, height = camera.size
    aspect = width / height
    axis = {"smaller": "x" if aspect < 1 else "y", "larger": "x" if aspect > 1 else "y"}.get(
        camera.fov_axis, camera.fov_axis
    )
    extent = camera.fov / 2 if camera.projection == "orthographic" else math.tan(math.radians(camera.fov / 2))
    half_x = extent * {"x": 1, "y": aspect, "diagonal": aspect / math.hypot(aspect, 1)}[axis]
    sx = (2 * (x + camera.shift[0]) - 1) * half_x
    sy = (1 - 2 * (y + camera.shift[1])) * half_x / aspect
    frame, origin = np.asarray(camera.to_world)[:3, :3], np.asarray(camera.to_world)[:3, 3]
    if camera.projection == "orthographic":
        return origin + frame @ (sx, sy, 0), -frame[:, 2]
    direction = frame @ (sx, sy, -1)
    return origin, direction / np.linalg.norm(direction)


@pytest.mark.parametrize(
    "sensor",
    [
        {"type": "perspective", "fov": 40.0},
        {"type": "perspective", "fov": 40.0, "fov_axis": "y"},
        {"type": "perspective", "fov": 40.0, "fov_axis": "smaller"},
        {"type": "perspective", "fov": 40.0, "fov_axis": "larger"},
        {"type": "perspective", "fov": 40.0, "fov_axis": "diagonal"},
        {"type": "perspective", "focal_length": "35mm"},
        {"type": "perspective", "fov": 60.0, "principal_point_offset_x": 0.2, "principal_point_offset_y": -0.1},
        {"type": "orthographic"},
        {"type": "thinlens", "fov": 30.0, "aperture_radius": 1e-6, "focus_distance": 3.0},
    ],
)
@pytest.mark.parametrize("mirrored", [False, True])
def test_cameras_shoot_mitsubas_rays(sensor: dict, mirrored: bool) -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    linear = ROTATION @ np.diag([-1 if mirrored else 1, 1, 1])
    if sensor["type"] == "orthographic":
        linear = linear * 2.5
    to_world = matrix(linear, (3, -2, 5))
    film = {"type": "hdrfilm", "width": 300, "height": 200, "rfilter": {"type": "box"}}
    theirs = mi.load_dict(sensor | {"to_world": mi.ScalarTransform4f(to_world), "film": film})
    (camera,) = scene_of(sensor=sensor | {"to_world": to_world, "film": film}).cameras
    assert camera.size == (300, 200)
    assert np.sign(np.linalg.det(camera.to_world)) == (-1 if mirrored else 1)
    for x, y in ((0.0, 0.0), (1.0, 0.0), (0.3, 0.9), (0.5, 0.5)):
        ray, _ = theirs.sample_ray(0, 0.5, [x, y], [0.5, 0.5])
        origin, direction = our_ray(camera, x, y)
        assert np.allclose(direction, ray.d, atol=1e-4)
        along = np.array(ray.o) - origin  # theirs begin at the near plane
        assert np.linalg.norm(along - (along @ direction) * direction) < 1e-4


def test_a_thin_lens_keeps_its_lens() -> None:
    (camera,) = scene_of(s={"type": "thinlens", "aperture_radius": 0.1, "focus_distance": 4.0}).cameras
    assert (camera.aperture_radius, camera.focus_distance, camera.size) == (0.1, 4.0, (768, 576))


def test_up_is_the_axis_nearest_to_the_up_vector_of_the_camera() -> None:
    for axis in range(3):
        for sign in (1.0, -1.0):
            up = np.zeros(3)
            up[axis] = sign
            y = up + 0.1
            z = np.cross(np.roll(up, 1), y)
            frame = np.stack([np.cross(y, z), y, z], axis=1)
            with pytest.warns(EclatWarning, match="scale of a camera"):
                scene = scene_of(s={"type": "perspective", "to_world": matrix(frame)})
            assert scene.up == tuple(up)


def test_several_sensors_are_several_cameras_and_others_are_named() -> None:
    film = {"type": "hdrfilm", "width": 8, "height": 4, "crop_width": 2, "rfilter": {"type": "box"}}
    with pytest.warns(EclatWarning) as record:
        scene = scene_of(a={"type": "perspective", "film": film}, b={"type": "thinlens"}, c={"type": "distant"})
    assert [camera.name for camera in scene.cameras] == ["a", "b"]
    text = "\n".join(str(warning.message) for warning in record)
    assert "crop" in text and "distant" in text and len(record) == 2


@pytest.mark.parametrize(
    ("sensor", "message"),
    [
        ({"fov": 180.0}, "fov: expected an angle between 0 and 180 degrees, got 180"),
        ({"fov": 40.0, "fov_axis": "z"}, "fov_axis: expected one of x, y"),
        ({"focal_length": "0mm"}, "focal_length: expected a length above 0"),
        ({"to_world": np.diag([1.0, 0, 1, 1])}, "expected an invertible matrix"),
        ({"film": {"type": "hdrfilm", "width": 0}}, "expected a width and a height of 1 to"),
        ({"film": {"type": "hdrfilm", "width": 2.5}}, "width: expected an integer, got 2.5"),
    ],
)
def test_cameras_that_cannot_be_are_refused(sensor: dict, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        scene_of(camera={"type": "perspective"} | sensor)


@pytest.mark.parametrize(
    "xml",
    [
        '<background><radiance value="0.5, 0.25, 1"/></background>',
        '<background><rgb name="radiance" value="0.5 0.25 1"/></background>',
        '<emitter type="constant"><radiance value="0.5 0.25 1"/></emitter>',
    ],
)
def test_backgrounds_as_small_renderers_write_them(tmp_path: Path, xml: str) -> None:
    (tmp_path / "scene.xml").write_text(f'<scene version="3.0.0">{xml}</scene>')
    environment = load_xml(tmp_path / "scene.xml").environment
    assert environment is not None and environment.image.tolist() == [[[0.5, 0.25, 1.0]]]


@pytest.mark.parametrize(("key", "meant"), [("widht", "width"), ("heigth", "height"), ("Width", "width")])
def test_a_misspelt_size_of_a_film_is_named(key: str, meant: str) -> None:
    film = {"type": "hdrfilm", key: 300, "file_format": "openexr", "high_quality_edges": True, "crop_width": 300}
    with pytest.warns(EclatWarning) as warned:
        scene_of(sensor={"type": "perspective", "film": film})
    suggestions = [str(w.message) for w in warned if "did you mean" in str(w.message)]
    if key.lower() == meant:
        assert not suggestions
    else:
        assert (
            len(suggestions) == 1 and f"{key!r} is not known and is ignored; did you mean {meant!r}?" in suggestions[0]
        )
