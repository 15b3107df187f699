# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Animations: the same files in any order and after any interruption; one cache along a path; motion blur; what is refused."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat import _core
from eclat.cli import main
from eclat.errors import EclatError
from eclat.frames.kept import KEY, fingerprint_of, is_finished
from eclat.images.image import Image
from eclat.images.image_files import read_png_metadata
from eclat.motion.animation import Motion, Pose
from eclat.scene import Camera, Material, Mesh, Scene, grey, look_at

WALK: dict[str, Any] = {
    "keys": [{"time": 0, "from": [0, 1, 3.4], "to": [0, 1, 0]}, {"time": 1, "from": [0.8, 1.2, 3.0]}]
}
COMMON: dict[str, Any] = {"size": (24, 16), "samples": 2, "threads": 2, "fps": 4}


def walk() -> Scene:
    return eclat.with_camera_path(eclat.load("cornell-box"), WALK)


def sliding(seconds: float = 1.0, reach: float = 2.0) -> Scene:
    """A card of 1 m that glows with a radiance of 1 slides along x by `reach` in some seconds, before black."""
    corners = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])
    glow = Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(1.0))
    card = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), glow, name="card")

    def pose(at: float) -> Pose:
        share = min(max(at / seconds, 0.0), 1.0)
        return Pose({0: replace(card, positions=corners + np.array([reach * share, 0, 0]))})

    motion = Motion(Pose({0: card}), pose, 0.0, seconds, ("card",))
    camera = Camera(look_at((0.0, 0.0, 5.0), (0.0, 0.0, 0.0)), 4.0, "y", "orthographic")
    return Scene((card,), cameras=(camera,), name="sliding", animation=motion)


def sliding_in_the_box() -> Scene:
    """The Cornell box with that card in it."""
    box, alone = eclat.load("cornell-box"), sliding(reach=0.4)
    assert alone.animation is not None
    fixed: dict[Any, Mesh] = dict(enumerate(box.meshes))

    def pose(at: float) -> Pose:
        return Pose(fixed | {"card": alone.at(at).meshes[0]})

    rest = pose(0)
    return replace(box, meshes=tuple(rest.meshes.values()), animation=Motion(rest, pose, 0.0, 1.0, ("card",)))


