# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Where samples go: against noise of known size, and against long references where a lamp's edge cuts pixels."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.sampling.adaptive_sampling import FASTEST_GROWTH, AdaptiveSamples
from eclat.scenes import build

WHOLE = (0, 0, 48, 48)


class Noise:
    """A grey picture whose samples have a known standard deviation in each pixel."""

    def __init__(self, deviation: np.ndarray, seed: int) -> None:
        self.deviation, self.random = deviation[..., None], np.random.default_rng(seed)
        self.taken = np.zeros(deviation.shape, dtype=np.uint32)
        self.sum = np.zeros((*deviation.shape, 3))

    def take(self, counts: np.ndarray) -> np.ndarray:
        added = (counts - self.taken)[..., None]
        # One channel's noise in all three, as light has it.
        noise = self.random.standard_normal((*counts.shape, 1)) * np.sqrt(added) * self.deviation
        self.sum += added * 0.5 + noise
        self.taken = counts
        return self.sum / np.maximum(counts, 1)[..., None]


def test_samples_are_proportional_to_the_deviation() -> None:
    """Neyman's allocation: three times as noisy, three times the samples, whatever the pass; the sum is kept to."""
    deviation = np.where(np.arange(48) < 24, 0.1, 0.3) * np.ones((48, 1))
    noise, pixels = Noise(deviation, 5), AdaptiveSamples((48, 48), WHOLE)
    for samples in (2, 4, 8, 16, 32, 64, 128):
        counts = pixels.unevenly(samples)
        assert (counts >= pixels.counts).all()
        assert counts.mean() == pytest.approx(samples, rel=0.1)
        if samples > 4:
            assert (counts <= FASTEST_GROWTH * pixels.counts).all()
        pixels.observe(counts, noise.take(counts))
    quiet, noisy = counts[:, :21].mean(), counts[:, 27:].mean()
    assert noisy / quiet == pytest.approx(3, rel=0.1)
    # √(mean of v / n) relative to 0.5² + c · 0.5², known here: the estimate's own spread is 2 %.
    expected = np.sqrt((deviation**2 / counts).mean() / (0.25 * 1.01))
    assert pixels.noise() == pytest.approx(expected, rel=0.08)


def test_samples_are_proportional_to_what_a_denoiser_leaves() -> None:
    """Noise that is the same everywhere, of which the denoiser leaves a third in one half of the picture."""
    left = np.where(np.arange(48) < 24, 1 / 3, 1.0) * np.ones((48, 1))
    noise, pixels = Noise(np.full((48, 48), 0.2), 5), AdaptiveSamples((48, 48), WHOLE)
    for samples in (2, 4, 8, 16, 32, 64, 128):
        counts = pixels.unevenly(samples, left)
        assert counts.mean() == pytest.approx(samples, rel=0.1)
        pixels.observe(counts, noise.take(counts))
    assert counts[:, 24:].mean() / counts[:, :24].mean() == pytest.approx(3, rel=0.1)


def test_only_the_region_is_sampled() -> None:
    pixels, noise = AdaptiveSamples((48, 48), (8, 4, 20, 30)), Noise(np.full((48, 48), 0.2), 6)
    for samples in (2, 4, 8):
        counts = pixels.unevenly(samples)
        pixels.observe(counts, noise.take(counts))
    outside = counts.copy()
    outside[4:30, 8:20] = 0
    assert not outside.any() and counts[4:30, 8:20].min() > 0


def test_black_pictures_are_sampled_evenly() -> None:
    pixels = AdaptiveSamples((8, 8), (0, 0, 8, 8))
    for samples in (2, 4, 8, 11):
        counts = pixels.unevenly(samples)
        pixels.observe(counts, np.zeros((8, 8, 3)))
    assert (counts == 11).all() and pixels.noise() == 0


def test_light_that_is_first_found_late_gives_finite_pixels() -> None:
    """All black, then a spark: nothing is known of the scale before."""
    pixels, spark = AdaptiveSamples((8, 8), (0, 0, 8, 8)), np.zeros((8, 8, 3))
    pixels.observe(pixels.unevenly(2), spark)
    spark[3, 3] = 1e-3
    pixels.observe(pixels.unevenly(4), spark)
    counts = pixels.unevenly(8)
    assert np.isfinite(pixels.noise()) and counts.min() >= 4 and counts[3, 2] == counts[2, 4] == counts.max()


