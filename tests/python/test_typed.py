# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Arguments of wrong types are errors of one line, in every public function; numbers of NumPy are numbers."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError
from eclat.typed import typed

WRONG = [b"x", object, [1.5], (1, 2, 3), {1: 2}, 1 + 2j, Path("x"), np.zeros((2, 2))]
"""Values that no argument but those of `LEFT` may have."""
LEFT = {"scene", "points", "normals", "materials", "what", "progress", "preview", "methods", "continued", "tile_order"}
"""Arguments that take other values too, which have tests below or elsewhere."""


@typed
def mixed(
    count: int, share: float | None = None, on: bool = True, size: tuple[int, int] | None = None, names: str = ""
) -> Any:
    return count, share, on, size, names


def test_numbers_of_numpy_become_pythons() -> None:
    found = mixed(np.int64(3), np.float32(0.5), np.bool_(False), np.array([4, 5]))  # type: ignore[arg-type]
    assert found == (3, 0.5, False, (4, 5), "")
    assert [type(value) for value in found] == [int, float, bool, tuple, str]
    assert mixed(3, 1)[1] == 1.0 and mixed(3, size=[4, 5])[3] == (4, 5)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"count": 2.5}, "mixed: count: expected a whole number, got 2.5"),
        ({"count": True}, "mixed: count: expected a whole number, got True"),
        ({"share": "x"}, "mixed: share: expected a number or None, got 'x'"),
        ({"share": 10**400}, "mixed: share: expected a number or None, got 1000"),
        ({"on": 1}, "mixed: on: expected True or False, got 1"),
        ({"size": (1, 2, 3)}, r"mixed: size: expected two whole numbers or None, got \(1, 2, 3\)"),
        ({"size": "12"}, "mixed: size: expected two whole numbers or None, got '12'"),
        ({"names": None}, "mixed: names: expected a text, got None"),
    ],
)
def test_wrong_types_are_named(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(EclatError, match=message):
        mixed(**({"count": 1} | arguments))


def test_missing_and_unknown_arguments_are_pythons_own_errors() -> None:
    with pytest.raises(TypeError, match="missing 1 required"):
        mixed()  # type: ignore[call-arg]
    with pytest.raises(TypeError, match=r"mixed\(\) got an unexpected keyword argument 'nmaes'; did you mean 'names'"):
        mixed(1, nmaes="a")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="'quick'; expected one of count, share, on, size, names"):
        mixed(1, quick=True)  # type: ignore[call-arg]
    with pytest.raises(
        TypeError, match=r"render\(\) got an unexpected keyword argument 'sample'; did you mean 'samples'"
    ):
        eclat.render("furnace", sample=3)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match=r"PhotonMap\(\) got an unexpected .* 'photon'; did you mean 'photons'"):
        eclat.PhotonMap(photon=3)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="unexpected keyword argument 'colour'"):
        mixed(1, colour=2)  # type: ignore[call-arg]


@pytest.mark.parametrize("verb", [eclat.render, eclat.solve, eclat.bake, eclat.compare])
def test_verbs_refuse_wrong_types(verb: Callable[..., Any]) -> None:
    scene = eclat.load("cornell-box")
    for name in inspect.signature(verb).parameters:
        for wrong in WRONG if name not in LEFT else ():
            with pytest.raises(EclatError, match=f"{name}: expected|got .* {name}|{name} must|several"):
                verb(scene, **{name: wrong})


@pytest.mark.parametrize("wrong", [None, "x", 3, b"x", object])
def test_other_functions_refuse_wrong_types(wrong: Any) -> None:
    scene = eclat.load("cornell-box")
    point, normal = np.zeros((1, 3)), np.array([[0, 1.0, 0]])
    points: Any = 3 if wrong is None else wrong
    calls: list[Callable[[], Any]] = [
        lambda: eclat.load(wrong),
        lambda: eclat.load_dict(wrong),
        lambda: eclat.load_solved(wrong),
        lambda: eclat.merge(wrong, wrong),
        lambda: eclat.denoise(wrong),
        lambda: eclat.refine(wrong, scene),
        lambda: eclat.override_materials(scene, wrong),
        lambda: eclat.override_materials(scene, {"white": wrong}),
        lambda: eclat.irradiance(scene, wrong, normal),
        lambda: eclat.irradiance(scene, point, wrong),
        lambda: eclat.solve(scene, points=points),
        lambda: eclat.compare(scene, points),
    ]
    for call in calls:
        with pytest.raises(EclatError):
            call()


def test_a_dict_is_loaded_like_a_file() -> None:
    scene = eclat.load({"type": "scene", "ball": {"type": "sphere"}})
    assert len(scene.meshes) == 1
    with pytest.raises(EclatError, match="did you mean 'sphere'"):
        eclat.load({"type": "scene", "ball": {"type": "spere"}})
