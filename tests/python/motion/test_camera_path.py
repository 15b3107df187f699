# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Paths of a camera from JSON files and dicts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError

KEYS: list[dict[str, Any]] = [
    {"time": 0, "from": [0, 1, 4], "to": [0, 1, 0], "fov": 40},
    {"time": 2, "from": [4, 1, 0], "fov": 60},
    {"time": 4, "from": [0, 1, -4]},
]


def test_linear_and_smooth(tmp_path: Path) -> None:
    file = tmp_path / "walk.json"
    file.write_text(json.dumps({"keys": KEYS, "name": "walk", "interpolation": "linear", "size": [64, 36]}))
    scene = eclat.with_camera_path(eclat.load("cornell-box"), file)
    assert scene.animation is not None
    assert (scene.animation.start, scene.animation.end, scene.animation.cameras) == (0, 4, ("walk",))
    assert len(scene.cameras) == 2
    camera = scene.at(1).cameras[0]
    np.testing.assert_allclose(camera.to_world[:3, 3], [2, 1, 2])
    assert camera.fov == pytest.approx(50)
    assert camera.size == (64, 36)
    np.testing.assert_allclose(-camera.to_world[:3, 2], np.array([-1, 0, -1]) / np.sqrt(2))
    smooth = eclat.with_camera_path(eclat.load("cornell-box"), {"keys": KEYS})
    np.testing.assert_allclose(smooth.at(2).cameras[0].to_world[:3, 3], [4, 1, 0])
    # The parabola through 0, 4, 0 at the times 0, 2, 4 has its top in the middle, so the camera moves along z alone there.
    before, after = (smooth.at(t).cameras[0].to_world[:3, 3] for t in (1.999, 2.001))
    assert (after - before)[0] == pytest.approx(0, abs=1e-5)
    assert (after - before)[2] == pytest.approx(-0.004, abs=1e-5)
    assert all(a is b for a, b in zip(smooth.at(1).meshes, smooth.meshes, strict=True))


def test_a_size_of_the_user_stays() -> None:
    from eclat.stage.defaults import complete

    scene = complete(eclat.with_camera_path(eclat.load("cornell-box"), {"keys": KEYS}), size=(10, 20))
    assert scene.at(2).cameras[0].size == (10, 20)
    np.testing.assert_allclose(scene.at(2).cameras[0].to_world[:3, 3], [4, 1, 0])


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ({"keys": []}, "list 'keys'"),
        ({"keys": KEYS, "kyes": 1}, "got 'kyes'"),
        ({"keys": KEYS, "interpolation": "jumpy"}, "interpolation: expected one of smooth"),
        ({"keys": [KEYS[0] | {"from": [0, 1]}]}, r"keys\[0\], from: expected three numbers"),
        ({"keys": [KEYS[0] | {"fov": 180}]}, "fov: expected degrees"),
        ({"keys": [KEYS[0] | {"time": float("nan")}]}, "time: expected a finite number"),
        ({"keys": [KEYS[0] | {"to": [0, 1, 4]}]}, "must be finite and differ"),
        ({"keys": [KEYS[0], KEYS[0]]}, "times that increase"),
        ({"keys": [KEYS[0] | {"aim": 3}]}, "got 'aim'"),
        ({"keys": [3]}, "expected an object"),
        ({"keys": KEYS, "size": [0, 3]}, "width and a height"),
        ({"keys": [{"time": 0, "from": [0, 0, 0]}]}, "to: expected three numbers"),
    ],
)
def test_mistakes_are_named(path: dict[str, Any], words: str) -> None:
    with pytest.raises(EclatError, match=words):
        eclat.with_camera_path(eclat.load("cornell-box"), path)


def test_a_file_that_is_no_path(tmp_path: Path) -> None:
    file = tmp_path / "walk.json"
    for text in ("{", "[1]", "[" * 100_000):
        file.write_text(text)
        with pytest.raises(EclatError, match=r"walk\.json: expected"):
            eclat.with_camera_path(eclat.load("cornell-box"), file)
    with pytest.raises(EclatError, match=r"gone\.json"):
        eclat.with_camera_path(eclat.load("cornell-box"), tmp_path / "gone.json")