@pytest.mark.parametrize(("share", "samples", "loss"), [(0.1, 16, 0.03), (0.01, 64, 0.08), (0.01, 16, 0.25)])
def test_light_that_few_samples_find_keeps_its_brightness(share: float, samples: int, loss: float) -> None:
    """A share of the samples finds all light. Pixels that asked for samples by what they had found themselves were 8 % too
    bright, 13 % too dark and half as bright. What is left comes by way of neighbours."""
    random, means = np.random.default_rng(7), []
    for _ in range(20):
        pixels, hits = AdaptiveSamples((48, 48), WHOLE), np.zeros((48, 48))
        for number in (2, 4, 8, 16, 32, 64):
            if number > samples:
                break
            counts = pixels.unevenly(number)
            hits += random.binomial(counts - pixels.counts, share)
            pixels.observe(counts, (hits / counts)[..., None] * np.full(3, 1 / share))
        means.append((hits / counts).mean() / share)
    assert np.mean(means) == pytest.approx(1, abs=loss)


@pytest.fixture(scope="module")
def box() -> tuple[eclat.Scene, eclat.Solution]:
    scene = build("cornell-box")
    return scene, eclat.solve(scene, eclat.IrradianceCache(max_error=0.05), size=(96, 96), check=False)


def picture(box: tuple[eclat.Scene, eclat.Solution], adaptive: bool, seed: int) -> eclat.Image:
    scene, solution = box
    return eclat.render(scene, solution, samples=16, adaptive=adaptive, seed=seed, size=(96, 96))


def test_adaptive_sampling_finds_the_edge_of_the_lamp_and_its_noise(box: tuple[eclat.Scene, eclat.Solution]) -> None:
    """The lamp's edge cuts slivers off a row of pixels. Against a long picture from the same cache as many samples err by
    seven tenths of what even ones do, since soft shadows are noisy too."""
    scene, solution = box
    truth = eclat.render(scene, solution, samples=512, adaptive=True, seed=99, size=(96, 96)).pixels
    scale = truth**2 + 0.01 * (truth**2).mean()
    errors, told = {}, []
    for adaptive in (False, True):
        images = [picture(box, adaptive, seed) for seed in range(4)]
        errors[adaptive] = np.sqrt(np.mean([((i.pixels - truth) ** 2 / scale).mean() for i in images]))
        told = [i.metadata["statistics"]["noise"] for i in images]
        # No light is lost or won by choosing: measured 5e-4.
        assert np.mean([i.pixels.mean() for i in images]) == pytest.approx(truth.mean(), rel=2e-3)
    assert errors[True] < 0.8 * errors[False]
    assert np.mean(told) == pytest.approx(errors[True], rel=0.35)


def test_a_timed_picture_is_reproduced_by_its_number_of_samples(box: tuple[eclat.Scene, eclat.Solution]) -> None:
    scene, solution = box
    timed = eclat.render(scene, solution, time=0.3, size=(96, 96), denoise=False)
    assert timed.metadata["adaptive"] == "noise"
    samples = int(timed.metadata["statistics"]["samples"])
    again = eclat.render(scene, solution, samples=samples, adaptive=True, size=(96, 96), threads=1)
    np.testing.assert_array_equal(again.pixels, timed.pixels)


@pytest.mark.parametrize("samples", [1, 2, 3, 5])
def test_few_samples_are_as_many_as_were_asked_for(box: tuple[eclat.Scene, eclat.Solution], samples: int) -> None:
    scene, solution = box
    image = eclat.render(scene, solution, samples=samples, adaptive=True, size=(96, 96))
    assert image.metadata["statistics"]["samples"] == samples and np.isfinite(image.pixels).all()


def test_a_picture_that_is_kept_in_slices_has_the_same_bits(box: tuple[eclat.Scene, eclat.Solution]) -> None:
    scene, solution = box
    sliced = eclat.render(scene, solution, samples=13, adaptive=True, size=(96, 96), keep_partial=True)
    np.testing.assert_array_equal(
        sliced.pixels, eclat.render(scene, solution, samples=13, adaptive=True, size=(96, 96)).pixels
    )
