# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Frames with the samples of the frames around them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError
from eclat.frames.accumulated import with_samples_of
from eclat.images.denoiser import has_denoiser
from eclat.images.image import Image

H, W = 12, 16
REST = np.zeros((H, W, 3), np.float32)


def frame(seed: int, **layers: np.ndarray) -> Image:
    """A frame of a plane, with noise around 1."""
    pixels = np.random.default_rng(seed).uniform(0.5, 1.5, (H, W, 3)).astype(np.float32)
    normals = np.broadcast_to(np.array([0, 0, 1], np.float32), (H, W, 3))
    guides = {"normal": normals, "depth": np.full((H, W), 2, np.float32)}
    return Image(pixels, guides | layers, {"statistics": {}})


def test_away_from_edges_the_noise_is_that_of_all_samples() -> None:
    objects = np.ones((H, W), np.float32)
    objects[:, W // 2 :] = 2
    frames = [frame(seed) for seed in range(5)]
    found = with_samples_of(frames[2], objects, [(frames[k], objects, REST) for k in (0, 1, 3, 4)], 2)
    mean = np.mean([f.pixels for f in frames], axis=0)
    at_edges = np.abs(np.arange(W) - (W / 2 - 0.5)) < 1
    np.testing.assert_allclose(found.pixels[:, ~at_edges], mean[:, ~at_edges], rtol=1e-6)
    np.testing.assert_array_equal(found.pixels[:, at_edges], frames[2].pixels[:, at_edges])
    assert found.metadata["accumulated"] == 2


def test_a_denoised_frame_is_denoised_again() -> None:
    if not has_denoiser():
        pytest.skip("needs Open Image Denoise")
    objects = np.ones((H, W), np.float32)
    weight, white = np.full((H, W), 0.5, np.float32), np.ones((H, W, 3), np.float32)
    normals = np.broadcast_to(np.array([0, 0, 1], np.float32), (H, W, 3))
    layers = {"denoiser_weight": weight, "rough_albedo": white, "rough_normal": normals}
    frames = [frame(seed, noisy=frame(10 + seed).pixels, **layers) for seed in range(3)]
    found = with_samples_of(frames[1], objects, [(frames[0], objects, REST), (frames[2], objects, REST)], 1)
    mean = np.mean([f.layers["noisy"] for f in frames], axis=0)
    np.testing.assert_allclose(found.layers["noisy"], mean, rtol=1e-6)
    # Half of the denoiser's picture, which is nearly even, and half of the samples.
    assert np.std(found.pixels) == pytest.approx(0.5 * np.std(mean), rel=0.2)


def test_frames_are_the_same_files_in_any_order_and_have_less_noise(tmp_path: Path) -> None:
    path = {"keys": [{"time": 0, "from": [0, 1, 3.4], "to": [0, 1, 0]}, {"time": 1, "from": [0.6, 1, 3.4]}]}
    scene = eclat.with_camera_path(eclat.load("cornell-box"), path)
    given: dict[str, Any] = {"frames": range(4), "fps": 4, "size": (64, 48), "samples": 4, "threads": 2}
    given |= {"adaptive": False, "denoise": False}

    def frames(name: str, **more: Any) -> list[Path]:
        return eclat.animate(scene, "path", output=tmp_path / name / "%d.exr", **given | more)

    whole = frames("whole", accumulate=1)
    for shard in ((2, 2), (1, 2)):
        frames("shards", accumulate=1, shard=shard)
    for file in whole:
        assert file.read_bytes() == (tmp_path / "shards" / file.name).read_bytes()
    alone, exact = frames("alone"), frames("exact", samples=256)
    mean, one, truth = (Image.load(files[2]).pixels for files in (whole, alone, exact))
    # Pixels at edges and of the background stay as they are.
    changed = (mean != one).any(axis=2)
    assert changed.mean() > 0.1
    off = [np.median(np.abs(picture - truth).mean(axis=2)[changed]) for picture in (mean, one)]
    assert off[0] < 0.8 * off[1]
    with pytest.raises(EclatError, match="other settings"):
        frames("whole")


def test_the_number_of_frames_is_checked(tmp_path: Path) -> None:
    with pytest.raises(EclatError, match="accumulate: expected 0 to 16 frames, got 17"):
        eclat.animate("cornell-box", frames=range(1), output=tmp_path / "%d.exr", accumulate=17)
