# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What probes say of a picture whose error is known: unbiased, wherever it lies, with a margin that holds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from eclat.measure.error_estimate import ErrorEstimate
from eclat.measure.metrics import RELATIVE_C
from eclat.sampling import picture_probes
from eclat.sampling.adaptive_sampling import Counts
from eclat.sampling.denoised_halves import DenoisedHalves, sampled_halves
from eclat.sampling.picture_probes import PATHS, ProbedError, joined, number_of_paths, probed_error

SIZE = (96, 64)
TRUTH = np.random.default_rng(1).uniform(0.3, 1.0, (*SIZE, 3))


def biased(bias: np.ndarray | float, noise: float, seed: int) -> DenoisedHalves:
    """Halves that share a relative bias, (height, width, 1), and have noise of their own."""
    random = np.random.default_rng(seed)
    a, b = (TRUTH * (1 + bias + noise * random.normal(size=TRUTH.shape)) for _ in range(2))
    return sampled_halves(a, b)


class Paths:
    """Noisy estimates of the truth: the samples of a pixel have an exponential distribution, as skew as light."""

    def __init__(self, seed: int) -> None:
        self._seed, self.taken = seed, 0

    def __call__(self, counts: Counts, number: int) -> np.ndarray:
        self.taken += int(counts.sum())
        random = np.random.default_rng((self._seed, number))
        mean = random.gamma(np.maximum(counts, 1)[..., None], size=TRUTH.shape) / np.maximum(counts, 1)[..., None]
        return np.where(counts[..., None] > 0, TRUTH * mean, np.nan)


def true_squared(pixels: np.ndarray) -> float:
    scale = TRUTH**2 + RELATIVE_C * (TRUTH**2).mean()
    return float(((pixels - TRUTH) ** 2 / scale).mean())


@pytest.mark.parametrize("everywhere", [True, False])
def test_probes_measure_the_error_that_both_halves_share(everywhere: bool) -> None:
    # A bias of 10 % everywhere, or of 30 % in a strip that holds a tenth of the pixels, which the halves cannot see.
    bias = np.full((*SIZE, 1), 0.1)
    if not everywhere:
        bias[:, :6], bias[:, 6:] = 0.3, 0.0
    ratios, inside = [], 0
    for seed in range(60):
        found = biased(bias, 0.05, seed)
        true = true_squared(found.pixels)
        probed = probed_error(found, Paths(seed), 300 * 3 * PATHS, seed)
        assert found.squared_error < 0.4 * true
        ratios.append(probed.squared / true)
        inside += abs(probed.squared - true) < 1.96 * probed.deviation
    error = np.std(ratios, ddof=1) / len(ratios) ** 0.5
    assert abs(np.mean(ratios) - 1) < 0.03 + 5 * error and error < 0.1
    assert inside >= 48  # of 60; 57 are expected, and 47 or fewer come once in twenty thousand runs


def test_about_as_many_paths_as_asked_for() -> None:
    for probes in (10, 200, 10**6):
        paths = Paths(0)
        probed_error(biased(0.1, 0.05, 0), paths, probes * 3 * PATHS, 0)
        pixels = min(probes, TRUTH.shape[0] * TRUTH.shape[1])
        assert 0.7 * pixels <= paths.taken / (3 * PATHS) <= pixels + 1
    assert number_of_paths(100, 4) == picture_probes.LEAST_PATHS
    assert number_of_paths(10**6, 64) > number_of_paths(10**6, 4) > 10**6


def test_an_error_that_one_tile_causes_is_stated_as_a_bound() -> None:
    bias = np.zeros((*SIZE, 1))
    bias[:8, :8] = 1.0
    local = probed_error(biased(bias, 0.02, 0), Paths(0), 2000 * 3 * PATHS, 0)
    even = probed_error(biased(np.full((*SIZE, 1), 0.1), 0.02, 0), Paths(0), 2000 * 3 * PATHS, 0)
    assert local.in_one_tile > 0.8 and even.in_one_tile < 0.1


