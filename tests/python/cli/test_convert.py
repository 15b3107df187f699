# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`eclat convert`, as a user calls it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage

import eclat
from eclat.cli import main
from eclat.images.image import Image
from eclat.images.image_files import read_png_metadata

Output = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Image:
    monkeypatch.chdir(tmp_path)
    ramp = np.linspace(0, 2, 4 * 9 * 3, dtype=np.float32).reshape(4, 9, 3)
    image = Image(ramp, {"depth": ramp[..., 0] * 3, "direct": ramp / 2}, {"seed": 7})
    image.save("a.exr")
    return image


@pytest.mark.parametrize("suffix", [".exr", ".hdr", ".pfm", ".npy"])
def test_radiance_goes_from_each_format_to_each(picture: Image, suffix: str) -> None:
    for target in (".exr", ".hdr", ".pfm", ".npy"):
        assert main(["convert", "a.exr", f"b{suffix}"]) == 0
        assert main(["convert", f"b{suffix}", f"c{target}"]) == 0
        read = Image.load(f"c{target}").pixels
        if ".hdr" in (suffix, target):
            assert np.abs(read - picture.pixels).max() <= 2 / 128
        else:
            assert np.array_equal(read, picture.pixels)


def test_exr_to_exr_keeps_layers_and_metadata(picture: Image) -> None:
    assert main(["convert", "a.exr", "b.exr"]) == 0
    read = Image.load("b.exr")
    assert set(read.layers) == {"depth", "direct"}
    assert read.metadata["seed"] == 7


def test_png_has_exposure_and_tone_mapping(picture: Image, capsys: Output) -> None:
    picture.save("wanted.png", 1.5, "filmic")
    assert main(["convert", "a.exr", "b.png", "--exposure", "1.5", "--tone-mapping", "filmic"]) == 0
    assert capsys.readouterr().out == "b.png: 9x4, exposure +1.5 stops\n"
    assert np.array_equal(PillowImage.open("b.png"), PillowImage.open("wanted.png"))
    assert read_png_metadata("b.png")["seed"] == 7
    picture.save("auto.png", "auto")
    assert main(["convert", "a.exr", "c.png", "--exposure", "auto"]) == 0
    assert np.array_equal(PillowImage.open("c.png"), PillowImage.open("auto.png"))


def test_layers_become_pictures(picture: Image) -> None:
    assert main(["convert", "a.exr", "d.exr", "--layer", "direct"]) == 0
    assert np.array_equal(Image.load("d.exr").pixels, picture.layers["direct"])
    assert main(["convert", "a.exr", "z.npy", "--layer", "depth"]) == 0
    assert np.array_equal(np.load("z.npy")[..., 2], picture.layers["depth"])


def test_a_scene_becomes_a_glb_that_holds_it(capsys: Output) -> None:
    assert main(["convert", "cornell-box", "box.glb"]) == 0
    assert "meshes" in capsys.readouterr().out
    scene, read = eclat.load("cornell-box"), eclat.load("box.glb")
    assert sum(len(m.triangles) for m in read.meshes) == sum(len(m.triangles) for m in scene.meshes)
    assert len(read.cameras) == len(scene.cameras)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            "a.exr b.tiff",
            "OUTPUT: b.tiff: expected one of the suffixes .exr, .png, .hdr, .pfm, .npy, .glb, got '.tiff'",
        ),
        ("a.exr b", "got a name without a suffix"),
        ("a.exr b.exr --exposure 1", "--exposure: b.exr has none, only .png files have it"),
        ("a.exr b.hdr --tone-mapping filmic", "--tone-mapping: b.hdr has none, only .png files have it"),
        ("cornell-box b.glb --layer depth", "--layer: b.glb has none, only pictures have it"),
        ("a.exr b.png --root .", "--root: b.png has none, only scenes have it"),
        (
            "a.exr b.png --layer dept",
            "--layer: a.exr: expected one of depth, direct, got 'dept'; did you mean 'depth'?",
        ),
        ("none.exr b.png", "none.exr"),
        ("a.exr none/b.png", "none/b.png"),
    ],
)
def test_mistakes_are_named(arguments: str, message: str, capsys: Output) -> None:
    assert main(["convert", *arguments.split()]) == 2
    assert message in capsys.readouterr().err
