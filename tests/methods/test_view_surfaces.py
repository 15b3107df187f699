# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Surfaces of special kinds in the page of `eclat view`: lamps that the camera does not see, and measured materials."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.measured_brdf import normal_albedo
from eclat.scene import Camera, DirectionalLight, Environment, Material, Mesh, Scene, grey, look_at, rgb
from support.brdf_files import merl_file, shiny_paint
from support.browser import keep_records, look_at_page, require_browser, require_node, require_page

SIZE = (32, 32)

HALF, HEIGHT, RADIANCE, REFLECTANCE = 0.25, 1.0, 3.0, 0.5


@pytest.fixture(autouse=True)
def browser() -> None:
    require_node(), require_browser(), require_page()


def square(y: float, half: float, up: bool, material: Material) -> Mesh:
    corners = np.array([[-half, y, -half], [-half, y, half], [half, y, half], [half, y, -half]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    return Mesh(corners, triangles if up else triangles[:, ::-1], material, name=material.name)


def middle(scene: Scene) -> np.ndarray:
    """What the page shows in the middle of its picture, with few records."""
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.3), size=SIZE, check=False)
    with eclat.view(scene, solution, texel_size=0.1, samples=64) as viewer:
        page = look_at_page(viewer.url, [{"camera": 0, "width": SIZE[0], "height": SIZE[1]}])
    assert page.message == "" and page.messages == []
    return page.pictures[0][12:20, 12:20].mean(axis=(0, 1))


def test_a_hidden_lamp_lights_the_floor_below_it_and_is_not_seen() -> None:
    x = HALF / HEIGHT
    root = math.sqrt(1 + x * x)
    below = REFLECTANCE * RADIANCE * 4 / math.pi * x / root * math.atan(x / root)  # form factor of a square
    for hidden, expected in ((True, below), (False, RADIANCE)):
        black = {"reflectance": grey(0)}
        glow = Material(
            "diffuse", black, "lamp", emission=rgb(*3 * (RADIANCE,)), emission_two_sided=True, hidden_from_camera=hidden
        )
        floor = Material("diffuse", {"reflectance": grey(REFLECTANCE)}, "floor")
        camera = Camera(look_at((0, 3, 0), (0, 0, 0), up=(0, 0, 1)), fov=4, size=SIZE)
        scene = Scene((square(0, 4, True, floor), square(HEIGHT, HALF, False, glow)), (), cameras=(camera,))
        np.testing.assert_allclose(middle(scene), expected, rtol=0.02)


def test_mirrors_show_a_hidden_lamp() -> None:
    # The camera looks down at a mirror, whose image of the lamp is right above the camera's own place.
    glow = Material(
        "diffuse",
        {"reflectance": grey(0)},
        "lamp",
        emission=rgb(3, 2, 1),
        emission_two_sided=True,
        hidden_from_camera=True,
    )
    mirror = Material("conductor", {"eta": grey(0.0), "k": grey(1.0), "alpha_u": grey(0), "alpha_v": grey(0)}, "mirror")
    camera = Camera(look_at((0, 3, 0), (0, 0, 0), up=(0, 0, 1)), fov=4, size=SIZE)
    scene = Scene((square(0, 1, True, mirror), square(1.0, 0.5, False, glow)), (), cameras=(camera,))
    np.testing.assert_allclose(middle(scene), (3, 2, 1), rtol=0.01)


def test_a_measured_surface_is_shown_with_its_albedo(tmp_path: Path) -> None:
    path = tmp_path / "paint.binary"
    path.write_bytes(merl_file(shiny_paint()))
    brdf = eclat.load_brdf(path)
    floor = Material("measured", name="paint", measured=brdf)
    camera = Camera(look_at((0, 3, 0), (0, 0, 0), up=(0, 0, 1)), fov=4, size=SIZE)
    sun = DirectionalLight((0, -1, 0), (3.0, 2.0, 1.0))
    scene = Scene((square(0, 4, True, floor),), (sun,), cameras=(camera,))
    expected = normal_albedo(brdf) / math.pi * (3, 2, 1)
    assert (expected > 0.01).all()
    with pytest.warns(eclat.EclatWarning, match="'paint' is measured: shown as matte"):
        shown = middle(scene)
    np.testing.assert_allclose(shown, expected, rtol=0.01)