def counted_solves(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return a list that gets the number of cameras of each solve of records."""
    counts: list[int] = []
    solve = _core.solve_for_cameras

    def counted(scene: Any, cameras: Any, *rest: Any) -> None:
        counts.append(len(cameras))
        solve(scene, cameras, *rest)

    monkeypatch.setattr(_core, "solve_for_cameras", counted)
    return counts


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def test_frames_along_a_path_read_one_cache_and_are_the_same_files_in_any_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    solves = counted_solves(monkeypatch)
    scene = walk()
    whole = eclat.animate(scene, frames=range(5), output=tmp_path / "a" / "%02d.exr", **COMMON)
    assert [path.name for path in whole] == [f"{n:02}.exr" for n in range(5)]
    assert solves == [5]
    for shard in ((2, 2), (1, 2)):
        few = COMMON | {"threads": 1}
        eclat.animate(walk(), frames=range(5), output=tmp_path / "b" / "%02d.exr", shard=shard, **few)
    assert solves == [5, 5, 5]
    assert files(tmp_path / "a") == files(tmp_path / "b")
    images = [Image.load(path) for path in whole]
    assert len({image.metadata["statistics"]["records"] for image in images}) == 1
    assert [image.metadata[KEY]["time"] for image in images] == [0, 0.25, 0.5, 0.75, 1]
    assert {"object_id", "motion_next", "motion_previous"} <= set(images[0].layers)
    assert not np.array_equal(images[0].pixels, images[4].pixels)


def test_finished_frames_are_kept_and_others_are_told_apart(tmp_path: Path) -> None:
    scene, output = walk(), tmp_path / "%d.png"
    seen: list[tuple[str, bool]] = []
    given: dict[str, Any] = {"frames": range(3), "output": output, **COMMON}

    def note(path: Path, kept: bool) -> None:
        seen.append((path.name, kept))

    eclat.animate(scene, "path", **given, finished=note)
    before = files(tmp_path)
    (tmp_path / "1.png").unlink()
    eclat.animate(walk(), "path", **given, finished=note)
    assert seen == [
        ("0.png", False),
        ("1.png", False),
        ("2.png", False),
        ("1.png", False),
        ("0.png", True),
        ("2.png", True),
    ]
    assert files(tmp_path) == before
    assert read_png_metadata(tmp_path / "1.png")[KEY]["number"] == 1
    for other in ({"samples": 3}, {"seed": 1}, {"size": (24, 18)}, {"fps": 5}, {"shutter": 0.5}, {"exposure": 1.0}):
        with pytest.raises(EclatError, match=r"\.png: expected a frame of this animation.*--overwrite"):
            eclat.animate(scene, "path", **given | other)
    with pytest.raises(EclatError, match="another scene or with other settings"):
        eclat.animate(scene, "direct", **given)
    dark = replace(scene, meshes=scene.meshes[:-1])
    with pytest.raises(EclatError, match="another scene or with other settings"):
        eclat.animate(dark, "path", **given)
    assert files(tmp_path) == before
    eclat.animate(scene, "path", **given | {"seed": 1}, overwrite=True)
    assert files(tmp_path) != before


def test_a_file_of_another_origin_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "0.png").write_bytes(b"holiday")
    with pytest.raises(EclatError, match="got another file"):
        eclat.animate(walk(), "path", frames=[0], output=tmp_path / "%d.png", **COMMON)
    assert (tmp_path / "0.png").read_bytes() == b"holiday"


def test_a_fingerprint_is_of_all_its_parts(tmp_path: Path) -> None:
    assert fingerprint_of({"a": 1, "b": (2.5, None)}) == fingerprint_of({"b": (2.5, None), "a": 1})
    assert fingerprint_of({"a": 1}) != fingerprint_of({"a": 2})
    assert not is_finished(tmp_path / "none.png", "x")


def test_where_things_move_each_frame_is_the_picture_of_its_scene(tmp_path: Path) -> None:
    scene = sliding()
    paths = eclat.animate(scene, "path", frames=range(3), output=tmp_path / "%d.exr", **COMMON | {"fps": 2})
    for number, path in enumerate(paths):
        own = eclat.render(scene.at(number / 2), "path", size=(24, 16), samples=2)
        np.testing.assert_array_equal(Image.load(path).pixels, own.pixels)
    layers = Image.load(paths[0]).layers
    card = layers["object_id"] == 1
    # The card moves by 1 m in half a second, and a pixel is a quarter of a metre.
    np.testing.assert_allclose(layers["motion_next"][card], np.full((card.sum(), 3), (4, 0, 0)), atol=1e-4)
    assert Image.load(paths[0]).metadata["objects"] == ["card"]


def test_a_moving_scene_is_solved_for_each_frame_where_records_do_not_live_over_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    box = eclat.load("cornell-box")
    corners = box.meshes[0].positions

    def pose(at: float) -> Pose:
        return Pose({0: replace(box.meshes[0], positions=corners + np.array([0, 0, 0.01 * at]))})

    scene = replace(box, animation=Motion(Pose({0: box.meshes[0]}), pose, 0.0, 1.0, ("wall",)))
    solves = counted_solves(monkeypatch)
    method = eclat.IrradianceCache(far_photons=2000, max_error=0.1)
    eclat.animate(scene, method, frames=range(2), output=tmp_path / "%d.png", **COMMON)
    assert solves == [1, 1]


def test_motion_blur_is_the_mean_over_the_time_of_the_shutter(tmp_path: Path) -> None:
    """The card slides by 2 m in 1 s. With one frame a second, open half the time, it slides from 0.5 to 1.5 m around the
    frame at 0.5 s. Where x is between its left edge, −0.5 + s, and its right edge, 0.5 + s, it is seen.
    """
    scene = sliding()
    moments = 16
    path = eclat.animate(
        scene, "path", frames=[1], fps=2, output=tmp_path / "%d.exr", size=(24, 16), samples=moments, shutter=1.0,
        moments=moments,
    )[0]  # fmt: skip
    image = Image.load(path)
    row = image.pixels[8, :, 0]
    x = (np.arange(24) + 0.5 - 12) / 4
    s = 2 * (0.25 + (np.arange(4000) + 0.5) / 4000 * 0.5)
    expected = [np.mean((-0.5 + s < at) & (at < 0.5 + s)) for at in x]
    # 16 moments of 1/16 m each, and one random place in a pixel of 1/4 m for each.
    np.testing.assert_allclose(row, expected, atol=0.2)
    assert row.sum() == pytest.approx(4, abs=0.4)
    assert image.metadata["moments"] == moments
    assert image.metadata["statistics"]["samples"] == moments


def test_kept_caches_are_read_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given: dict[str, Any] = {"frames": range(2), "output": tmp_path / "%d.png", "keep_cache": True, **COMMON}
    eclat.animate(walk(), **given)
    before = files(tmp_path)
    assert len(list(tmp_path.glob("path-*.npz"))) == 1
    (tmp_path / "1.png").unlink()
    monkeypatch.setattr(_core, "solve_for_cameras", lambda *_: pytest.fail("solved again"))
    eclat.animate(walk(), **given)
    assert files(tmp_path) == before


def test_records_of_things_that_move_are_kept_and_read_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given: dict[str, Any] = {"frames": range(3), "output": tmp_path / "%d.png", "keep_cache": True, **COMMON}
    method = eclat.RadianceCache(max_error=0.3, far_records=50, order=4)
    eclat.animate(sliding_in_the_box(), method, **given)
    before = files(tmp_path)
    (kept,) = tmp_path.glob("times-*.npz")
    (tmp_path / "1.png").unlink()
    with monkeypatch.context() as patched:
        for name in ("renew_records", "renew_radiance", "records_in_use", "GrowingCache"):
            patched.setattr(_core, name, lambda *_: pytest.fail("gathered again"))
        eclat.animate(sliding_in_the_box(), method, **given)
    assert files(tmp_path) == before
    (tmp_path / "1.png").unlink()
    kept.write_bytes(kept.read_bytes()[:1000])
    with pytest.raises(EclatError, match="damaged"):
        eclat.animate(sliding_in_the_box(), method, **given)


@pytest.mark.parametrize("kills", [5, pytest.param(100, marks=pytest.mark.full)])
def test_kills_leave_no_half_frame_and_the_restart_ends_with_the_same_files(kills: int, tmp_path: Path) -> None:
    (tmp_path / "walk.json").write_text(str(WALK).replace("'", '"'))

    def command(folder: str) -> list[str]:
        given = ["--frames", "0:11", "--fps", "12", "--size", "24x16", "--samples", "2", "--method", "path", "-q"]
        start = [sys.executable, "-m", "eclat", "animate", "cornell-box", "--camera-path", str(tmp_path / "walk.json")]
        return [*start, *given, "-o", str(tmp_path / folder / "%02d.exr")]

    begun = time.monotonic()
    subprocess.run(command("whole"), check=True)
    seconds = time.monotonic() - begun
    whole = files(tmp_path / "whole")
    rng = random.Random(1)
    killed = 0
    while killed < kills:
        running = subprocess.Popen(command("killed"))
        try:
            running.wait(rng.uniform(0.1, 1.0) * seconds)
        except subprocess.TimeoutExpired:
            os.kill(running.pid, signal.SIGKILL)
            killed += 1
        running.wait()
        there = sorted((tmp_path / "killed").glob("*.exr"))
        for path in there:
            assert path.read_bytes() == whole[path.name]
        for path in there[::2] if len(there) > 8 else []:
            path.unlink()  # so that there is something to do for the next one
    subprocess.run(command("killed"), check=True)
    assert {name: data for name, data in files(tmp_path / "killed").items() if not name.startswith(".")} == whole


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"frames": []}, "frames: expected 1 to"),
        ({"output": "a.png"}, "one %d"),
        ({"shutter": 1.5}, "shutter: expected a part"),
        ({"shutter": float("nan")}, "shutter: expected a part"),
        ({"moments": 0}, "moments: expected 1 to"),
        ({"camera": 7}, "camera: expected an index below 2"),
        ({"shard": (3, 2)}, "shard"),
        ({"tone_mapping": "loud"}, "tone"),
        ({"max_error": 2.0}, "max_error"),
    ],
)
def test_mistakes_are_named(wrong: dict[str, Any], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(EclatError, match=words):
        eclat.animate(walk(), "path", **{"frames": range(2), "output": "%d.png", **COMMON, **wrong})
    assert not list(tmp_path.glob("*.png"))


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    Path("walk.json").write_text(str(WALK).replace("'", '"'))
    common = ["animate", "cornell-box", "--camera-path", "walk.json", "--fps", "4", "--size", "16x12", "--samples", "1"]
    assert main([*common, "--method", "path", "--frames", "0:4:2", "-o", "f/%d.png", "--exposure", "auto"]) == 0
    assert "f/0.png to f/4.png: 3 frames" in capsys.readouterr().out
    assert sorted(path.name for path in Path("f").iterdir()) == ["0.png", "2.png", "4.png"]
    assert main([*common, "--method", "path", "--frames", "0:4:2", "-o", "f/%d.png", "--exposure", "auto"]) == 0
    assert "3 of them kept" in capsys.readouterr().out
    assert main([*common, "--frames", "4:0"]) == 2
    assert "--frames: expected frames FIRST:LAST" in capsys.readouterr().err


def test_the_frames_of_a_video_are_kept_beside_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = tmp_path / "bin" / "ffmpeg"
    program.parent.mkdir()
    program.write_text(f"#!{sys.executable}\nimport sys\nopen(sys.argv[-1], 'wb').write(sys.stdin.buffer.read())\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}{os.pathsep}{os.environ['PATH']}")
    video = tmp_path / "walk.mp4"
    given: dict[str, Any] = {"frames": range(2), "output": video, **COMMON}
    eclat.animate(walk(), "path", **given, shard=(1, 2))
    assert not video.exists()
    paths = eclat.animate(walk(), "path", **given)
    assert [path.parent.name for path in paths] == ["walk.frames"] * 2
    assert video.read_bytes() == b"".join(path.read_bytes() for path in paths)
