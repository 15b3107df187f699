# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Animated transforms of Mitsuba files."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatWarning
from eclat.loaders.mitsuba.moving import MovingTransform, at_time
from eclat.scene import PointLight, Scene

SENSOR = '<sensor type="perspective">{}</sensor>'


def load(folder: Path, body: str, strict: bool = True) -> Scene:
    path = folder / "scene.xml"
    path.write_text(f'<scene version="0.6.0">{body}</scene>')
    with warnings.catch_warnings():
        if strict:
            warnings.simplefilter("error", EclatWarning)
        return eclat.load(path)


def moving(*keys: str) -> str:
    return '<animation name="toWorld">' + "".join(keys) + "</animation>"


def key(time: object, step: str) -> str:
    return f'<transform time="{time}">{step}</transform>'


def test_a_shape_a_light_and_a_sensor_move(tmp_path: Path) -> None:
    slide = moving(key(0, '<translate x="1"/>'), key(2, '<translate x="5"/>'))
    scene = load(
        tmp_path,
        f'<shape type="rectangle" id="door">{slide}</shape><shape type="cube" id="still"/>'
        f'<emitter type="point" id="lamp">{slide}</emitter>' + SENSOR.format(slide),
    )
    animation = scene.animation
    assert animation is not None
    assert (animation.start, animation.end) == (0, 2)
    assert (animation.objects, animation.lights) == (("door",), ("lamp",))
    assert len(animation.cameras) == 1
    assert scene.meshes[0].positions[:, 0].mean() == pytest.approx(1)
    moved = scene.at(0.5)
    assert moved.meshes[0].positions[:, 0].mean() == pytest.approx(2)
    assert moved.meshes[1] is scene.meshes[1]
    assert moved.meshes[0].material is scene.meshes[0].material
    assert isinstance(moved.lights[0], PointLight)
    assert moved.lights[0].position[0] == pytest.approx(2)
    assert moved.cameras[0].to_world[0, 3] == pytest.approx(2)
    assert scene.at(9).meshes[0].positions[:, 0].mean() == pytest.approx(5)


def test_a_rotation_takes_the_shorter_arc_and_a_scale_stays(tmp_path: Path) -> None:
    turn = moving(
        key(0, '<scale value="2"/>'), key(1, '<scale value="2"/><rotate z="1" angle="90"/><translate y="4"/>')
    )
    scene = load(tmp_path, f'<shape type="rectangle">{turn}</shape>')
    corners = scene.at(0.5).meshes[0].positions - np.array([0, 2, 0])
    np.testing.assert_allclose(np.linalg.norm(corners, axis=1), 2 * math.sqrt(2))
    # A square that is turned by 45° stands on its corner.
    assert np.abs(corners[:, 0]).max() == pytest.approx(2 * math.sqrt(2))


def test_an_instance_of_a_group_moves(tmp_path: Path) -> None:
    slide = moving(key(0, '<translate x="0"/>'), key(1, '<translate x="3"/>'))
    scene = load(
        tmp_path,
        '<shape type="shapegroup" id="group"><shape type="cube"/></shape>'
        f'<shape type="instance"><ref id="group"/>{slide}</shape>',
    )
    assert scene.at(1).meshes[0].positions[:, 0].mean() == pytest.approx(3)


def test_every_key_is_met_exactly() -> None:
    rng = np.random.default_rng(1)
    matrices = []
    for _ in range(3):
        matrix = np.eye(4)
        matrix[:3] = rng.normal(size=(3, 4))
        matrices.append(matrix)
    transform = MovingTransform.of([0.0, 1.0, 2.0], matrices)
    for time, matrix in enumerate(matrices):
        with at_time(time):
            np.testing.assert_allclose(transform.now(), matrix, atol=1e-10)
    np.testing.assert_array_equal(transform.now(), matrices[0])


def test_keys_in_any_order(tmp_path: Path) -> None:
    slide = moving(key(2, '<translate x="5"/>'), key(0, '<translate x="1"/>'))
    assert load(tmp_path, f'<shape type="cube">{slide}</shape>').at(1).meshes[0].positions[:, 0].mean() == 3


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        ('<transform><translate x="1"/></transform>', "expected the attribute time"),
        (key("soon", '<translate x="1"/>'), "expected a number"),
        (key("nan", '<translate x="1"/>'), "expected a number"),
        (key(1, '<translate x="inf"/>'), "expected a number"),
        (key(1, "<wobble/>"), "expected one of"),
        (key(0, '<translate x="9"/>'), "different times"),
    ],
)
def test_a_bad_key_is_left_out(bad: str, words: str, tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match=f"{words}.*this key of the animation is left out"):
        good = key(0, '<translate x="1"/>')
        scene = load(tmp_path, f'<shape type="cube">{moving(good, bad)}</shape>', strict=False)
    assert scene.meshes[0].positions[:, 0].mean() == pytest.approx(1)
    assert scene.animation is None


def test_an_animation_without_keys(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="no valid key"):
        assert load(tmp_path, f'<shape type="cube">{moving()}</shape>', strict=False).animation is None
