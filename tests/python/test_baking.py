# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Light maps against closed forms and against paths."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError
from eclat.scene import Material, Mesh, PointLight, Scene, grey
from eclat.scenes import build
from support.light_maps import read_at_random

SQUARE = np.array([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], np.float64)
TWO = np.array([[0, 1, 2], [0, 2, 3]])


def plane(two_sided: bool = False) -> Mesh:
    """The square [−1, 1]² that faces +y."""
    return Mesh(SQUARE, TWO, Material("diffuse", {"reflectance": grey(0.5)}, two_sided=two_sided), name="plane")


@pytest.mark.parametrize("shape", ["sphere", "box"])
def test_furnace(shape: str) -> None:
    """Closed, emits 1, reflects half: radiance 2 comes from everywhere, also into edges and corners."""
    room = build("furnace", shape=shape)
    lightmap = eclat.bake(room, texel_size=0.25, samples=1500)
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


def test_cornell_box_against_paths() -> None:
    scene = eclat.load("cornell-box")
    lightmap = eclat.bake(scene, texel_size=0.05, samples=128)
    read = read_at_random(lightmap, 400)
    truth = eclat.irradiance(scene, read.positions, read.normals, eclat.Path(), samples=4096, seed=7)
    error = np.abs(read.irradiance - truth).mean(axis=1) / truth.mean()
    assert np.median(error) < 0.015
    assert (read.irradiance - truth).mean() / truth.mean() == pytest.approx(0, abs=0.01)


def test_same_bits_on_any_number_of_threads() -> None:
    scene = eclat.load("cornell-box")
    first, second = (eclat.bake(scene, eclat.Path(), texel_size=0.1, samples=4, threads=n) for n in (1, 2))
    np.testing.assert_array_equal(first.irradiance, second.irradiance)
    for a, b in zip(first.parts, second.parts, strict=True):
        np.testing.assert_array_equal(a.lightmap_uvs, b.lightmap_uvs)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"texel_size": 1e-5}, "more than a light map of 4096 x 4096 holds; .* m fits"),
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
        eclat.bake(Scene((plane(),)), **keywords)


def test_a_scene_without_surfaces() -> None:
    with pytest.raises(EclatError, match="no surfaces"):
        eclat.bake(Scene())
    line = Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]), Material())
    with pytest.raises(EclatError, match="no surfaces"):
        eclat.bake(Scene((line,)))
