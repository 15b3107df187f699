# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Texels that next to no light reaches: a room with a lamp beside a room without one."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.lightmap import darkness
from eclat.lightmap.darkness import DARK_SHARE, Dark, dark_texels, groups_of
from eclat.lightmap.gathering import Settings, TexelPoints, sample_points
from eclat.lightmap.layout import Layout, Wishes, lay_out
from eclat.scene import Environment, Material, Mesh, PointLight, Scene, grey
from eclat.scenes.geometry import box, mesh
from eclat.stage.staging import staged

GREY = Material("diffuse", {"reflectance": grey(0.5)}, two_sided=True)


def two_rooms(hole: float = 0.0) -> Scene:
    """Two cubes of 2 m, side by side; `hole` is the width in m of a slit between them, along their floors."""

    def sheet(corners: list[tuple[float, float, float]], name: str) -> Mesh:
        return Mesh(np.array(corners, np.float64), np.array([[0, 1, 2], [0, 2, 3]]), material=GREY, name=name)

    sheets = []
    for first, name in ((0.0, "lit"), (2.0, "unlit")):
        a, b = first, first + 2
        sheets += [
            sheet([(a, 0, 0), (b, 0, 0), (b, 0, 2), (a, 0, 2)], f"{name} floor"),
            sheet([(a, 2, 0), (b, 2, 0), (b, 2, 2), (a, 2, 2)], f"{name} ceiling"),
            sheet([(a, 0, 0), (b, 0, 0), (b, 2, 0), (a, 2, 0)], f"{name} back"),
            sheet([(a, 0, 2), (b, 0, 2), (b, 2, 2), (a, 2, 2)], f"{name} front"),
        ]
    sheets += [
        sheet([(x, low, 0), (x, 2, 0), (x, 2, 2), (x, low, 2)], f"wall {x}") for x, low in ((0, 0), (2, hole), (4, 0))
    ]
    furniture = mesh([box((2.5, 0, 0.5), (3.0, 0.5, 1.0))], GREY, "box")
    return staged(Scene((*sheets, furniture), (PointLight((1.0, 1.5, 1.0), (1.0, 1.0, 1.0)),), name="two rooms"))


def settings(component: str = "total", seed: int = 0) -> Settings:
    return Settings(component, 64, -1, seed, 1, None)  # type: ignore[arg-type]


def looked_at(scene: Scene, **chosen: object) -> tuple[Layout, TexelPoints, Dark]:
    layout = lay_out(scene, Wishes(0.1), 1, None)
    points = sample_points(layout.corners, layout.texels, 2)
    free = np.ones(points.positions.shape[:2], bool)
    return layout, points, dark_texels(scene, groups_of(layout), points, free, settings(**chosen))  # type: ignore[arg-type]


@pytest.mark.parametrize("component", ["total", "indirect"])
def test_all_of_an_unlit_room_is_dark(component: str) -> None:
    _, points, dark = looked_at(two_rooms(), component=component)
    # Just before its surface, a point is in the room that it looks into.
    x = (points.positions[:, 0] + 1e-3 * points.face_normals[:, 0])[:, 0]
    y, z = points.positions[:, 0, 1], points.positions[:, 0, 2]
    normals = points.face_normals[:, 0]
    inwards = (normals * (np.array([1, 1, 1]) - points.positions[:, 0]))[:, 1:].sum(axis=1)
    inside = np.where(np.abs(normals[:, 0]) > 0.5, (x > 0) & (x < 4), inwards > 0)
    lit = inside & (x < 2) & (y >= 0) & (z >= 0)
    assert 0.2 < lit.mean() < 0.6
    np.testing.assert_array_equal(dark.mask, ~lit)
    np.testing.assert_array_equal(dark.values, 0)
    assert dark.rays > 0


def test_no_group_with_light_is_dark() -> None:
    """A slit of 2 cm lights the second room a little: what has a hundredth of the usual light must be gathered."""
    scene = two_rooms(0.02)
    layout, points, dark = looked_at(scene)
    truth = eclat.irradiance(scene, points.positions[:, 0], points.normals[:, 0], "path", samples=64, threads=2)
    light = truth.mean(axis=1).astype(np.float64)
    groups = groups_of(layout)
    means = np.bincount(groups, light) / np.bincount(groups)
    of_dark = means[np.unique(groups[dark.mask])]
    assert 0.1 < dark.mask.mean() < 0.7
    assert 0 < of_dark.max() < 0.01 * light.mean()
    # What dark texels have is right in the mean.
    assert dark.values[dark.mask].mean() == pytest.approx(light[dark.mask].mean(), abs=2 * DARK_SHARE * light.mean())


def test_a_bake_keeps_its_light(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = two_rooms()
    options = {"texel_size": 0.2, "samples": 32, "max_error": 0.05, "threads": 1}
    fast = eclat.bake(scene, **options)  # type: ignore[arg-type]
    monkeypatch.setattr(darkness, "DARK_SHARE", -1.0)
    slow = eclat.bake(scene, **options)  # type: ignore[arg-type]
    assert fast.statistics["dark"] > 0.5 * fast.statistics["texels"] and slow.statistics["dark"] == 0
    assert fast.statistics["rays"] < 0.9 * slow.statistics["rays"]
    assert fast.irradiance.shape == slow.irradiance.shape
    np.testing.assert_allclose(fast.irradiance.mean(), slow.irradiance.mean(), rtol=0.02)
    assert np.abs(fast.irradiance - slow.irradiance).mean() < 0.02 * slow.irradiance.mean()


def test_scenes_without_light_and_with_light_everywhere() -> None:
    black = two_rooms()
    sky = Scene(black.meshes, (), environment=Environment(np.ones((2, 4, 3), np.float32)), name="sky")
    _, _, dark = looked_at(staged(Scene(black.meshes[:1], (), environment=sky.environment, name="floor")))
    assert not dark.mask.any() and dark.rays > 0
    assert looked_at(black, component="direct")[2].rays == 0


def test_groups_are_squares_of_one_chart() -> None:
    layout = lay_out(two_rooms(), Wishes(0.1), 1, None)
    groups = groups_of(layout)
    charts = layout.corners.charts[layout.texels.triangles]
    for group in np.unique(groups)[::7]:
        mine = groups == group
        assert len(np.unique(charts[mine])) == 1
        assert np.ptp(layout.texels.rows[mine]) < 8 and np.ptp(layout.texels.columns[mine]) < 8
