# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Light maps against closed forms and against paths."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.lightmap import fitting
from eclat.lightmap.probes import inside_or_behind
from eclat.lightmap.solids import solid_triangles
from eclat.scene import Environment, Material, Mesh, NormalMap, PointLight, Scene, Texture, Value, grey
from eclat.scenes import build
from eclat.scenes.geometry import icosphere, mesh
from support.light_maps import read_at_random, seam_gap

SQUARE = np.array([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], np.float64)
TWO = np.array([[0, 1, 2], [0, 2, 3]])


def plane(two_sided: bool = False) -> Mesh:
    """The square [−1, 1]² that faces +y."""
    return Mesh(SQUARE, TWO, Material("diffuse", {"reflectance": grey(0.5)}, two_sided=two_sided), name="plane")


@pytest.mark.parametrize("shape", ["sphere", "box"])
def test_furnace(shape: str) -> None:
    """Closed, emits 1, reflects half: radiance 2 comes from everywhere, also into edges and corners."""
    room = build("furnace", shape=shape)
    lightmap = eclat.bake(room, texel_size=0.25, samples=3000)
    error = read_at_random(lightmap, 500).irradiance / (2 * np.pi) - 1
    assert abs(error.mean()) < 0.003
    assert np.sqrt(np.mean(error**2)) < 0.01
    assert np.abs(error).max() < 0.08, "noise of light from nearby, and no dark texel"


def test_a_point_light_over_a_plane() -> None:
    """E = I cos θ / d²; with one light and no shadow there is no noise, so that interpolation is all that errs."""
    height, intensity = 0.8, 3.0
    scene = Scene((plane(),), (PointLight((0.2, height, -0.1), (intensity,) * 3),))
    lightmap = eclat.bake(scene, texel_size=0.02, samples=1)
    read = read_at_random(lightmap, 2000)
    squared = (read.positions[:, 0] - 0.2) ** 2 + (read.positions[:, 2] + 0.1) ** 2 + height**2
    wanted = intensity * height / squared**1.5
    np.testing.assert_allclose(read.irradiance[:, 0], wanted, rtol=2e-3)


@pytest.fixture(scope="module")
def cornell() -> eclat.Lightmap:
    return eclat.bake(eclat.load("cornell-box"), texel_size=0.08, samples=128)


def test_cornell_box_against_paths(cornell: eclat.Lightmap) -> None:
    """At random points of all that can be seen."""
    scene = cornell.scene
    read = read_at_random(cornell, 400)
    truth = eclat.irradiance(scene, read.positions, read.normals, eclat.Path(), samples=4096, seed=7)
    solid = solid_triangles(scene, scene.meshes)
    buried, behind = inside_or_behind(scene, solid, read.positions, read.normals)
    seen = ~buried & ~(behind & (truth.mean(axis=1) < 0.05 * truth.mean()))
    assert seen.mean() > 0.9
    found, truth = read.irradiance[seen], truth[seen]
    error = np.abs(found - truth).mean(axis=1) / truth.mean()
    assert np.median(error) < 0.015
    assert np.quantile(error, 0.95) < 0.04
    assert (found - truth).mean() / truth.mean() == pytest.approx(0, abs=0.01)


def test_same_bits_on_any_number_of_threads() -> None:
    scene = eclat.load("cornell-box")
    first, second = (eclat.bake(scene, eclat.Path(), texel_size=0.1, samples=4, threads=n) for n in (1, 2))
    np.testing.assert_array_equal(first.irradiance, second.irradiance)
    for a, b in zip(first.parts, second.parts, strict=True):
        np.testing.assert_array_equal(a.lightmap_uvs, b.lightmap_uvs)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"texel_size": 1e-5}, "more than 64 light maps of 4084 x 4084 hold; .* m fits"),
        ({"texel_size": 0.0}, "texel_size must be"),
        ({"texel_size": float("nan")}, "texel_size must be"),
        ({"gutter": 1}, "gutter must be"),
        ({"max_size": 4}, "max_size must be"),
        ({"component": "diffuse"}, "component must be one of total, direct, indirect"),
        ({"samples": 0}, "samples must be"),
    ],
)
def test_mistakes_are_told_before_work_starts(keywords: dict, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        eclat.bake(Scene((plane(),), (PointLight((0, 1, 0), (1, 1, 1)),)), **keywords)


def test_a_scene_without_surfaces() -> None:
    with pytest.raises(EclatError, match="no surfaces"):
        eclat.bake(Scene())
    line = Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]), Material())
    with pytest.raises(EclatError, match="no surfaces"):
        eclat.bake(Scene((line,)))


