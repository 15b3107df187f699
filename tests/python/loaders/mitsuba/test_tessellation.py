# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Round shapes are cut finely where they are few, and by their size where they are many; their area stays exact."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.loaders.mitsuba.primitives import SEGMENTS
from eclat.loaders.mitsuba.tessellation import MOST_TRIANGLES, triangle_count
from eclat.scene import Mesh


def balls(count: int, radius: float = 0.02, **more: Any) -> dict[str, Any]:
    places = np.random.default_rng(1).uniform(-1, 1, (count, 3)).tolist()
    return {
        f"ball {i}": {"type": "sphere", "radius": radius, "center": place, **more} for i, place in enumerate(places)
    }


def area(mesh: Mesh) -> float:
    a, b, c = np.moveaxis(np.asarray(mesh.positions, np.float64)[mesh.triangles], 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def test_few_shapes_are_tessellated_as_finely_as_one() -> None:
    scene = eclat.load_dict({"type": "scene", **balls(20), "tube": {"type": "cylinder"}, "plate": {"type": "disk"}})
    counts = [len(mesh.triangles) for mesh in scene.meshes]
    assert counts == [triangle_count("sphere", SEGMENTS)] * 20 + [2 * SEGMENTS, SEGMENTS]


@pytest.mark.parametrize("count", [300, 2000])
def test_many_share_the_triangles_and_keep_their_area(count: int) -> None:
    scene = eclat.load_dict({"type": "scene", **balls(count)})
    total = sum(len(mesh.triangles) for mesh in scene.meshes)
    assert 0.8 * MOST_TRIANGLES < total <= MOST_TRIANGLES
    assert area(scene.meshes[7]) == pytest.approx(4 * math.pi * 0.02**2, rel=1e-9)


def test_a_large_shape_among_many_small_ones_stays_finely_tessellated() -> None:
    scene = eclat.load_dict({"type": "scene", **balls(2000), "globe": {"type": "sphere", "radius": 2.0}})
    large, small = len(scene.meshes[-1].triangles), len(scene.meshes[0].triangles)
    assert large == triangle_count("sphere", SEGMENTS) and small < large / 8


def test_instances_count_as_often_as_they_stand_there() -> None:
    group = {"type": "shapegroup", **balls(1)}
    copies = {f"copy {i}": {"type": "instance", "group": {"type": "ref", "id": "group"}} for i in range(1000)}
    scene = eclat.load_dict({"type": "scene", "group": group, **copies})
    assert sum(len(mesh.triangles) for mesh in scene.meshes) <= MOST_TRIANGLES


def test_three_hundred_small_lamps_bring_the_light_of_three_hundred_small_lamps() -> None:
    # Balls that hide next to nothing of each other, seen from far outside: E = Σ L π r² / d².
    lamps = balls(300, 0.004, emitter={"type": "area", "radiance": 5.0})
    scene = eclat.load_dict({"type": "scene", **lamps})
    found = eclat.irradiance(scene, [[0, 0, 100.0]], [[0, 0, -1.0]], eclat.Path(), samples=4096)
    wanted = sum(5 * math.pi * 0.004**2 / (100 - ball["center"][2]) ** 2 for ball in lamps.values())
    np.testing.assert_allclose(found, wanted, rtol=0.03)
