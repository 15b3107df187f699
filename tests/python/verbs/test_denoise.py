# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Finished pictures without their noise: less error than before, and two pictures that tell how much is left."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.cli import main
from eclat.images import denoiser
from eclat.measure.metrics import relative_rmse

pytestmark = pytest.mark.skipif(not denoiser.has_denoiser(), reason="pyoidn is not installed")


@pytest.fixture(scope="module")
def box() -> tuple[eclat.Image, eclat.Image, np.ndarray]:
    """Two noisy pictures of the Cornell box, and a much better one."""
    scene = eclat.load("cornell-box")
    a, b, truth = (
        eclat.render(scene, eclat.Path(), samples=samples, seed=seed, size=(128, 128))
        for samples, seed in ((8, 1), (8, 2), (1024, 3))
    )
    return a, b, truth.pixels


def test_one_picture(box: tuple[eclat.Image, eclat.Image, np.ndarray]) -> None:
    a, _, truth = box
    clean = eclat.denoise(a)
    assert relative_rmse(clean.pixels, truth, truth) < 0.5 * relative_rmse(a.pixels, truth, truth)
    assert np.array_equal(clean.layers["noisy"], a.pixels) and clean.metadata["denoised"] is True


def test_two_pictures_measure_the_error_that_remains(box: tuple[eclat.Image, eclat.Image, np.ndarray]) -> None:
    a, b, truth = box
    clean = eclat.denoise(a, b)
    found, statistics = relative_rmse(clean.pixels, truth, truth), clean.metadata["statistics"]
    before = relative_rmse((a.pixels + b.pixels) / 2, truth, truth)
    assert found < 0.5 * before
    assert statistics["noise_before"] == pytest.approx(before, rel=0.15)
    # The truth has noise of its own, about a tenth of `before`.
    assert 0.7 * statistics["estimated_error_low"] < found < 1.3 * statistics["estimated_error_high"]
    assert statistics["estimated_error"] < 0.6 * before


def test_halves_that_cannot_be_compared_are_refused(box: tuple[eclat.Image, eclat.Image, np.ndarray]) -> None:
    a, b, _ = box
    with pytest.raises(eclat.EclatError, match="same picture twice"):
        eclat.denoise(a, a)
    with pytest.raises(eclat.EclatError, match="two pictures of the same size, got 128x128 and 64x128"):
        eclat.denoise(a, eclat.Image(b.pixels[:, :64]))


def test_the_command(
    box: tuple[eclat.Image, eclat.Image, np.ndarray], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, image in zip("ab", box, strict=False):
        image.save(tmp_path / f"{name}.exr")
    assert main(["denoise", str(tmp_path / "a.exr")]) == 0
    alone = eclat.Image.load(tmp_path / "a_denoised.exr")
    np.testing.assert_array_equal(alone.pixels, eclat.denoise(box[0]).pixels)
    out = tmp_path / "both.exr"
    capsys.readouterr()
    assert main(["denoise", str(tmp_path / "a.exr"), str(tmp_path / "b.exr"), "-o", str(out)]) == 0
    assert "estimated error" in capsys.readouterr().out
    assert json.loads(json.dumps(eclat.Image.load(out).metadata["statistics"]))["estimated_error"] > 0
    assert main(["denoise", *[str(tmp_path / "a.exr")] * 3]) == 2
    assert main(["denoise", str(tmp_path / "gone.exr")]) == 2


def test_without_the_package_the_command_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(denoiser, "PACKAGE", "no_such_denoiser")
    assert main(["denoise", "a.exr"]) == 2
    assert "pip install no_such_denoiser" in capsys.readouterr().err
