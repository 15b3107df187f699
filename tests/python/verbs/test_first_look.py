# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures that are shown while the real one is being made: they come early, get better, and change no bits."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.cli import main
from eclat.scenes import build

SIZE = (64, 48)
looking = importlib.import_module("eclat.verbs.first_look")
rendering = importlib.import_module("eclat.verbs.render")
previews = importlib.import_module("eclat.verbs.previews")


@pytest.fixture(scope="module")
def cornell() -> eclat.Scene:
    return build("cornell-box")


def test_a_first_look_is_small_and_like_the_picture(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(looking, "PIXELS", 600)
    assert looking._small((64, 48)) == (28, 21) and looking._small((20, 10)) == (20, 10)
    assert looking._small((60000, 1))[1] == 1
    seen: list[eclat.Image] = []
    image = eclat.render(cornell, eclat.IrradianceCache(max_error=0.2), samples=2, size=SIZE, preview=seen.append)
    first = seen[0]
    assert first.metadata["unfinished"] and first.pixels.shape == image.pixels.shape
    blocks = [p.pixels.reshape(4, 12, 4, 16, 3).mean(axis=(1, 3)) for p in (first, image)]
    # Two samples of path tracing, of a lamp that few pixels see.
    assert np.median(np.abs(blocks[0] - blocks[1]) / blocks[1]) < 0.35


def test_a_second_look_of_all_pixels_is_denoised_and_states_its_error(
    cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyoidn")
    monkeypatch.setattr(looking, "PIXELS", 600)
    monkeypatch.setattr(previews, "PREVIEW_SECONDS", 1e9)
    seen: list[eclat.Image] = []
    method, size = eclat.IrradianceCache(max_error=0.3), (64, 48)
    image = eclat.render(cornell, method, max_error=0.3, size=size, preview=seen.append)
    second = seen[1]
    assert second.metadata["unfinished"] and second.metadata["denoised"] and second.metadata["samples_done"] == 2
    error = float(np.sqrt((((second.pixels - image.pixels) / (0.1 * image.pixels.max() + image.pixels)) ** 2).mean()))
    assert 0 < second.metadata["statistics"]["estimated_error"] < 1 and error < 0.5
    np.testing.assert_array_equal(image.pixels, eclat.render(cornell, method, max_error=0.3, size=size).pixels)
    # Small pictures, methods that need no solve and solutions that are there already go on at once.
    for what, pixels in ((method, 1 << 20), (eclat.Path(), 600), (eclat.solve(cornell, method, size=size), 600)):
        monkeypatch.setattr(looking, "PIXELS", pixels)
        seen.clear()
        eclat.render(cornell, what, max_error=0.3, size=size, preview=seen.append)
        assert [shown.metadata["method"] for shown in seen[1:2]] != ["path"] or isinstance(what, eclat.Path)


def test_previews_get_better_and_change_nothing(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(previews, "PREVIEW_SECONDS", 0.0)
    seen: list[eclat.Image] = []
    shown = eclat.render(cornell, eclat.Path(), max_error=0.1, size=SIZE, preview=seen.append)
    plain = eclat.render(cornell, eclat.Path(), max_error=0.1, size=SIZE)
    np.testing.assert_array_equal(shown.pixels, plain.pixels)
    assert "unfinished" not in shown.metadata
    done = [image.metadata["samples_done"] for image in seen[1:]]
    assert done == sorted(set(done)) and len(done) >= 1 and done[-1] < shown.metadata["statistics"]["samples"]
    assert all(image.metadata["unfinished"] for image in seen)


def test_previews_keep_their_distance(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(previews, "PREVIEW_SECONDS", 1e9)
    seen: list[eclat.Image] = []
    eclat.render(cornell, eclat.Path(), max_error=0.1, size=SIZE, preview=seen.append)
    assert len(seen) == 2  # the first look, and one between passes


def test_the_output_file_holds_a_picture_before_the_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)

    def interrupted(*_: object, **__: object) -> None:
        assert Path("box.exr").exists()
        raise KeyboardInterrupt

    monkeypatch.setattr(rendering, "sampling_of", interrupted)
    command = ["render", "cornell-box", "--method", "path", "--size", "16x16", "-o", "box.exr"]
    assert main(command) == 130
    assert "box.exr: holds an unfinished picture" in capsys.readouterr().err
    assert eclat.Image.load("box.exr").metadata["unfinished"]
    assert [path.name for path in tmp_path.iterdir()] == ["box.exr"]
    # Where it is known what the picture takes, nothing is written before it is done.
    Path("box.exr").unlink()
    monkeypatch.setattr(rendering, "sampling_of", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
    assert main([*command, "--samples", "2"]) == 130
    assert not Path("box.exr").exists()
