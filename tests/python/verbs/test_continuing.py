# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Finished pictures go on: with the bits of one run, less error, and never with another scene or a damaged file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.cli import main
from eclat.images import denoiser
from eclat.scenes import build
from eclat.verbs.continuing import KEY

SIZE = (48, 40)
needs_denoiser = pytest.mark.skipif(not denoiser.has_denoiser(), reason="pyoidn is not installed")


@pytest.fixture(scope="module")
def cornell() -> eclat.Scene:
    return build("cornell-box")


def made(scene: eclat.Scene, what: Any, **keywords: Any) -> eclat.Image:
    return eclat.render(scene, what, **{"size": SIZE, "check": False, "denoise": False, **keywords})


@pytest.mark.parametrize(
    ("what", "keywords"),
    [
        (eclat.Path(), {"adaptive": True}),
        (eclat.Path(), {"halves": True, "filter": "tent", "seed": 5, "crop": (3, 2, 40, 30)}),
        pytest.param(eclat.Path(), {"denoise": True, "adaptive": True, "check": True}, marks=needs_denoiser),
        (eclat.IrradianceCache(max_error=0.2), {"halves": True}),
        (eclat.PhotonMap(photons=2000, caustic_photons=1000, progressive=True), {"max_depth": 5}),
    ],
)
def test_four_samples_continued_by_twelve_equal_sixteen(
    cornell: eclat.Scene, tmp_path: Path, what: Any, keywords: Any
) -> None:
    path = tmp_path / "four.exr"
    made(cornell, what, samples=4, continuable=True, **keywords).save(path)
    again = {name: keywords[name] for name in ("denoise", "check") if name in keywords}
    longer = eclat.render(cornell, what, continued=path, samples=16, **{"denoise": False, "check": False, **again})
    once = made(cornell, what, samples=16, continuable=True, **keywords)
    np.testing.assert_array_equal(longer.pixels, once.pixels)
    assert longer.layers.keys() == once.layers.keys()
    for name, layer in once.layers.items():
        np.testing.assert_array_equal(longer.layers[name], layer)
    assert longer.metadata[KEY] == once.metadata[KEY]
    for name in ("samples", "noise_left", "estimated_error"):
        assert longer.metadata["statistics"].get(name) == once.metadata["statistics"].get(name)


@needs_denoiser
def test_a_smaller_error_is_reached(cornell: eclat.Scene) -> None:
    today = eclat.render(cornell, eclat.Path(), size=SIZE, max_error=0.2, continuable=True)
    tomorrow = eclat.render(cornell, eclat.Path(), continued=today, max_error=0.08)
    before, after = (image.metadata["statistics"] for image in (today, tomorrow))
    assert after["samples"] > before["samples"] and after["noise_left"] <= 0.08 < before["noise_left"]


def test_finer_records_serve_new_samples(cornell: eclat.Scene) -> None:
    coarse = made(cornell, eclat.IrradianceCache(max_error=0.3), samples=4, continuable=True)
    fine = eclat.render(cornell, eclat.IrradianceCache(max_error=0.03), continued=coarse, samples=32, denoise=False)
    assert fine.metadata["options"]["max_error"] == 0.03
    assert fine.metadata["statistics"]["records"] > coarse.metadata["statistics"]["records"]


def test_pictures_that_cannot_be_continued_are_refused(cornell: eclat.Scene, tmp_path: Path) -> None:
    image = made(cornell, eclat.Path(), samples=2, continuable=True)
    plain = made(cornell, eclat.Path(), samples=2)

    def refused(message: str, continued: Any = image, scene: Any = cornell, what: Any = None, **keywords: Any) -> None:
        with pytest.raises(eclat.EclatError, match=message):
            eclat.render(
                scene, what or eclat.Path(), continued=continued, **{"samples": 4, "denoise": False, **keywords}
            )

    refused("without the samples of each pixel; render it with --continuable", continued=plain)
    lamp = eclat.scene.PointLight((0.5, 0.5, 0.5), (1.0,) * 3)
    refused("expected a picture of the same scene", scene=replace(cornell, lights=(lamp,)))
    refused("lens of the camera, got another", camera=replace(cornell.cameras[0], fov=20.0))
    refused("expected the method path, got direct", what=eclat.Direct())
    refused("expected more than the 2 that continued has, got 2", samples=2)
    refused("seed cannot change when a picture is continued, expected 0, got 3", seed=3)
    refused("size cannot change", size=(8, 8))
    for name in ("sums_0_03", "sums_0_07"):
        damaged = {**image.layers, name: image.layers[name] + np.float32(1e-3)}
        refused("got damaged ones", continued=replace(image, layers=damaged))
        missing = {other: layer for other, layer in image.layers.items() if other != name}
        refused("got damaged ones", continued=replace(image, layers=missing))
    newer = replace(image, metadata={**image.metadata, KEY: {**image.metadata[KEY], "format": 99}})
    refused("expected a continuable picture of format 1, got 99", continued=newer)
    file = tmp_path / "cut.exr"
    image.save(file)
    file.write_bytes(file.read_bytes()[:-100])
    refused("cut.exr", continued=file)
    refused("gone.exr", continued=tmp_path / "gone.exr")


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    file = str(tmp_path / "box.exr")
    render = ["render", "cornell-box", "--no-check", "--no-denoise"]
    fixed = ["--size", "24x20", "--method", "path", "--seed", "3"]
    assert main([*render, *fixed, "--samples", "4", "--continuable", "-o", file]) == 0
    first = Path(file).read_bytes()

    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("eclat.verbs.picture._core.render", interrupted)
        assert main([*render, "--continue", file]) != 0
    assert Path(file).read_bytes() == first
    assert main([*render, "--continue", file, "--samples", "16"]) == 0
    once = eclat.render("cornell-box", eclat.Path(), samples=16, seed=3, size=(24, 20), denoise=False)
    np.testing.assert_array_equal(eclat.Image.load(file).pixels, once.pixels)
    assert main([*render, "--continue", file, "--samples", "32"]) == 0  # what was continued can be continued
    capsys.readouterr()
    for flags, message in (
        (["--continue", file, "--seed", "4"], "--continue cannot be combined with --seed"),
        (["--continue", file, "--keep-partial"], "--continue cannot be combined with --keep-partial"),
        (["--continuable", "-o", str(tmp_path / "box.png")], "expected an .exr file"),
    ):
        assert main([*render, *flags]) == 2
        assert message in capsys.readouterr().err


def test_bad_samples_are_not_forgotten(cornell: eclat.Scene) -> None:
    image = made(cornell, eclat.Path(), samples=2, continuable=True)
    image.metadata["bad_samples"] = {"count": 3, "first": [1, 2, 0]}
    longer = eclat.render(cornell, eclat.Path(), continued=image, samples=4, denoise=False)
    assert longer.metadata["bad_samples"] == {"count": 3, "first": [1, 2, 0]}
