# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The error that stops a picture, against the true one, and the passes that lead there."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.measure.metrics import relative_rmse
from eclat.sampling import convergence
from eclat.sampling.convergence import Goal, Sampling, estimated_error, noise_beside_records
from eclat.sampling.denoised_halves import DenoisedHalves
from eclat.sampling.halves import Halves
from eclat.scenes import build

SIZE = (32, 32)


def picture(scene: eclat.Scene, what: Any, samples: int, seed: int) -> np.ndarray:
    return eclat.render(scene, what, samples=samples, seed=seed, size=SIZE, adaptive=False).pixels


@pytest.fixture(
    scope="module", params=["cornell-box path", "glossy-box path", "cornell-box irradiance-cache", "atrium path"]
)
def subject(request: pytest.FixtureRequest) -> tuple[eclat.Scene, Any, np.ndarray, np.ndarray]:
    """Scene, method and two references. The cache is solved once: its own error is no part of the noise."""
    name, method = request.param.split()
    scene = build(name)
    what: Any = eclat.Path()
    if method == "irradiance-cache":
        what = eclat.solve(scene, eclat.IrradianceCache(max_error=0.05), size=SIZE)
    return scene, what, *(picture(scene, what, 512, seed) for seed in (900, 901))


@pytest.mark.parametrize("samples", [8, 32])
def test_estimated_error_is_the_true_one(subject: tuple[Any, ...], samples: int) -> None:
    """Over seeds, the ratio of both is 1 within 20 %; measured 0.87..1.11. Even and odd Sobol samples, or the noisy
    picture's own square below the fraction, lie outside of that (1.2..3.5, and 0.6..0.8)."""
    scene, what, a, b = subject
    ratios = []
    for seed in range(3):
        mean = picture(scene, what, samples, seed)
        estimate = estimated_error(picture(scene, what, samples // 2, seed), mean)
        ratios.append(estimate / relative_rmse(mean, a, b))
    assert 0.8 < np.mean(ratios) < 1.2


def test_independent_noise_is_estimated_exactly() -> None:
    """Gaussian noise of known size on grey: the estimate's own spread is 0.4 % here, so 2 % is five of it."""
    rng = np.random.default_rng(3)
    halves = 0.5 + 0.05 * rng.standard_normal((2, 128, 128, 3))
    expected = 0.05 / math.sqrt(2) / (0.5 * math.sqrt(1 + 0.01))
    assert estimated_error(halves[0], halves.mean(axis=0)) == pytest.approx(expected, rel=0.02)


def test_exposure_cancels_and_black_is_exact() -> None:
    rng = np.random.default_rng(4)
    half, mean = rng.random((2, 9, 9, 3))
    assert estimated_error(8 * half, 8 * mean) == pytest.approx(estimated_error(half, mean), rel=1e-12)
    assert estimated_error(np.zeros((4, 4, 3)), np.zeros((4, 4, 3))) == 0


def test_one_bright_pixel_does_not_hide_itself() -> None:
    """A firefly in one half: relative to its own square it would count for a quarter at most."""
    half = np.full((20, 20, 3), 0.5)
    half[7, 7] = 1000.0
    mean = (half + 0.5) / 2
    assert estimated_error(half, mean) > 1


def test_sampling_goes_on_until_the_error_is_met() -> None:
    scene = build("cornell-box")
    coarse, fine = (
        eclat.render(scene, eclat.Path(), max_error=e, size=SIZE, denoise=False).metadata["statistics"]
        for e in (0.2, 0.1)
    )
    assert coarse["noise"] <= 0.2 and fine["noise"] <= 0.1
    assert coarse["samples"] < fine["samples"] and math.log2(fine["samples"]) % 1 == 0


def test_giving_up_causes_a_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(convergence, "MOST_SAMPLES", 8)
    with pytest.warns(eclat.EclatWarning, match=r"the relative noise is still \d+\.\d+, above the wanted 0\.001"):
        image = eclat.render(build("cornell-box"), eclat.Path(), max_error=0.001, size=(8, 8), denoise=False)
    assert image.metadata["statistics"]["samples"] == 8


class FakeFilm:
    """Counts samples; its picture converges like noise does."""

    def __init__(self, samples: int = 0) -> None:
        self.samples = samples

    @property
    def radiance(self) -> np.ndarray:
        sign = np.where(np.arange(400).reshape(20, 20, 1) % 2, 1.0, -1.0) * np.ones(3)
        return 1 + sign / math.sqrt(max(1, self.samples))

    def copy(self) -> FakeFilm:
        return FakeFilm(self.samples)


class FakeClock:
    """Stands still but for samples, each of which takes a hundredth of a second."""

    now = 0.0

    def perf_counter(self) -> float:
        return self.now


def sampling(
    keep_partial: bool = False, clock: FakeClock | None = None
) -> tuple[Sampling, list[tuple[int, int]], list[float]]:
    film, ranges, fractions = FakeFilm(), [], []

    def render_range(firsts: np.ndarray, ends: np.ndarray, report: Any) -> float:
        first, end = int(firsts.item()), int(ends.item())
        assert first == film.samples
        ranges.append((first, end))
        for fraction in (0.0, 0.5, 1.0):
            report("render", fraction, {"rays": 10 * fraction})
        film.samples = end
        if clock is not None:
            clock.now += (end - first) / 100
        return 10.0

    made = Sampling(film, render_range, keep_partial, lambda _, fraction, __: fractions.append(fraction))
    return made, ranges, fractions


def test_a_number_of_samples_is_taken_in_halves_that_tell_the_noise() -> None:
    made, ranges, fractions = sampling()
    made.run(Goal(100, 0.01, None))
    assert ranges == [(0, 50), (50, 100)] and fractions == [0.0, 0.25, 0.5, 0.5, 0.75, 1.0]
    assert made.noise > 0
    # Halves of an odd number would not weigh the same.
    made, ranges, _ = sampling()
    made.run(Goal(1, 0.01, None))
    assert ranges == [(0, 1)] and math.isnan(made.noise)


def test_progress_is_measured_against_what_the_error_asks_for() -> None:
    made, ranges, fractions = sampling()
    made.run(Goal(None, 0.05, None))
    assert all(end == 2 * first for first, end in ranges[1:])
    assert fractions[-1] == 1.0
    # After the first estimate the bar no longer jumps back by much: this noise falls as expected.
    steps = np.diff(fractions[6:])
    assert steps.min() > -0.01


def test_slices_for_partial_pictures_are_the_same_samples() -> None:
    made, ranges, fractions = sampling(keep_partial=True)
    made.run(Goal(100, 0.01, None))
    assert ranges[0] == (0, 1) and ranges[-1][1] == 100
    assert all(a[1] == b[0] for a, b in itertools.pairwise(ranges))
    assert fractions == sorted(fractions)
    assert made.partial is not None and made.partial_taken == 100 and made.rays == 10 * len(ranges)


def test_time_is_used_up_and_not_overrun(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = FakeClock()
    monkeypatch.setattr(convergence, "clock", clock)
    made, ranges, _ = sampling(clock=clock)
    made.run(Goal(None, 0.01, deadline=1.0))
    assert 0.95 < clock.now < 1.001
    assert ranges[0] == (0, 1) and ranges[-1][1] == made.taken == round(100 * clock.now)
    assert all(a[1] == b[0] for a, b in itertools.pairwise(ranges))


class SlowHalves(Halves):
    """Black halves, whose noise takes 0.1 s to estimate, and whose denoised picture takes 0.2 s."""

    clock: FakeClock

    def sampled(self) -> DenoisedHalves:
        self.clock.now += 0.1
        return super().sampled()

    def denoised(self) -> DenoisedHalves:
        self.clock.now += 0.2
        return super().sampled()


def test_the_time_of_the_last_estimate_and_of_the_denoiser_is_reserved(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = FakeClock()
    monkeypatch.setattr(convergence, "clock", clock)
    films = SlowHalves(eclat._core.Film(8, 8), eclat._core.Film(8, 8), (0, 0, 8, 8))
    films.clock = clock

    def render_range(firsts: np.ndarray, ends: np.ndarray, report: Any) -> float:
        clock.now += int(ends.item() - firsts.item()) / 100
        return 1.0

    made = Sampling(films, render_range, False, None)
    made.run(Goal(None, 0.01, deadline=3.0, denoised=True))
    assert made.denoised and 2.5 < clock.now <= 3.0


def test_one_sample_is_taken_however_little_time_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = FakeClock()
    monkeypatch.setattr(convergence, "clock", clock)
    made, ranges, _ = sampling(clock=clock)
    made.run(Goal(None, 0.01, deadline=0.001))
    assert ranges == [(0, 1)] and made.taken == 1


@pytest.mark.parametrize("records", [0.0, 0.01, 0.02, 0.028, 0.03, 0.04, 0.06, 0.5])
def test_noise_gets_what_records_leave_and_is_not_driven_far_below_their_error(records: float) -> None:
    noise = noise_beside_records(0.03, records)
    whole = math.hypot(noise, records)
    if records <= 0.03 / math.sqrt(2):
        assert whole == pytest.approx(0.03)
    else:
        assert 0.03 / math.sqrt(2) <= noise * (1 + 1e-12)
        assert whole <= max(math.hypot(records, 0.03 / math.sqrt(2)), 1.12 * records) * (1 + 1e-12)
    assert noise >= records / 2
