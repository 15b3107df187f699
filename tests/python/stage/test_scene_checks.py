# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mistakes in scenes that are built in Python: what is said of each, before anything is rendered."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.scene import Camera, Material, Mesh, PointLight, Scene, grey, look_at, rgb
from eclat.scenes import build
from eclat.stage.scene_checks import check_scene

CORNERS = np.array([[-1.0, 0, -1], [-1, 0, 1], [1, 0, 1]])
ONE = np.array([[0, 1, 2]])

LAMP = PointLight((0, 1, 0), (1, 1, 1))


def scene(material: Any = None, positions: Any = CORNERS, triangles: Any = ONE, light: Any = LAMP) -> Scene:
    mesh = Mesh(positions, triangles, material or Material(), name="floor")
    return Scene((mesh,), (light,), cameras=(Camera(look_at((0, 1, 2), (0, 0, 0))),))


MISTAKES: list[tuple[dict[str, Any], str]] = [
    (
        {"material": Material("mesured", name="a")},
        "material 'a': expected a kind among diffuse, .*; did you mean 'measured'",
    ),
    ({"material": Material("blend", name="a")}, "material 'a': expected 2 children for the kind 'blend', got 0"),
    ({"material": Material("diffuse", children=(Material(),))}, "expected 0 children for the kind 'diffuse', got 1"),
    ({"material": Material("diffuse", {"reflectance": 0.5})}, r"reflectance: expected a Value, .* got 0\.5"),  # type: ignore[dict-item]
    ({"material": Material("measured", measured="a.binary")}, r"expected `measured` as eclat\.load_brdf returns it"),  # type: ignore[arg-type]
    ({"material": Material(back=Material("mesured"))}, "expected a kind among"),
    ({"positions": CORNERS.tolist()}, "mesh 0 'floor': expected positions as a NumPy array of shape .* got a list"),
    ({"positions": CORNERS[:, :2]}, r"expected positions of shape \(N, 3\) with numbers, got \(3, 2\) with float64"),
    ({"triangles": ONE * 1.0}, r"expected triangles of shape \(N, 3\) with whole numbers, got \(1, 3\) with float64"),
    ({"triangles": ONE + 3}, r"mesh 0 'floor': triangle 0: expected vertices 0 to 2, got \[3, 4, 5\]"),
    ({"triangles": ONE - 1}, r"triangle 0: expected vertices 0 to 2, got \[-1, 0, 1\]"),
    ({"light": PointLight((0, 1, 0), 5, name="bulb")}, "light 0 'bulb': expected three numbers as intensity, got 5"),  # type: ignore[arg-type]
    ({"light": PointLight(("a", 1, 0), (1, 1, 1))}, "light 0: expected three numbers as position"),  # type: ignore[arg-type]
]


@pytest.mark.parametrize("change, message", MISTAKES, ids=lambda value: value[:30] if isinstance(value, str) else "")
def test_a_mistake_is_named_with_its_place(change: dict[str, Any], message: str) -> None:
    with pytest.raises(EclatError, match=message):
        eclat.render(scene(**change), "path", samples=1, size=(4, 4))


def test_a_parameter_that_the_kind_does_not_have_is_one_warning() -> None:
    misspelt = Material("diffuse", {"reflectence": rgb(1, 0, 0)}, name="red")
    wanted = "'red': the kind 'diffuse' has no parameter reflectence, which is ignored; did you mean 'reflectance'"
    with pytest.warns(EclatWarning, match=wanted) as heard:
        checked = scene(misspelt)
        for _ in range(2):
            check_scene(checked)
    assert len(heard) == 1


@pytest.mark.parametrize("name", ["cornell-box", "atrium", "furnace"])
@pytest.mark.filterwarnings("error")
def test_good_scenes_pass(name: str) -> None:
    check_scene(build(name))
    check_scene(scene(Material("blend", {"weight": grey(0.3)}, children=(Material(), Material("plastic")))))
