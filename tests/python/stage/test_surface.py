# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Default cameras and lights of scenes with so many triangles that a part of them stands for all."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

from eclat.errors import EclatWarning
from eclat.scene import FloatArray, Material, Mesh, Scene, grey
from eclat.scenes.geometry import Solid, box, join
from eclat.stage.defaults import complete
from eclat.stage.surface import MANY, is_part, surface
from support.solids import corners_of, winding_number

PAINT = Material("diffuse", {"reflectance": grey(0.5)})


def quietly(scene: Scene) -> Scene:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EclatWarning)
        return complete(scene)


def shell(*solids: Solid) -> Mesh:
    solid = join(list(solids))
    return Mesh(solid.positions, solid.triangles, PAINT)


def room(x: float = 0.0) -> Mesh:
    """8 × 3 × 5 m, closed, with a table and a pillar."""
    walls = box((x - 4, 0, -2.5), (x + 4, 3, 2.5)).inside_out()
    table = box((x + 2, 0.7, -1), (x + 4, 0.75, 1))
    return shell(walls, table, box((x - 0.3, -0.1, -0.3), (x + 0.3, 3.1, 0.3)))


def finely(mesh: Mesh, parts: int) -> Mesh:
    """The same surface, each triangle of which is divided into `parts`²."""
    corners = np.asarray(mesh.positions, np.float64)[np.asarray(mesh.triangles)]
    place = {(i, j): i * (parts + 1) - i * (i - 1) // 2 + j for i in range(parts + 1) for j in range(parts + 1 - i)}
    u, v = np.array(list(place)).T / parts
    a, b, c = (corners[:, k, None] for k in range(3))
    positions = a + u[:, None] * (b - a) + v[:, None] * (c - a)
    one = []
    for i in range(parts):
        for j in range(parts - i):
            one.append((place[i, j], place[i + 1, j], place[i, j + 1]))
            if i + j + 1 < parts:
                one.append((place[i + 1, j], place[i + 1, j + 1], place[i, j + 1]))
    triangles = np.array(one)[None] + len(u) * np.arange(len(corners))[:, None, None]
    return Mesh(positions.reshape(-1, 3).astype(np.float32), triangles.reshape(-1, 3).astype(np.int32), mesh.material)


FINE_ROOM = finely(room(), 110)


def assert_lit_in_the_air(got: Scene, walls: FloatArray) -> None:
    assert got.environment is None and not got.lights
    lamp = got.meshes[-1]
    assert lamp.name == "default lamp"
    eye = got.cameras[0].to_world[:3, 3]
    for point in (eye, *lamp.positions):
        assert winding_number(walls, point) == pytest.approx(-1, abs=1e-6), "neither in the pillar nor behind a wall"
    assert lamp.positions[:, 1].mean() > eye[1] + 0.5


def test_the_part_has_the_ends_and_the_large_triangles() -> None:
    large = Mesh(np.array([(0, -9, 0), (70, -9, 0), (0, -9, 70)]), np.array([(0, 1, 2)]), PAINT)
    scene = Scene(meshes=(FINE_ROOM, large))
    assert is_part(scene) and len(FINE_ROOM.triangles) > MANY
    part = surface(scene)
    assert MANY / 2 < len(part) <= MANY + 100
    everything = corners_of(list(scene.meshes))
    np.testing.assert_array_equal(part.min(axis=(0, 1)), everything.min(axis=(0, 1)))
    np.testing.assert_array_equal(part.max(axis=(0, 1)), everything.max(axis=(0, 1)))
    assert (part == corners_of([large])[0]).all(axis=(1, 2)).sum() == 1
    assert surface(scene) is part, "the part is asked for several times"
    assert surface(replace(scene, meshes=scene.meshes[:1])).min() > -9, "another scene that begins with the same mesh"


@pytest.mark.parametrize("stray", ["none", "far", "not finite"])
def test_a_closed_room_of_many_triangles_has_its_lamp_inside(stray: str) -> None:
    meshes = [FINE_ROOM]
    if stray == "far":
        # Its area is a hundred million times that of the room.
        meshes.append(Mesh(np.array([(4e5, 0, 0), (4e5, 0, 5e4), (4e5, 5e5, 0)]), np.array([(0, 1, 2)]), PAINT))
    if stray == "not finite":
        meshes.append(Mesh(np.array([(np.inf, 0, 0), (0, 0, 1), (0, 1, np.nan)]), np.array([(0, 1, 2)]), PAINT))
    assert_lit_in_the_air(quietly(Scene(meshes=tuple(meshes))), corners_of([room()]))


def test_a_few_walls_around_many_triangles_are_closed() -> None:
    """Most triangles are those of a vase; the part must not leave holes in the walls."""
    vase = finely(shell(box((1, 0.76, -0.2), (1.2, 1.1, 0.2))), 200)
    walls = finely(room(), 12)
    assert_lit_in_the_air(quietly(Scene(meshes=(vase, walls))), corners_of([room()]))


def test_a_sheet_of_many_triangles_is_seen_whole_by_daylight() -> None:
    flat = Mesh(np.array([(-5, 0, -5), (-5, 0, 5), (5, 0, -5), (5, 0, 5)]), np.array([(0, 1, 2), (1, 3, 2)]), PAINT)
    few, many = (quietly(Scene(meshes=(mesh,))) for mesh in (flat, finely(flat, 450)))
    np.testing.assert_allclose(many.cameras[0].to_world, few.cameras[0].to_world, rtol=1e-6, atol=1e-5)
    assert many.environment is not None and len(many.lights) == 1


def test_the_choice_is_the_same_each_time() -> None:
    one, other = (quietly(Scene(meshes=(finely(room(), 110),))) for _ in range(2))
    np.testing.assert_array_equal(one.cameras[0].to_world, other.cameras[0].to_world)
    np.testing.assert_array_equal(one.meshes[-1].positions, other.meshes[-1].positions)
