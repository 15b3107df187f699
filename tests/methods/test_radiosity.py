# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Radiosity against closed forms, against `path`, and against itself on other threads."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, Material, Mesh, Scene, grey, look_at
from eclat.scenes import build
from support.bias import SIZE, bias, traced
from support.courtyard import court
from support.statistics import block_means


@pytest.mark.parametrize("gather", [0, 4])
@pytest.mark.parametrize("rho", [0.3, 0.8])
def test_furnace(gather: int, rho: float) -> None:
    """A closed room of albedo ρ that emits L_e: L = L_e / (1 − ρ) everywhere."""
    scene = build("furnace", rho=rho, emission=1.0)
    image = eclat.render(scene, eclat.Radiosity(patches=1000, gather=gather), samples=16, size=SIZE)
    assert image.pixels.mean() == pytest.approx(1 / (1 - rho), rel=0.005)
    assert block_means(image.pixels, 8) == pytest.approx(1 / (1 - rho), rel=0.02 if gather == 0 else 0.08)


def test_agrees_with_path_on_the_cornell_box_after_final_gather() -> None:
    assert bias(*traced("cornell-box", 512), eclat.Radiosity(), samples=96) < 0.01


def test_agrees_with_path_on_the_cornell_box_straight_from_patches() -> None:
    assert bias(*traced("cornell-box", 512), eclat.Radiosity(gather=0), samples=16) < 0.025


def test_error_falls_with_patches_and_tolerance() -> None:
    scene, reference = traced("cornell-box", 512)
    coarse = bias(scene, reference, eclat.Radiosity(patches=300, tolerance=0.1, gather=0), samples=16)
    fine = bias(scene, reference, eclat.Radiosity(patches=10_000, tolerance=0.005, gather=0), samples=16)
    assert fine < 0.5 * coarse


def test_shooting_agrees_with_gathering() -> None:
    scene = build("cornell-box")
    one, two = (eclat.solve(scene, eclat.Radiosity(patches=2000, solver=s)) for s in ("gathering", "shooting"))
    assert len(one) == len(two)
    assert two.irradiance == pytest.approx(one.irradiance, rel=0.01, abs=1e-3 * float(one.irradiance.mean()))
    assert two.statistics["residual"] <= 1e-5


@pytest.mark.parametrize("gather", [0, 4])
@pytest.mark.parametrize("light", ["point", "sun", "sky", "textured"])
def test_agrees_with_path_under_lights_that_are_no_patches(gather: int, light: str) -> None:
    options = eclat.Radiosity(patches=6000, gather=gather)
    assert bias(*traced(light, 384), options, samples=32) < (0.03 if gather else 0.04)


def test_textures_are_averaged_for_transport_and_whole_in_the_picture() -> None:
    scene = court("textured")
    solution = eclat.solve(scene, eclat.Radiosity(patches=2000, gather=0))
    plate = (solution.triangles < 2) & ~solution.is_back
    mean = (230 + 30) / 2 / 255
    assert np.average(solution.albedo[plate, 1], weights=solution.areas[plate]) == pytest.approx(mean, rel=0.02)
    picture = eclat.render(scene, solution, samples=4, size=SIZE)
    albedo = picture.layers["albedo"]
    assert albedo.max() > 0.85 and picture.pixels[40:, :].std() > 0.1


def test_flux_is_conserved_in_a_furnace() -> None:
    scene = build("furnace", rho=0.5, emission=1.0, shape="box")
    solution = eclat.solve(scene, eclat.Radiosity(patches=1000))
    power = (solution.areas[:, None] * solution.radiosity).sum(axis=0)
    assert power == pytest.approx(np.full(3, 24 * np.pi / 0.5), rel=0.003)


@pytest.mark.parametrize("gather", [0, 4])
def test_limited_depth(gather: int) -> None:
    options = eclat.Radiosity(patches=4000, gather=gather)
    assert bias(*traced("cornell-box", 384, 3), options, samples=32, max_depth=3) < 0.03
    scene, _ = traced("cornell-box", 512)
    direct = eclat.render(scene, eclat.Direct(), samples=64, size=SIZE).pixels
    assert bias(scene, direct, options, samples=32, max_depth=2) < 0.03


def test_gloss_causes_a_warning_and_is_traced() -> None:
    scene, reference = traced("glossy-box", 256)
    with pytest.warns(eclat.EclatWarning, match="gloss will light other surfaces as diffuse surfaces do"):
        assert bias(scene, reference, eclat.Radiosity(), samples=32) < 0.04


@pytest.mark.parametrize(("gather", "leak"), [(0, 0.1), (4, 1e-3)])
def test_dark_room_behind_a_thin_wall_stays_dark(gather: int, leak: float) -> None:
    """Straight from patches, one that the wall parts so little that no ray notices it shows light of both of its sides."""
    scene = build("two-rooms")
    solution = eclat.solve(scene, eclat.Radiosity(patches=4000, gather=gather))
    lit, dark = (eclat.render(scene, solution, samples=4, size=SIZE, camera=c).pixels for c in (0, 1))
    assert dark.max() < leak * lit.mean()
    assert dark.mean() < 1e-3 * lit.mean()


