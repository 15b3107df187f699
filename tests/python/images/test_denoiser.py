# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Open Image Denoise behind our door: it takes out noise, keeps edges that the guides show, and says when it is absent."""

from __future__ import annotations

import importlib

import numpy as np
import pytest
from scipy.ndimage import binary_dilation

from eclat.errors import EclatError
from eclat.images import denoiser

needs_denoiser = pytest.mark.skipif(not denoiser.has_denoiser(), reason="pyoidn is not installed")


@pytest.fixture
def noisy() -> tuple[np.ndarray, np.ndarray]:
    """A picture of two halves, 1 and 0.2, and the same with much noise."""
    truth = np.full((64, 64, 3), 1.0, np.float32)
    truth[:, 32:] = 0.2
    noise = np.random.default_rng(1).exponential(size=truth.shape).astype(np.float32)
    return truth, truth * noise


@needs_denoiser
def test_the_denoiser_removes_noise_and_keeps_edges(noisy: tuple[np.ndarray, np.ndarray]) -> None:
    truth, samples = noisy
    clean = denoiser.denoise(samples, albedo=truth, normal=np.zeros_like(truth))
    assert clean.dtype == np.float32 and clean.shape == truth.shape
    assert np.abs(clean - truth).mean() < 0.15 * np.abs(samples - truth).mean()
    assert clean[:, 31].mean() > 3 * clean[:, 32].mean()


@needs_denoiser
def test_a_lamp_stays_within_its_edge() -> None:
    """A lamp of some pixels before a wall: Open Image Denoise alone makes the wall beside it much too bright."""
    lamp = np.zeros((64, 64), bool)
    lamp[30:33, 20:24] = True
    beside = binary_dilation(lamp, structure=np.ones((3, 3))) & ~lamp
    wall = np.random.default_rng(3).gamma(8, 1 / 8, (64, 64, 1)).astype(np.float32) * np.ones(3, np.float32)
    samples = np.where(lamp[..., None], np.float32(3000), wall)
    oidn = importlib.import_module(denoiser.PACKAGE)
    assert oidn.denoise(samples, hdr=True, quality="high")[beside].mean() > 4
    clean = denoiser.denoise(samples)
    assert 0.5 < clean[beside].mean() < 2.5
    assert clean[lamp].mean() > 2000


def test_only_pixels_beside_what_is_far_brighter_are_limited() -> None:
    samples = np.full((5, 5, 3), 1.0)
    denoised = np.full((5, 5, 3), 3.0)
    denoised[2, 2] = 29  # 3 is more than a tenth of it
    assert np.array_equal(denoiser.within_edges(samples, denoised), denoised)
    denoised[2, 2] = 31
    samples[1, 1] = 1.4  # its own sample counts, because it is above the median
    expected = denoised.copy()
    expected[1:4, 1:4] = 2
    expected[1, 1], expected[2, 2] = 2.8, 31
    np.testing.assert_allclose(denoiser.within_edges(samples, denoised), expected)


@needs_denoiser
def test_same_input_same_bits(noisy: tuple[np.ndarray, np.ndarray]) -> None:
    _, samples = noisy
    assert np.array_equal(denoiser.denoise(samples), denoiser.denoise(samples))


@needs_denoiser
def test_pixels_that_are_not_finite_count_as_black(noisy: tuple[np.ndarray, np.ndarray]) -> None:
    _, samples = noisy
    samples[3, 3] = np.nan
    samples[9, 9] = np.inf
    assert np.isfinite(denoiser.denoise(samples)).all()


@needs_denoiser
def test_light_maps_have_a_network_of_their_own(noisy: tuple[np.ndarray, np.ndarray]) -> None:
    truth, samples = noisy
    clean = denoiser.denoise(samples, kind="lightmap")
    assert np.abs(clean - truth).mean() < 0.3 * np.abs(samples - truth).mean()
    assert not np.array_equal(clean, denoiser.denoise(samples))
    with pytest.raises(EclatError, match="expected neither albedo nor normals for a light map"):
        denoiser.denoise(samples, albedo=truth, kind="lightmap")


@needs_denoiser
def test_shapes_must_agree(noisy: tuple[np.ndarray, np.ndarray]) -> None:
    _, samples = noisy
    with pytest.raises(EclatError, match="expected an array albedo of the shape"):
        denoiser.denoise(samples, albedo=samples[:32])


def test_without_the_package_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(denoiser, "PACKAGE", "no_such_denoiser")
    with pytest.raises(EclatError, match="pip install no_such_denoiser"):
        denoiser.denoise(np.ones((2, 2, 3)))
