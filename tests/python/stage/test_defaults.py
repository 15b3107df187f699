# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Overrides, and what a scene gets that lacks a camera or a light."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.daylight.sky import upright_frame
from eclat.errors import EclatError, EclatWarning
from eclat.measure.photometry import luminance
from eclat.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Mesh,
    PointLight,
    Scene,
    grey,
    look_at,
)
from eclat.scenes import build
from eclat.scenes.geometry import Solid, box, icosphere, join, revolve, ring
from eclat.stage.defaults import complete, has_light, wants_exposure
from support.solids import corners_of, winding_number

PAINT = Material("diffuse", {"reflectance": grey(0.5)})
CAMERA = Camera(look_at((0, 0, 5), (0, 0, 0)), fov=40, fov_axis="smaller", size=(64, 48))
ANY_LIGHT = (PointLight((0, 0, 0), (1, 1, 1)),)


def scene_of(*solids: Solid, **fields: object) -> Scene:
    meshes = tuple(Mesh(s.positions, s.triangles, PAINT) for s in solids)
    return Scene(meshes=meshes, **fields)  # type: ignore[arg-type]


def quietly(scene: Scene, **arguments: object) -> Scene:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EclatWarning)
        return complete(scene, **arguments)  # type: ignore[arg-type]


def room() -> Scene:
    """8 × 3 × 5 m, closed, with a table and a pillar."""
    table = join([box((2, 0.7, -1), (4, 0.75, 1)), box((2.9, -0.01, -0.1), (3.1, 0.71, 0.1))])
    return scene_of(box((-4, 0, -2.5), (4, 3, 2.5)).inside_out(), table, box((-0.3, -0.1, -0.3), (0.3, 3.1, 0.3)))


def statue() -> Scene:
    """Closed and curved: rays from its middle hit everywhere, but from behind."""
    return scene_of(revolve([(0.5, 0), (0.6, 0.5), (0.2, 1.2), (0.4, 1.6), (0.1, 2.0)], 24), icosphere(2).moved(y=2.5))


def moved(scene: Scene, scale: float, turn: np.ndarray, shift: np.ndarray) -> Scene:
    meshes = tuple(replace(m, positions=scale * m.positions @ turn.T + shift) for m in scene.meshes)
    x, y, z = (float(c) for c in turn @ np.array(scene.up))
    return replace(scene, meshes=meshes, up=(x, y, z))


def sees(camera: Camera, points: np.ndarray) -> np.ndarray:
    """Which points fall into a square picture."""
    local = (points - camera.to_world[:3, 3]) @ camera.to_world[:3, :3]
    reach = -local[:, 2:] * math.tan(math.radians(camera.fov / 2))
    return (np.abs(local[:, :2]) <= reach).all(axis=1) & (local[:, 2] < 0)


def test_a_complete_scene_stays_as_it_is(recwarn: pytest.WarningsRecorder) -> None:
    scene = scene_of(icosphere(1), cameras=(CAMERA,), lights=ANY_LIGHT)
    got = complete(scene)
    assert got.cameras == scene.cameras and got.lights == scene.lights and got.environment is None
    assert not recwarn.list


def test_overrides_of_the_camera() -> None:
    scene = scene_of(icosphere(1), cameras=(CAMERA, CAMERA), lights=ANY_LIGHT)
    got = complete(scene, camera_from=(1, 2, 3), camera_to=(4, 2, 3), camera_up=(0, 0, 1), fov=70, size=(10, 20))
    for camera in got.cameras:
        np.testing.assert_allclose(camera.to_world, look_at((1, 2, 3), (4, 2, 3), (0, 0, 1)))
        assert (camera.fov, camera.fov_axis, camera.size) == (70, "y", (10, 20))
    only_from = complete(scene, camera_from=(1, 2, 3)).cameras[0]
    np.testing.assert_allclose(only_from.to_world[:3, 3], (1, 2, 3))
    np.testing.assert_allclose(only_from.to_world[:3, 2], CAMERA.to_world[:3, 2], atol=1e-12)
    only_to = complete(scene, camera_to=(9, 0, 5)).cameras[0]
    np.testing.assert_allclose(only_to.to_world[:3, 3], (0, 0, 5))
    np.testing.assert_allclose(only_to.to_world[:3, 2], (-1, 0, 0), atol=1e-12)