def test_irradiance_at_points_agrees_with_path() -> None:
    scene = build("cornell-box")
    points = np.array([[0.0, 0.0, 0.0], [0.3, -0.9, 0.5], [-0.9, 0.3, 0.2]])
    normals = np.array([[0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.2]])
    truth = eclat.irradiance(scene, points, normals, eclat.Path(), component="indirect", samples=8192)
    ours = eclat.irradiance(scene, points, normals, eclat.Radiosity(), component="indirect", samples=2048)
    assert ours == pytest.approx(truth, rel=0.05)


def test_same_bits_on_any_threads_and_tile_order() -> None:
    scene = build("cornell-box")
    options = eclat.Radiosity(patches=2000)
    one, two = (eclat.solve(scene, options, threads=t) for t in (1, 2))
    assert np.array_equal(one.patches, two.patches) and np.array_equal(one.values, two.values)
    first = eclat.render(scene, one, samples=2, size=SIZE, threads=1)
    second = eclat.render(scene, two, samples=2, size=SIZE, threads=2, tile_order=[3, 1, 0, 2])
    assert np.array_equal(first.pixels, second.pixels)
    assert np.array_equal(first.pixels, eclat.render(scene, options, samples=2, size=SIZE).pixels)


@pytest.mark.parametrize("wrong", [{"patches": 10**8}, {"patch_size": 1e-6}])
def test_absurd_numbers_of_patches_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(eclat.EclatError, match=r"radiosity: .*5 million patches"):
        eclat.solve(build("cornell-box"), eclat.Radiosity(**wrong))  # type: ignore[arg-type]


def test_patches_hold_the_irradiance_of_their_middles() -> None:
    """On average, indirect."""
    scene = build("cornell-box")
    solution = eclat.solve(scene, eclat.Radiosity(patches=5000))
    chosen = np.random.default_rng(1).choice(len(solution), 800, p=solution.areas / solution.areas.sum())
    chosen = chosen[~solution.is_unknown[chosen]]
    middles = solution.corners[chosen].mean(axis=1)
    normals = solution.normals[chosen]
    truth = eclat.irradiance(scene, middles, normals, eclat.Path(), component="indirect", samples=512)
    ours = (solution.irradiance - solution.direct)[chosen]
    assert ours.sum() == pytest.approx(truth.sum(), rel=0.012)


def test_scenes_of_small_triangles_cost_what_their_patches_cost() -> None:
    """A room of tiles: links end at face clusters, and the light is that of whole walls."""
    whole, tiled = (tiled_room(n) for n in (1, 48))
    options = eclat.Radiosity(patches=1000, refinements=0, tolerance=0.03)
    one, many = (eclat.solve(scene, options) for scene in (whole, tiled))
    assert many.statistics["patches"] > 50 * one.statistics["patches"]
    assert many.statistics["links"] < 4 * one.statistics["links"]

    def mean(solution: eclat.RadiositySolution) -> float:
        inside = ~solution.is_back
        return float(np.average(solution.irradiance[inside, 1], weights=solution.areas[inside]))

    assert mean(many) == pytest.approx(mean(one), rel=0.03)


def tiled_room(tiles: int) -> Scene:
    """A closed room with a lamp in its ceiling, each wall of tiles × tiles squares."""
    grid = np.linspace(-1, 1, tiles + 1)
    quads = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            for a in range(tiles):
                for b in range(tiles):
                    corners = [(grid[a + i], grid[b + j]) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
                    quad = [np.insert(np.array(c), axis, side) for c in corners]
                    # Inwards: the normal of the corners in this order points along the axis, but for y.
                    inwards = (side < 0) == (axis != 1)
                    quads.append(np.array(quad if inwards else quad[::-1]))
    white = Material("diffuse", {"reflectance": grey(0.6)}, name="white")
    lamp = Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(5.0), name="lamp")
    positions = np.concatenate(quads)
    faces = np.concatenate([[(4 * k, 4 * k + 1, 4 * k + 2), (4 * k, 4 * k + 2, 4 * k + 3)] for k in range(len(quads))])
    light = np.array([(-0.3, 0.98, -0.3), (0.3, 0.98, -0.3), (0.3, 0.98, 0.3), (-0.3, 0.98, 0.3)])
    meshes = (
        Mesh(positions, faces, white, name="room"),
        Mesh(light, np.array([(0, 1, 2), (0, 2, 3)]), lamp, name="lamp"),
    )
    return Scene(meshes, (), None, (Camera(look_at((0, 0, 0.9), (0, 0, -1)), fov=60),), name="tiled")
