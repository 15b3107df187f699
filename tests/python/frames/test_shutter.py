# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Motion blur as the mean of pictures."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.frames.shutter import mean_of, moments, samples_each, seed_of_moment
from eclat.images.image import Image


def test_moments_lie_around_the_frame() -> None:
    assert moments(2.0, 0.0, 4) == [2.0]
    assert moments(2.0, 0.4, 4) == pytest.approx([1.85, 1.95, 2.05, 2.15])


def test_samples_and_seeds() -> None:
    assert samples_each(None, 8) is None
    assert samples_each(20, 8) == 3
    assert seed_of_moment(7, 0, 1) == 7
    seeds = {seed_of_moment(7, k, 256) for k in range(256)}
    assert len(seeds) == 256


def test_the_mean_of_pictures() -> None:
    def picture(value: float) -> Image:
        pixels = np.full((2, 3, 3), value, np.float32)
        layers = {"direct": pixels * 2, "depth": pixels[..., 0]}
        return Image(pixels, layers, {"statistics": {"samples": 4.0, "estimated_error": value}})

    mean = mean_of([picture(1), picture(3), picture(5)])
    np.testing.assert_allclose(mean.pixels, 3)
    np.testing.assert_allclose(mean.layers["direct"], 6)
    np.testing.assert_allclose(mean.layers["depth"], 3)
    assert mean.metadata["statistics"]["samples"] == 12
    assert mean.metadata["statistics"]["estimated_error"] == pytest.approx((35 / 3) ** 0.5)
    assert mean.metadata["moments"] == 3