def test_camera_from_alone_looks_at_the_middle_without_a_warning(recwarn: pytest.WarningsRecorder) -> None:
    scene = scene_of(icosphere(1).moved(x=10), lights=ANY_LIGHT)
    camera = complete(scene, camera_from=(10, 0, 7)).cameras[0]
    np.testing.assert_allclose(camera.to_world, look_at((10, 0, 7), (10, 0, 0)), atol=1e-9)
    assert not recwarn.list


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"camera_from": (0, math.nan, 0)}, "camera-from"),
        ({"camera_to": (0, math.inf, 0)}, "camera-to"),
        ({"camera_up": (0, 0, 0)}, "camera-up"),
        ({"camera_from": (1, 1, 1), "camera_to": (1, 1, 1)}, "two different points"),
        ({"fov": 180}, "fov"),
        ({"fov": math.nan}, "fov"),
        ({"size": (0, 5)}, "size"),
        ({"sun": (10, 95)}, "expected an azimuth and an elevation"),
        ({"sun": (math.nan, 5)}, "expected an azimuth and an elevation"),
        ({"environment": (1, -1, 0)}, "environment"),
        ({"environment": Path("no-such.exr")}, "no-such.exr"),
    ],
)
def test_bad_overrides_are_named(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(EclatError, match=message):
        quietly(scene_of(icosphere(1), cameras=(CAMERA,), lights=ANY_LIGHT), **arguments)


def test_a_broken_environment_file_is_named(tmp_path: Path) -> None:
    for name, content in (("sky.hdr", b"#?RADIANCE\nnot really"), ("sky.txt", b"no image at all")):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(EclatError, match=f"environment: .*{name}: ") as error:
            complete(scene_of(icosphere(1), cameras=(CAMERA,)), environment=tmp_path / name)
        assert " at 0x" not in str(error.value)  # no address of a Python object


def test_environment_of_one_colour_replaces_the_scenes(recwarn: pytest.WarningsRecorder) -> None:
    old = Environment(np.ones((2, 4, 3), dtype=np.float32))
    got = complete(scene_of(icosphere(1), cameras=(CAMERA,), environment=old), environment=(0.1, 0.2, 0.3))
    assert got.environment is not None
    np.testing.assert_allclose(got.environment.image, [[[0.1, 0.2, 0.3]]])
    assert got.lights == () and not recwarn.list


def test_environment_from_an_exr_file(tmp_path: Path) -> None:
    OpenEXR = pytest.importorskip("OpenEXR")
    image = np.random.default_rng(0).random((4, 8, 3), dtype=np.float32) * 50
    image[1, 1] = np.nan
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": image}).write(str(tmp_path / "sky.exr"))
    with pytest.warns(EclatWarning, match="3 values"):
        got = complete(scene_of(icosphere(1), cameras=(CAMERA,), up=(0, 0, 1)), environment=tmp_path / "sky.exr")
    assert got.environment is not None
    np.testing.assert_allclose(got.environment.image, np.nan_to_num(image))
    np.testing.assert_allclose(got.environment.to_world @ (0, 1, 0), (0, 0, 1), atol=1e-12)


def test_a_photograph_as_environment_is_decoded(tmp_path: Path) -> None:
    from PIL import Image

    Image.new("RGB", (4, 2), (188, 188, 188)).save(tmp_path / "sky.png")
    with pytest.warns(EclatWarning, match="no values brighter than white"):
        got = complete(scene_of(icosphere(1), cameras=(CAMERA,)), environment=tmp_path / "sky.png")
    assert got.environment is not None
    np.testing.assert_allclose(got.environment.image, 0.503, atol=2e-3)


def test_sun_replaces_suns_and_sky_but_not_lamps() -> None:
    sun = DirectionalLight((0, -1, 0), (3, 3, 3), 0.2665)
    scene = scene_of(icosphere(1), cameras=(CAMERA,), lights=(*ANY_LIGHT, sun))
    got = complete(scene, sun=(90, 30))
    assert got.lights[0] is ANY_LIGHT[0] and len(got.lights) == 2
    new = got.lights[1]
    assert isinstance(new, DirectionalLight)
    np.testing.assert_allclose(new.direction, (-math.cos(math.pi / 6), -0.5, 0), atol=1e-12)
    assert 100 < new.irradiance[1] < 1000, "beside other lights daylight keeps its true strength"
    assert got.environment is not None and got.environment.image.shape[:2] != (1, 1)
    alone = complete(replace(scene, lights=(sun,)), sun=(90, 30)).lights[0]
    assert isinstance(alone, DirectionalLight) and alone.irradiance == new.irradiance, "and alone"
    both = complete(replace(scene, lights=()), sun=(90, 30), environment=(1, 1, 1))
    assert both.environment is not None and both.environment.image.shape == (1, 1, 3) and len(both.lights) == 1


def test_daylight_has_true_units() -> None:
    """Outdoors it was 4,342 lux where the same sun in a Mitsuba file was 108,331."""
    floor = 9.0 * np.array([[-1.0, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]])
    meshes = (Mesh(floor, np.array([[0, 1, 2], [0, 2, 3]], np.uint32), Material()),)
    for photometric, lumens in ((False, 179.0), (True, 1.0)):
        scene = complete(Scene(meshes=meshes, cameras=(CAMERA,), photometric=photometric), sun=(180, 61.9))
        found = eclat.irradiance(scene, [[0.0, 0, 0]], [[0.0, 1, 0]], eclat.Path(), samples=64)
        assert 100_000 < lumens * float(luminance(found)[0]) < 120_000
    radiometric = replace(scene, photometric=False)
    assert wants_exposure(radiometric, sun=(180, 61.9)) and not wants_exposure(radiometric, environment=(1, 1, 1))


def test_pictures_of_scenes_in_candela_have_an_exposure_that_shows_them() -> None:
    """A lamp of an office has 2000 cd/m²: the picture of the guide's USD example was white all over."""
    lamp = PointLight((0.0, 2.0, 0.0), (800.0, 800.0, 800.0))
    assert wants_exposure(Scene(lights=(lamp,), photometric=True))
    assert not wants_exposure(Scene(lights=(lamp,)))


def test_lights_environments_and_emitting_materials_count_as_light() -> None:
    def painted(material: Material) -> Scene:
        ball = icosphere(0)
        return Scene(meshes=(Mesh(ball.positions, ball.triangles, material),))

    assert not has_light(painted(PAINT))
    assert not has_light(painted(replace(PAINT, emission=grey(0))))
    assert has_light(painted(replace(PAINT, emission=grey(0.1))))
    assert has_light(painted(replace(PAINT, back=replace(PAINT, emission=grey(1)))))
    assert has_light(painted(Material("blend", children=(PAINT, replace(PAINT, emission=grey(1))))))


def test_an_object_is_seen_whole_from_outside_under_the_sky() -> None:
    with pytest.warns(EclatWarning) as caught:
        got = complete(statue())
    assert [str(w.message) for w in caught] == [
        "the scene has no camera: a camera is placed outside of it",
        "the scene has no light: a sun and a sky are added",
    ]
    corners = corners_of(got.meshes)
    camera = got.cameras[0]
    assert camera.fov_axis == "smaller"
    assert sees(camera, corners.reshape(-1, 3)).all()
    assert winding_number(corners, camera.to_world[:3, 3]) == pytest.approx(0, abs=1e-6)
    assert got.environment is not None
    # The sun stands behind the one who looks, to the side.
    (sun,) = got.lights
    assert isinstance(sun, DirectionalLight)
    assert 0.2 < float(np.dot(sun.direction, -camera.to_world[:3, 2])) < 0.95


def test_a_room_is_seen_from_inside_by_lamplight() -> None:
    with pytest.warns(EclatWarning) as caught:
        got = complete(room())
    assert ["placed inside" in str(caught[0].message), "lamp" in str(caught[1].message)] == [True, True]
    assert got.environment is None and not got.lights
    *rest, lamp = got.meshes
    corners = corners_of(rest)
    eye = got.cameras[0].to_world[:3, 3]
    assert winding_number(corners, eye) == pytest.approx(-1, abs=1e-6), "neither in the pillar nor behind a wall"
    assert 0.7 < eye[1] < 2.2
    for point in lamp.positions:
        assert winding_number(corners, point) == pytest.approx(-1, abs=1e-6), "the lamp is in the room's air"
    assert lamp.positions[:, 1].mean() > eye[1] + 0.5


def test_the_default_lamp_gives_a_radiance_near_one() -> None:
    """A cavity's mean radiance: flux · ρ / ((1 − ρ) π area)."""
    lamp = quietly(room()).meshes[-1]
    corners = corners_of([lamp])
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    assert lamp.material.emission is not None
    flux = math.pi * area * lamp.material.emission.constant[0]
    walls = 2 * (8 * 3 + 8 * 5 + 3 * 5)
    assert 0.4 < flux * 0.5 / (0.5 * math.pi * walls) < 2.5


def test_a_room_without_a_wall_is_seen_through_the_opening() -> None:
    box_scene = build("cornell-box")
    got = quietly(replace(box_scene, cameras=()))
    expected = box_scene.cameras[0].to_world
    camera = got.cameras[0].to_world
    np.testing.assert_allclose(camera[:3, :3], expected[:3, :3], atol=1e-6)
    np.testing.assert_allclose(camera[:3, 3], expected[:3, 3], atol=0.2)


def test_a_courtyard_is_daylit_even_from_under_its_roof() -> None:
    """From a deep walk no ray reaches the sky directly, yet the court is open."""
    walls = box((-10, 0, -10), (10, 4, 10)).inside_out()
    no_lid = Solid(walls.positions, walls.triangles[walls.positions[walls.triangles][:, :, 1].min(axis=1) < 4])
    court = scene_of(no_lid, ring([(5, 3.0), (10.5, 3.0), (10.5, 3.5), (5, 3.5)]))
    under = Camera(look_at((9.5, 1.2, 9.5), (0, 1, 0)))
    got = quietly(replace(court, cameras=(under,)))
    assert got.environment is not None and len(got.lights) == 1
    lidded = quietly(replace(court, meshes=(*court.meshes, *scene_of(walls).meshes), cameras=(under,)))
    assert lidded.environment is None and len(lidded.meshes) == len(court.meshes) + 2


def test_daylight_is_chosen_if_rays_escape(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def closed(scene: Scene, camera: Camera) -> bool:
        asked.append(camera)
        return False

    monkeypatch.setattr("eclat.stage.defaults._rays_escape", closed)
    got = quietly(replace(statue(), cameras=(CAMERA,)))
    assert asked == [CAMERA] and got.environment is None and len(got.meshes) == len(statue().meshes) + 1


def test_photometric_scenes_get_lumens() -> None:
    plain, photometric = quietly(statue()), quietly(replace(statue(), photometric=True))
    assert plain.environment is not None and photometric.environment is not None
    np.testing.assert_allclose(photometric.environment.image, 179 * plain.environment.image, rtol=1e-4)


@pytest.mark.parametrize("make", [statue, room])
@pytest.mark.parametrize(("scale", "shift"), [(1e-3, 0.0), (1e4, 0.0), (1.0, 500.0), (30.0, -1e3)])
def test_views_do_not_depend_on_unit_or_place(make: object, scale: float, shift: float) -> None:
    scene: Scene = make()  # type: ignore[operator]
    here = quietly(scene).cameras[0].to_world
    there = quietly(moved(scene, scale, np.eye(3), np.full(3, shift))).cameras[0].to_world
    np.testing.assert_allclose(there[:3, 3], scale * here[:3, 3] + shift, rtol=1e-5, atol=0.2 * scale)
    np.testing.assert_allclose(there[:3, :3], here[:3, :3], atol=0.05)


@pytest.mark.parametrize("up", [(0, 0, 1), (1, 0, 0), (0, -1, 0)])
def test_views_follow_what_is_up(up: tuple[float, float, float]) -> None:
    turn = upright_frame(up)
    here = quietly(room()).cameras[0].to_world
    there = quietly(moved(room(), 1.0, turn, np.zeros(3))).cameras[0].to_world
    np.testing.assert_allclose(there[:3, :3], turn @ here[:3, :3], atol=0.05)
    np.testing.assert_allclose(there[:3, 3], turn @ here[:3, 3], atol=0.2)


@pytest.mark.parametrize(
    "scene",
    [
        Scene(),
        Scene(meshes=(Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int), PAINT),)),
        Scene(meshes=(Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]), PAINT),)),
        Scene(meshes=(Mesh(np.full((3, 3), np.nan), np.array([[0, 1, 2]]), PAINT),)),
        Scene(meshes=(Mesh(np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1.0]]), np.array([[0, 1, 2]]), PAINT),)),
        Scene(meshes=(Mesh(np.array([[1, 1, 1], [1e-7, 0, 0], [1e30, 0, 1.0]]), np.array([[0, 1, 2]]), PAINT),)),
    ],
    ids=["nothing", "no triangles", "a point", "not finite", "flat", "enormous"],
)
def test_strange_scenes_get_a_finite_camera(scene: Scene) -> None:
    got = quietly(scene)
    assert np.isfinite(got.cameras[0].to_world).all()
    assert has_light(got)


