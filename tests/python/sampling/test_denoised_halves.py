# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The measured error of a denoised picture against its true one, with denoisers that are known to be bad in places."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import binary_dilation, median_filter, uniform_filter

from eclat.errors import EclatError
from eclat.images.denoiser import within_edges
from eclat.measure.metrics import RELATIVE_C
from eclat.sampling.denoised_halves import DenoisedHalves, JudgedPicture, judged_halves, sampled_halves, with_picture
from eclat.sampling.picture_probes import ProbedError, joined

SIZE = 128


def truth(checkered: bool) -> np.ndarray:
    """A smooth ramp; or one whose right half is a checkerboard of small squares, which a blur destroys."""
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    ramp = 0.5 + 0.4 * np.sin(x / 40.0) * np.cos(y / 30.0)
    if checkered:
        ramp = np.where((x >= SIZE // 2) & ((x // 4 + y // 4) % 2 == 0), ramp + 0.7, ramp)
    return np.repeat(ramp[..., None], 3, axis=2)


def blur(picture: np.ndarray) -> np.ndarray:
    return np.stack([uniform_filter(picture[..., c], 7, mode="nearest") for c in range(3)], axis=-1)


def denoised(a: np.ndarray, b: np.ndarray) -> DenoisedHalves:
    return judged_halves(a, b, blur(a), blur(b))


def halves(reference: np.ndarray, noise: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Noise that is not even symmetric, as that of light is not, and grows with the light."""
    random = np.random.default_rng(seed)
    a, b = (reference * (1 + noise * (random.exponential(size=reference.shape) - 1)) for _ in range(2))
    return a, b


def true_squared_error(pixels: np.ndarray, reference: np.ndarray) -> float:
    scale = reference**2 + RELATIVE_C * (reference**2).mean()
    return float(((pixels - reference) ** 2 / scale).mean())


@pytest.mark.parametrize(("checkered", "noise"), [(False, 0.05), (False, 0.3), (False, 1.0), (True, 0.05)])
def test_the_estimate_is_unbiased(checkered: bool, noise: float) -> None:
    reference = truth(checkered)
    differences, deviations = [], []
    for seed in range(24):
        found = denoised(*halves(reference, noise, seed))
        true = true_squared_error(found.pixels, reference)
        differences.append((found.squared_error - true) / true)
        deviations.append(found.deviation / true)
    mean, error = np.mean(differences), np.std(differences, ddof=1) / len(differences) ** 0.5
    # R² + c is not known exactly: that may cost some per cent of the square.
    assert abs(mean) < 0.1 + 5 * error
    # What it says of its own uncertainty is of the right size.
    assert 0.3 < np.mean(deviations) / np.std(differences, ddof=1) < 10


def test_pixels_that_the_denoiser_makes_worse_keep_their_samples() -> None:
    found = denoised(*halves(truth(True), 0.2, 1))
    assert found.weight[:, : SIZE // 8].mean() > 0.8
    assert found.weight[:, 7 * SIZE // 8 :].mean() < 0.25
    assert np.abs(np.diff(found.weight, axis=1)).max() < 0.05  # no border shows


@pytest.mark.parametrize(("wrong", "least", "most"), [(0.03, 0.99, 1.0), (0.1, 0.6, 0.75)])
def test_no_grain_of_samples_for_little_gain(wrong: float, least: float, most: float) -> None:
    """A denoiser that is wrong everywhere alike: the least error is at w = N / (N + D), 0.96 and 0.67, for the squared errors N
    of the samples and D of the denoiser."""
    reference = np.full((SIZE, SIZE, 3), 0.5)
    denoised = reference * (1 + wrong)
    found = [judged_halves(*halves(reference, 0.2, seed), denoised, denoised) for seed in range(16)]
    assert least <= np.mean([one.weight.mean() for one in found]) <= most
    true = np.mean([true_squared_error(one.pixels, reference) for one in found])
    assert np.mean([one.squared_error for one in found]) == pytest.approx(true, rel=0.25)


def test_no_grain_beside_what_keeps_its_samples() -> None:
    """A wall that the denoiser finds, beside fine detail that it destroys; windows hold parts of both."""
    wall = np.broadcast_to(np.mgrid[0:SIZE, 0:SIZE][1] < SIZE // 2, (SIZE, SIZE))
    reference = np.where(wall[..., None], 0.2, truth(True))
    clean = np.where(wall[..., None], reference, blur(reference))
    found = judged_halves(*halves(reference, 0.6, 4), clean, clean)
    beside = np.s_[:, SIZE // 4 : SIZE // 2 - 1]
    blended = (found.weight[beside] > 2 / 3) & (found.weight[beside] < 0.8)
    assert blended.mean() > 0.1
    np.testing.assert_allclose(found.pixels[beside][blended], 0.2, rtol=1e-6)
    # Where it is wrong everywhere, samples are kept though it sees no edges.
    a, b = halves(reference, 0.2, 4)
    smooth = np.full_like(reference, 0.55)
    wrong = judged_halves(a, b, smooth, smooth)
    inside = np.s_[:, 5 * SIZE // 8 :]
    assert true_squared_error(wrong.pixels[inside], reference[inside]) < 1.1 * true_squared_error(
        (a + b)[inside] / 2, reference[inside]
    )


def test_a_few_pixels_say_little() -> None:
    """Halves with no light in common state a large error, which is a number; a single pixel is never certain."""
    one, two = np.ones((1, 1, 3)), np.zeros((1, 1, 3))
    for pixel in (one, two):
        assert judged_halves(pixel, pixel, pixel, pixel).estimate.high > 1
        assert sampled_halves(pixel, pixel).estimate.high > 1
    lit, dark = np.array([[[1.0] * 3, [0.0] * 3]]), np.zeros((1, 2, 3))
    for found in (judged_halves(lit, dark, lit, dark), sampled_halves(lit, dark)):
        known = joined(ProbedError(0.5, 0.1, 0.0), found.estimate)
        assert 1 < found.error < 2000
        assert 0.5 < known.error < known.high < 3000


def test_specks_beside_what_keeps_its_samples_are_not_shown() -> None:
    """A dark wall with a few samples that are far too bright, beside fine detail that this denoiser destroys."""
    wall = np.broadcast_to(np.mgrid[0:SIZE, 0:SIZE][1] < SIZE // 2, (SIZE, SIZE))
    reference = np.where(wall[..., None], 0.2, truth(True))
    specks = [np.random.default_rng(seed).random((SIZE, SIZE, 1)) < 0.002 for seed in (1, 2)]
    a, b = (
        np.where(speck & wall[..., None], 20.0, half)
        for speck, half in zip(specks, halves(reference, 0.2, 4), strict=True)
    )
    clean = [np.stack([median_filter(half[..., c], 9) for c in range(3)], axis=-1) for half in (a, b)]
    found = judged_halves(a, b, *clean)
    beside = np.s_[:, SIZE // 2 - 24 : SIZE // 2 - 8]
    assert 0.05 < found.weight[beside].mean() < 0.95 and (specks[0] | specks[1])[beside].any()
    assert found.pixels[beside].max() < 3 * 0.2


def test_a_lamp_stays_within_its_edge() -> None:
    """A denoiser that carries 4 % of a lamp to the pixels beside it, as Open Image Denoise does."""
    lamp = np.zeros((SIZE, SIZE), bool)
    lamp[60:63, 40:44] = True
    reference = np.where(lamp[..., None], 100.0, truth(False))
    beside = binary_dilation(lamp, iterations=2) & ~lamp
    estimates, errors = [], []
    for seed in range(8):
        a, b = halves(reference, 0.5, seed)
        clean = [
            blur(np.where(lamp[..., None], truth(False), half)) * ~lamp[..., None] + carried(half * lamp[..., None])
            for half in (a, b)
        ]
        found = judged_halves(a, b, within_edges(a, clean[0]), within_edges(b, clean[1]))
        assert clean[0][beside].mean() > 3 * reference[beside].mean()
        assert found.pixels[beside].mean() < 2 * reference[beside].mean()
        estimates.append(found.squared_error)
        errors.append(true_squared_error(found.pixels, reference))
    assert np.mean(estimates) == pytest.approx(np.mean(errors), rel=0.25)


def carried(lamp: np.ndarray) -> np.ndarray:
    return np.stack([0.9 * lamp[..., c] + 0.1 * uniform_filter(lamp[..., c], 3) for c in range(3)], axis=-1)


def test_the_result_is_never_much_worse_than_the_better_input() -> None:
    for checkered in (False, True):
        reference = truth(checkered)
        a, b = halves(reference, 0.2, 5)
        found = denoised(a, b)
        raw = true_squared_error((a + b) / 2, reference)
        blurred = true_squared_error((blur(a) + blur(b)) / 2, reference)
        assert true_squared_error(found.pixels, reference) < 1.05 * min(raw, blurred)
        assert found.raw_squared_error == pytest.approx(raw, rel=0.15)


def test_odd_sizes_and_black() -> None:
    black = np.zeros((33, 65, 3))
    found = judged_halves(black, black, black, black)
    assert found.error == 0 and found.deviation == 0 and not found.pixels.any()
    one = judged_halves(*[np.ones((1, 1, 3))] * 4)
    assert one.error == 0


def test_halves_of_unlike_shapes() -> None:
    with pytest.raises(EclatError, match="arrays of the same shape"):
        judged_halves(*[np.ones((4, 4, 3))] * 3, np.ones((4, 5, 3)))


def test_equal_errors_give_equal_weights() -> None:
    # Bias and noise are independent: with weights of one half the square is half as large.
    reference = truth(False)
    a, b = halves(reference, 0.07, 3)
    found = judged_halves(a, b, 1.05 * blur(a), 1.05 * blur(b))
    raw = true_squared_error((a + b) / 2, reference)
    biased = true_squared_error(1.05 * (blur(a) + blur(b)) / 2, reference)
    assert raw == pytest.approx(biased, rel=0.3)
    assert found.weight.min() > 0.3 and found.weight.max() < 0.7
    assert true_squared_error(found.pixels, reference) < 0.65 * min(raw, biased)


def test_what_does_not_count_has_no_part() -> None:
    reference = truth(False)
    a, b = halves(reference, 0.3, 2)
    covered = np.ones((SIZE, SIZE), dtype=bool)
    covered[:, 50:90] = False
    covered[:40] = False
    found = judged_halves(a, b, blur(a), blur(b), covered)
    true = ((found.pixels - reference) ** 2 / (reference**2 + RELATIVE_C * (reference[covered] ** 2).mean()))[
        covered
    ].mean()
    assert abs(found.squared_error - true) < 3 * found.deviation < 5 * true
    random = np.random.default_rng(0)
    mess = [np.where(covered[..., None], x, 1e3 * random.normal(size=x.shape)) for x in (a, b, blur(a), blur(b))]
    again = judged_halves(*mess[:2], mess[2], mess[3], covered)
    np.testing.assert_array_equal(again.pixels[covered], found.pixels[covered])
    assert again.squared_error == found.squared_error and again.deviation == found.deviation
    assert not again.squared[~covered].any()
    nothing = judged_halves(a, b, blur(a), blur(b), np.zeros_like(covered))
    assert nothing.squared_error == 0 and nothing.deviation == 0


def with_other(reference: np.ndarray, other: np.ndarray, noise: float, seed: int) -> DenoisedHalves:
    a, b = halves(reference, noise, seed)
    scale = reference**2 + RELATIVE_C * (reference**2).mean()
    squared = ((other - reference) ** 2 / scale).mean(axis=-1)
    known = JudgedPicture(other, np.full(squared.shape, squared.mean()), 0.2 * float(squared.mean()), scale)
    return with_picture(denoised(a, b), (a, b, blur(a), blur(b)), known)


@pytest.mark.parametrize("noise", [0.1, 1.0])
def test_the_error_of_a_blend_is_estimated_without_bias(noise: float) -> None:
    reference = truth(False)
    other = np.where(np.arange(SIZE)[:, None] < SIZE // 2, 0.95, 1.2)[..., None] * reference
    differences = []
    for seed in range(24):
        found = with_other(reference, other, noise, seed)
        true = true_squared_error(found.pixels, reference)
        differences.append((found.squared_error - true) / true)
    mean, error = np.mean(differences), np.std(differences, ddof=1) / len(differences) ** 0.5
    assert abs(mean) < 0.1 + 5 * error


def test_a_blend_shows_each_picture_where_it_is_better() -> None:
    reference = truth(False)
    other = np.where(np.arange(SIZE)[:, None] < SIZE // 2, 1.0, 1.4)[..., None] * reference
    found = with_other(reference, other, 0.3, 1)
    weight = found.other_weight
    assert weight is not None and weight[: SIZE // 4].mean() > 0.6 and weight[-SIZE // 4 :].mean() < 0.2
    alone = denoised(*halves(reference, 0.3, 1))
    true = true_squared_error(found.pixels, reference)
    assert true < true_squared_error(alone.pixels, reference) and true < true_squared_error(other, reference)


def test_a_blend_of_few_noisy_samples_knows_its_error_from_the_other_picture() -> None:
    """The product of the noise of both halves, 4 where the square of the error is 0.0025, must not reach the estimate."""
    reference = truth(False)
    other = 1.05 * reference
    for seed in range(8):
        found = with_other(reference, other, 2.0, seed)
        true = true_squared_error(found.pixels, reference)
        assert abs(found.squared_error - true) < 4 * found.deviation and found.deviation < 0.6 * true


@pytest.mark.parametrize("deviation", [0.2, 1.0])
def test_an_error_that_halves_share_with_the_other_picture_is_within_what_is_stated(deviation: float) -> None:
    """All paths read the same records, which are 10 % too bright: the differences of the halves do not show it."""
    reference = truth(False)
    other = 1.1 * reference
    a, b = halves(1.1 * reference, 0.1, 3)
    scale = reference**2 + RELATIVE_C * (reference**2).mean()
    squared = ((other - reference) ** 2 / scale).mean(axis=-1)
    mean = float(squared.mean())

    def stated(common: float) -> tuple[float, float]:
        known = JudgedPicture(other, np.full(squared.shape, mean), deviation * mean, scale, common)
        found = with_picture(denoised(a, b), (a, b, blur(a), blur(b)), known)
        return found.estimate.high, true_squared_error(found.pixels, reference) ** 0.5

    high, true = stated(12**-0.5 * mean)
    assert true < 1.35 * high
    blind, true = stated(0.0)
    assert blind < 0.5 * true
