# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Poses applied to scenes, and moving scenes on the command line."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.bridge.compiled import fingerprint
from eclat.cli import main
from eclat.errors import EclatError
from eclat.motion.animation import Joined, Motion, Pose
from eclat.scene import Mesh, PointLight, Scene
from eclat.scenes.geometry import icosphere
from support.gltf_files import moving_file

LAMP = PointLight((0.0, 3.0, 0.0), (9.0, 9.0, 9.0))


def rolling() -> Scene:
    """A ball that moves by 1 m/s along x for 2 s and is gone from 1.5 s on, and a lamp that dims to nothing."""
    scene = eclat.load("furnace")
    ball = icosphere(1)
    mesh = Mesh(ball.positions, ball.triangles, scene.meshes[0].material, name="ball")

    def pose(time: float) -> Pose:
        moved = replace(mesh, positions=mesh.positions + np.array([time, 0, 0]))
        lamp = PointLight(LAMP.position, (9 - time,) * 3)
        return Pose({"ball": moved} if time < 1.5 else {}, {"lamp": lamp})

    motion = Motion(Pose({"ball": mesh}, {"lamp": LAMP}), pose, 0.0, 2.0, ("ball",), ("lamp",))
    return replace(scene, meshes=(mesh,), lights=(LAMP,), animation=motion)


def test_a_scene_at_a_time_is_a_scene() -> None:
    scene = rolling()
    moved = scene.at(1)
    np.testing.assert_allclose(moved.meshes[0].positions, scene.meshes[0].positions + np.array([1, 0, 0]))
    assert moved.lights == (PointLight((0.0, 3.0, 0.0), (8.0, 8.0, 8.0)),)
    assert moved.animation is None
    assert moved.at(5) is moved
    assert fingerprint(moved) == fingerprint(scene.at(1))
    assert fingerprint(moved) != fingerprint(scene)
    assert fingerprint(scene) == fingerprint(replace(scene, animation=None))


def test_a_mesh_that_is_gone_has_no_triangles_and_can_be_rendered() -> None:
    gone = rolling().at(1.8)
    assert len(gone.meshes) == 1
    assert len(gone.meshes[0].triangles) == 0
    wall = eclat.load("furnace").meshes[0]
    image = eclat.render(replace(gone, meshes=(*gone.meshes, wall)), eclat.Path(), samples=1, size=(4, 4))
    assert np.isfinite(image.pixels).all()


def test_what_was_replaced_after_loading_does_not_move() -> None:
    scene = rolling()
    ball = icosphere(0)
    other = replace(scene.meshes[0], positions=ball.positions, triangles=ball.triangles)
    changed = replace(scene, meshes=(other,), lights=(replace(LAMP, intensity=(1.0, 1.0, 1.0)),))
    assert changed.at(1).meshes[0] is other
    assert changed.at(1).lights == changed.lights


def test_two_animations_of_one_scene() -> None:
    keys = [{"time": 1, "from": [0, 0, 4], "to": [0, 0, 0]}, {"time": 3, "from": [4, 0, 0]}]
    scene = eclat.with_camera_path(rolling(), {"keys": keys})
    found = scene.animation
    assert isinstance(found, Joined)
    assert (found.start, found.end) == (0, 3)
    assert (found.objects, found.lights, found.cameras) == (("ball",), ("lamp",), ("path",))
    moved = scene.at(1)
    np.testing.assert_allclose(moved.meshes[0].positions, scene.meshes[0].positions + np.array([1, 0, 0]))
    np.testing.assert_allclose(moved.cameras[0].to_world[:3, 3], [0, 0, 4])


def test_a_time_that_is_not_finite() -> None:
    with pytest.raises(EclatError, match="finite time"):
        rolling().at(float("nan"))


def test_info_tells_what_moves(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = moving_file(tmp_path)
    assert main(["info", str(path)]) == 0
    text = capsys.readouterr().out
    assert "animation   0 s to 2 s" in text
    assert "moving      objects door" in text
    assert main(["info", str(path), "--json", "--at", "1"]) == 0
    event = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert event["animation"] == {
        "start": 0, "end": 2, "duration": 2, "objects": ["door"], "lights": [], "cameras": [],
    }  # fmt: skip
    assert event["bounds"][0][0] == 2


def test_render_at_a_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, output = moving_file(tmp_path), tmp_path / "a.npy"
    given = ["--camera-from", "2,0.5,9", "--camera-to", "2,0.5,0", "--environment", "1,1,1", "--method", "direct"]
    common = [*given, "--size", "20x10", "--samples", "4", "-q", "-o", str(output)]
    columns = []
    for time in ("0", "1", "2"):
        assert main(["render", str(path), *common, "--at", time]) == 0
        darker = np.load(output).mean(axis=2) < 0.9
        columns.append(float(np.nonzero(darker)[1].mean()))
    assert columns[0] < columns[1] < columns[2]
    assert main(["render", "furnace", "--at", "1"]) == 2
    assert "nothing moves in furnace" in capsys.readouterr().err