@pytest.mark.parametrize("lamp", ["on the wall", "point"])
def test_a_lit_room_whose_normals_point_outwards_is_seen_from_within(lamp: str) -> None:
    outwards = Mesh(*_arrays(box((-2, 0, -1.5), (2, 2.5, 1.5))), PAINT)
    if lamp == "point":
        scene = Scene(meshes=(outwards,), lights=(PointLight((0, 2, 0), (1, 1, 1)),))
    else:
        corners = np.array([[-0.5, 1, -1.49], [0.5, 1, -1.49], [0.5, 2, -1.49], [-0.5, 2, -1.49]])
        glow = replace(PAINT, emission=grey(10.0))
        scene = Scene(meshes=(outwards, Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), glow)))
    with pytest.warns(EclatWarning, match="it looks like a room, so a camera is placed inside"):
        camera = complete(scene).cameras[0]
    assert (np.abs(np.asarray(camera.to_world)[:3, 3] - (0, 1.25, 0)) < (2, 1.25, 1.5)).all()


@pytest.mark.parametrize("light", ["outside", "sky", "one-sided walls", "none"])
def test_a_closed_box_that_is_not_lit_within_is_seen_from_outside(light: str) -> None:
    paint = replace(PAINT, two_sided=light != "one-sided walls")
    place = (0.0, 2.0, 5.0 if light == "outside" else 0.0)
    scene = Scene(
        meshes=(Mesh(*_arrays(box((-2, 0, -1.5), (2, 2.5, 1.5))), paint),),
        lights=() if light in ("sky", "none") else (PointLight(place, (1, 1, 1)),),
        environment=Environment(np.ones((1, 1, 3), np.float32)) if light == "sky" else None,
    )
    with pytest.warns(EclatWarning, match="a camera is placed outside of it"):
        complete(scene)


def _arrays(solid: Solid) -> tuple[np.ndarray, np.ndarray]:
    return solid.positions, solid.triangles