def test_direct_light_of_a_lamp_by_lambert() -> None:
    """E = L/2 Σ Γᵢ nᵢ · n over the edges of a polygon: the Cornell box's floor where it sees all of the lamp."""
    scene = eclat.load("cornell-box")
    empty = replace(scene, meshes=scene.meshes[:6])
    lightmap = eclat.bake(empty, component="direct", texel_size=0.1, samples=4096)
    read = read_at_random(lightmap, 1500)
    floor = read.parts == [part.mesh.name for part in lightmap.parts].index("floor")
    points, found = read.positions[floor], read.irradiance[floor]
    light = scene.meshes[0]
    loop = np.asarray(light.positions)[[0, 1, 2, 3]]
    rays = loop[None] - points[:, None]
    rays /= np.linalg.norm(rays, axis=2, keepdims=True)
    following = np.roll(rays, -1, axis=1)
    angles = np.arccos((rays * following).sum(axis=2))
    sides = np.cross(rays, following)
    sides /= np.linalg.norm(sides, axis=2, keepdims=True)
    factor = np.abs((angles * sides[..., 1]).sum(axis=1)) / 2
    wanted = factor[:, None] * np.array(light.material.emission.constant)  # type: ignore[union-attr]
    assert floor.sum() > 200
    error = found / wanted - 1
    assert np.abs(error).max() < 0.02 and abs(error.mean()) < 0.002


def test_a_dark_room_behind_a_thin_wall_stays_dark() -> None:
    scene = build("two-rooms")
    lightmap = eclat.bake(scene, eclat.Path(), texel_size=0.1, samples=32)
    read = read_at_random(lightmap, 3000)
    dark = (read.positions[:, 0] > 0.1) & (np.abs(read.positions[:, 2]) < 1.49)
    lit = (read.positions[:, 0] < -0.1) & (read.positions[:, 1] > 0.01) & (read.positions[:, 1] < 2.34)
    outside = np.array([part.back for part in lightmap.parts])[read.parts]  # of the shell: the others are solids
    usual = np.median(read.irradiance[lit & ~outside])
    assert dark.sum() > 500 and usual > 0.5
    assert read.irradiance[dark].max() < 1e-4 * usual, "what is left of an iteration"
    assert outside.sum() > 500 and read.irradiance[outside].max() < 1e-4 * usual


def test_a_sheet_has_two_sides() -> None:
    """One lamp above, a weaker one below: each side has its own light, though the sheet has no thickness."""
    lights = (PointLight((0, 0.8, 0), (2, 2, 2)), PointLight((0, -0.8, 0), (0.5, 0.5, 0.5)))
    scene = Scene((plane(two_sided=True),), lights)
    lightmap = eclat.bake(scene, eclat.Direct(), texel_size=0.05, samples=64)
    assert [part.back for part in lightmap.parts] == [False, True]
    read = read_at_random(lightmap, 1000)
    squared = read.positions[:, 0] ** 2 + read.positions[:, 2] ** 2 + 0.64
    for side, power in ((read.normals[:, 1] > 0, 2.0), (read.normals[:, 1] < 0, 0.5)):
        ratio = read.irradiance[side, 0] / (power * 0.8 / squared[side] ** 1.5)
        # Which of the lights a sample asks is drawn by lot, so that there is noise.
        assert side.sum() > 300 and ratio.mean() == pytest.approx(1, abs=0.02)
    single = eclat.bake(scene, eclat.Direct(), texel_size=0.1, samples=1, sides="front")
    assert len(single.parts) == 1 and not single.parts[0].one_of_two


def test_seams_of_a_smooth_surface_meet(monkeypatch: pytest.MonkeyPatch) -> None:
    """On both sides of each cut the lookups agree far better with the fit than with what was gathered."""
    ball = mesh([icosphere(2).smooth(180)], Material("diffuse", {"reflectance": grey(0.5)}, two_sided=False), "ball")
    sky = np.linspace(3, 0, 16, dtype=np.float32).reshape(16, 1, 1).repeat(3, axis=2)
    scene = Scene((ball,), environment=Environment(sky))
    gaps = []
    for fitted in (False, True):
        with monkeypatch.context() as patched:
            if not fitted:
                patched.setattr(fitting, "fit", lambda gathered, lookups, seams, least: gathered)
            lightmap = eclat.bake(scene, eclat.Direct(), texel_size=0.1, samples=256)
        gaps.append(seam_gap(lightmap))
    assert gaps[1] < 0.3 * gaps[0]
    assert gaps[1] < 0.005


def test_the_floor_at_the_foot_of_boxes_is_not_darkened(cornell: eclat.Lightmap) -> None:
    """Texels that lie half under a box, or half below the floor, show the light of what is seen of them."""
    read = read_at_random(cornell, 6000)
    names = np.array([part.mesh.name for part in cornell.parts])[read.parts]
    foot = (names == "large-box") & (read.positions[:, 1] > -0.995) & (read.positions[:, 1] < -0.93)
    foot &= np.abs(read.normals[:, 1]) < 0.5
    truth = eclat.irradiance(cornell.scene, read.positions[foot], read.normals[foot], eclat.Path(), samples=1024)
    assert foot.sum() > 30
    assert read.irradiance[foot].mean() / truth.mean() == pytest.approx(1, abs=0.12)


def test_normal_maps_are_left_out_with_a_warning() -> None:
    texture = Texture(np.full((2, 2, 3), 128, np.uint8))
    material = Material(two_sided=False, normal_map=NormalMap(Value((1.0,) * 3, texture)))
    scene = Scene((replace(plane(), material=material),), (PointLight((0, 1, 0), (1, 1, 1)),))
    with pytest.warns(EclatWarning, match="normal map"):
        eclat.bake(scene, texel_size=0.2, samples=1)