def test_the_same_seed_probes_the_same_pixels() -> None:
    found = biased(0.1, 0.05, 0)
    first, again, other = (probed_error(found, Paths(0), 100 * 3 * PATHS, seed) for seed in (0, 0, 1))
    assert first == again != other


class Machine:
    """A clock, and paths that take `seconds` each on it; after `slow_after` of them, the machine is four times slower."""

    def __init__(self, seconds: float, slow_after: float = math.inf) -> None:
        self.now, self._seconds, self._slow_after, self._paths = 0.0, seconds, slow_after, Paths(0)

    def perf_counter(self) -> float:
        return self.now

    def take(self, counts: Counts, number: int) -> np.ndarray:
        self.now += self._seconds * int(counts.sum()) * (4 if self._paths.taken >= self._slow_after else 1)
        return self._paths(counts, number)

    @property
    def pixels(self) -> float:
        return self._paths.taken / (3 * PATHS)


@pytest.mark.parametrize("slow_after", [math.inf, 100 * 3 * PATHS])
def test_probes_end_when_the_time_is_over(monkeypatch: pytest.MonkeyPatch, slow_after: float) -> None:
    # A pixel takes 0.01 s, and later perhaps 0.04 s. All 1000 pixels would take 10 s or more.
    machine = Machine(0.01 / (3 * PATHS), slow_after)
    monkeypatch.setattr(picture_probes, "clock", machine)
    found = biased(0.1, 0.05, 0)
    probed = probed_error(found, machine.take, 1000 * 3 * PATHS, 0, deadline=4.0)
    assert 3.0 < machine.now <= 4.0 and machine.pixels > 150
    assert abs(probed.squared - true_squared(found.pixels)) < 3 * probed.deviation < true_squared(found.pixels)


def test_some_probes_are_taken_whatever_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    machine = Machine(1.0)
    monkeypatch.setattr(picture_probes, "clock", machine)
    assert probed_error(biased(0.1, 0.05, 0), machine.take, 1000 * 3 * PATHS, 0, deadline=0.0).deviation > 0
    assert machine.pixels == picture_probes.FIRST_PROBES


def test_probes_in_part_of_the_time_are_right_on_average(monkeypatch: pytest.MonkeyPatch) -> None:
    """The pixels that the clock leaves out are random ones, also where bright pixels are probed more often."""
    bias = np.full((*SIZE, 1), 0.05)
    bias[:, :6] = 0.5
    ratios = []
    for seed in range(60):
        machine = Machine(0.01 / (3 * PATHS))
        machine._paths = Paths(seed)
        monkeypatch.setattr(picture_probes, "clock", machine)
        found = biased(bias, 0.05, seed)
        ratios.append(
            probed_error(found, machine.take, 1000 * 3 * PATHS, seed, 3.0).squared / true_squared(found.pixels)
        )
        assert machine.pixels < 350
    assert abs(np.mean(ratios) - 1) < 0.03 + 5 * np.std(ratios, ddof=1) / len(ratios) ** 0.5


def test_a_black_picture_and_one_pixel() -> None:
    black = np.zeros((4, 4, 3))
    found = probed_error(sampled_halves(black, black), lambda counts, number: black, 10**6, 0)
    assert found.squared == 0 and found.deviation == 0
    one = probed_error(sampled_halves(black[:1, :1], black[:1, :1]), lambda counts, number: black[:1, :1], 10**6, 0)
    assert joined(one, ErrorEstimate(0.02, 0.01, 0.03)).error == pytest.approx(0.02)


def test_more_certain_errors_count_more() -> None:
    known = ErrorEstimate(0.03, 0.03, 0.03)
    sure, unsure = (ProbedError(0.05**2, deviation, 0.1) for deviation in (1e-6, 1.0))
    assert joined(sure, known).error == pytest.approx(0.05, rel=1e-3)
    assert joined(unsure, known).error == pytest.approx(0.03, rel=1e-3)
    middle = joined(ProbedError(0.05**2, 0.5 * 0.03**2, 0.1), known)
    assert middle.error == pytest.approx(math.sqrt((0.05**2 + 0.03**2) / 2))
    assert middle.low < middle.error < middle.high
    assert joined(sure, None).error == pytest.approx(0.05)