def test_a_plate_close_above_a_wide_floor_hides_it() -> None:
    black = {"reflectance": grey(0)}
    floor = Material("diffuse", black, "floor", emission=rgb(1, 4, 2))
    plate = Material("diffuse", black, "plate", emission=rgb(3, 2, 1))
    camera = Camera(look_at((0, 20, 0), (0, 0, 0), up=(0, 0, 1)), fov=4, size=SIZE)
    scene = Scene((square(0.002, 2, True, plate), square(0, 30, True, floor)), (), cameras=(camera,))
    np.testing.assert_allclose(middle(scene), (3, 2, 1), rtol=1e-3)


def test_a_rib_without_records_takes_the_light_of_what_is_beside_it() -> None:
    floor = Material("diffuse", {"reflectance": grey(REFLECTANCE)}, "floor")
    # Three pixels wide from above, and so steep that no record of the floor serves it.
    corners = np.array([[-0.05, 0, -4], [-0.05, 0, 4], [0.05, 0.3, 4], [0.05, 0.3, -4]])
    rib = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), floor, name="rib")
    camera = Camera(look_at((0, 3, 0), (0, 0, 0), up=(0, 0, 1)), fov=20, size=SIZE)
    scene = Scene((square(0, 4, True, floor), rib), (), Environment(np.ones((2, 4, 3), np.float32)), (camera,))
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.3), size=SIZE, check=False)
    on_floor = solution.normals[:, 1] > 0.9
    assert 0 < on_floor.sum() < len(solution)
    with eclat.view(scene, replace(solution, near=solution.near[on_floor]), texel_size=0.1, samples=16) as viewer:
        keep_records(viewer)
        page = look_at_page(viewer.url, [{"camera": 0, "width": SIZE[0], "height": SIZE[1]}])
    assert page.message == "" and page.messages == []
    # Under an open sky, a bit of which the rib hides from the floor.
    assert page.pictures[0][:, 15:17].min() > 0.6 * REFLECTANCE and page.pictures[0].max() < 1.1 * REFLECTANCE


def test_a_pane_shows_what_is_behind_it_and_mirrors_what_is_before_it() -> None:
    def wall(z: float, towards: int, material: Material) -> Mesh:
        corners = np.array([[-9, -9, z], [9, -9, z], [9, 9, z], [-9, 9, z]], float)
        triangles = np.array([[0, 1, 2], [0, 2, 3]])
        return Mesh(corners, triangles if towards > 0 else triangles[:, ::-1], material, name=material.name)

    black = {"reflectance": grey(0)}
    behind = Material("diffuse", black, "behind", emission=rgb(3, 2, 1))
    before = Material("diffuse", black, "before", emission=rgb(1, 4, 2))
    pane = Material("thin_dielectric", {"ior": grey(1.5), "specular_transmittance": rgb(0.9, 0.8, 0.7)}, "pane")
    camera = Camera(look_at((0, 0, 0), (0, 0, -1)), fov=6, size=SIZE)
    scene = Scene((wall(-2, 1, behind), wall(-1, 1, pane), wall(3, -1, before)), (), cameras=(camera,))
    mirrored = 2 * 0.04 / 1.04
    expected = (1 - mirrored) * np.array((0.9, 0.8, 0.7)) * (3, 2, 1) + mirrored * np.array((1, 4, 2))
    np.testing.assert_allclose(middle(scene), expected, rtol=0.01)
    rendered = eclat.render(scene, eclat.Path(), size=SIZE, samples=256).pixels[12:20, 12:20].mean(axis=(0, 1))
    np.testing.assert_allclose(rendered, expected, rtol=0.03)


def test_glass_behind_a_wall_is_not_seen_and_glass_is_marked() -> None:
    glow = Material("diffuse", {"reflectance": grey(0)}, "glow", emission=rgb(3, 2, 1))
    glass = Material("dielectric", {"ior": grey(1.5)}, "glass")
    camera = Camera(look_at((0, 3, 0), (0, 0, 0), up=(0, 0, 1)), fov=4, size=SIZE)
    marks = []
    for height in (-0.5, 1.0):
        scene = Scene((square(0, 4, True, glow), square(height, 4, True, glass)), (), cameras=(camera,))
        solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.3), size=SIZE, check=False)
        with eclat.view(scene, solution, texel_size=0.5, samples=16) as viewer:
            page = look_at_page(viewer.url, [{"camera": 0, "width": SIZE[0], "height": SIZE[1]}])
        assert page.message == "" and page.messages == []
        share = 0 if height < 0 else 2 * 0.04 / 1.04
        np.testing.assert_allclose(page.pictures[0][16, 16], (1 - share) * np.array((3, 2, 1)), rtol=0.01)
        marks.append(page.approximated[0].mean())
    assert marks == [0, 1]
