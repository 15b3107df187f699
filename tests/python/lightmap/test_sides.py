# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Which sides get texels."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.lightmap.sides import lit_sides, reflects_diffusely
from eclat.lightmap.solids import solid_triangles
from eclat.scene import Material, PointLight, Scene, grey
from eclat.scenes import build
from eclat.scenes.geometry import box, mesh
from support.planes import square

LIGHTS = (PointLight((0, 0, 2), (1, 1, 1)), PointLight((0, 0, -2), (1, 1, 1)))


def sides_of(scene: Scene, choice: str = "auto"):
    return lit_sides(scene, choice, solid_triangles(scene, scene.meshes))  # type: ignore[arg-type]


@pytest.mark.parametrize(("choice", "count"), [("auto", 2), ("both", 2), ("front", 1)])
def test_sheets(choice: str, count: int) -> None:
    sheet = square(Material(two_sided=True))
    found = sides_of(Scene((sheet,), LIGHTS), choice)
    assert [s.part.back for s in found] == [False, True][:count]
    assert all(s.part.one_of_two == (count == 2) for s in found)
    assert all(s.lit.all() for s in found)
    assert len(sides_of(Scene((square(Material(two_sided=False)),), LIGHTS), choice)) == 1


@pytest.mark.parametrize(("choice", "count"), [("auto", 1), ("both", 2), ("front", 1)])
def test_solids(choice: str, count: int) -> None:
    cube = mesh([box((-1, -1, -1), (1, 1, 1))], Material(two_sided=True), "cube")
    assert len(sides_of(Scene((cube,), LIGHTS), choice)) == count


def test_dark_outsides_get_no_texels() -> None:
    """The outside of a room sees nothing, but for the ends of the wall that stick out of it; furniture has no back."""
    found = {(s.part.mesh.name, s.part.back): s.lit.mean() for s in sides_of(build("two-rooms"))}
    assert found.keys() == {(name, False) for name in ("shell", "wall", "lamp", "boxes")} | {("shell", True)}
    assert found["shell", False] == found["lamp", False] == 1
    assert 0 < found["shell", True] < 0.7, "the ends of the wall stick out and are seen"
    assert 0.8 < found["boxes", False] < 1, "their bottoms look into the void"


def test_emission_on_one_side_makes_two_sheets_in_any_case() -> None:
    lamp = square(Material(two_sided=True, emission=grey(3)))
    front, back = sides_of(Scene((lamp,), LIGHTS), "front")
    assert front.part.mesh.material.emission is not None and back.part.mesh.material.emission is None


@pytest.mark.parametrize(
    ("material", "wanted"),
    [
        (Material("diffuse", {"reflectance": grey(0.2)}), True),
        (Material("diffuse", {"reflectance": grey(0)}), False),
        (Material("conductor"), False),
        (Material("dielectric"), False),
        (Material("plastic"), True),
        (Material("metallic_roughness", {"metallic": grey(1)}), False),
        (Material("metallic_roughness", {"metallic": grey(0.5)}), True),
        (Material("metallic_roughness", {"transmission": grey(1)}), False),
        (Material("blend", children=(Material("conductor"), Material("diffuse"))), True),
        (Material("blend", children=(Material("conductor"), Material("conductor"))), False),
    ],
)
def test_surfaces_without_diffuse_reflection_get_no_texels(material: Material, wanted: bool) -> None:
    assert reflects_diffusely(material) == wanted
    assert np.concatenate([s.lit for s in sides_of(Scene((square(material),), LIGHTS))]).any() == wanted


def test_cornell_boxes_have_one_side() -> None:
    assert len(sides_of(eclat.load("cornell-box"))) == 8
