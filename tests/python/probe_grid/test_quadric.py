# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Irradiance of nine coefficients, its least value, and windows."""

from __future__ import annotations

import numpy as np
import pytest

from eclat import harmonics
from eclat.errors import EclatError
from eclat.probe_grid.quadric import (
    COSINE_LOBE,
    check_window,
    factors,
    irradiance_of,
    least_irradiance,
    least_strengths,
    shares_of_variation,
    windowed,
)


def lamp(direction: tuple[float, float, float]) -> np.ndarray:
    """Coefficients (1, 9, 3) of a lamp in a direction, whose irradiance on what faces it is 1."""
    return harmonics.evaluate("spherical", 3, [direction])[:, :, None] * np.ones(3)


@pytest.fixture(scope="module")
def probes() -> np.ndarray:
    """Lamps with noise, of all colours."""
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    shown = harmonics.evaluate("spherical", 3, directions)[:, :, None] * rng.uniform(0, 1, (300, 1, 3))
    noisy = shown + 0.1 * rng.normal(size=(300, 9, 3))
    noisy[:, 0] = np.abs(noisy[:, 0]) + rng.uniform(0, 2, (300, 1))
    return noisy


def test_factors_are_those_of_the_clamped_cosine() -> None:
    """A_l is 2π ∫ max(0, t) P_l(t) dt."""
    t, weights = np.polynomial.legendre.leggauss(40)
    t, weights = 0.5 * (t + 1), 0.5 * weights
    for band, factor in enumerate(COSINE_LOBE):
        legendre = np.polynomial.legendre.Legendre.basis(band)(t)
        assert 2 * np.pi * float((weights * t * legendre).sum()) == pytest.approx(factor, abs=1e-12)


def test_irradiance_of_a_lamp_is_nearly_the_clamped_cosine() -> None:
    """1/4 + x/2 + 5/32 (3x² − 1), which misses max(0, x) by at most 1/16 (at the lamp), 0.094 at the horizon."""
    x = np.linspace(-1, 1, 41)
    normals = np.stack([np.sqrt(1 - x**2), 0 * x, x], axis=1)
    found = irradiance_of(np.repeat(lamp((0, 0, 1)), 41, axis=0), normals)
    assert found[:, 1] == pytest.approx(0.25 + 0.5 * x + 5 / 32 * (3 * x**2 - 1), abs=1e-12)


def test_the_least_irradiance_of_a_lamp() -> None:
    """The parabola above has its least value −19/480 at x = −8/15."""
    for direction in ((0, 0, 1), (0.6, 0.8, 0), (-2 / 3, 1 / 3, 2 / 3)):
        assert least_irradiance(lamp(direction)) == pytest.approx(-19 / 480, abs=1e-9)
    assert least_irradiance(np.zeros((2, 9, 3))) == pytest.approx(0)
    # Band 2 alone has its least value on a circle or at two poles, where the problem is hard for Newton's method.
    for i in range(4, 9):
        one = np.zeros((1, 9, 3))
        one[0, i] = 1
        t, _ = harmonics.quadrature(40, "sphere")
        seen = irradiance_of(np.repeat(one, len(t), axis=0), t).min()
        assert least_irradiance(one)[0, 0] == pytest.approx(seen, abs=2e-3)
        assert least_irradiance(one)[0, 0] <= seen + 1e-12


def test_the_least_irradiance_is_that_of_many_normals(probes: np.ndarray) -> None:
    normals = np.random.default_rng(2).normal(size=(20_000, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for c, least in zip(probes[:30], least_irradiance(probes[:30]), strict=True):
        seen = irradiance_of(np.broadcast_to(c, (len(normals), 9, 3)), normals).min(axis=0)
        assert (least <= seen + 1e-12).all()
        assert seen == pytest.approx(least, abs=1e-3)


def test_nonnegative_is_exact(probes: np.ndarray) -> None:
    found, changed = windowed(probes, "nonnegative")
    least = least_irradiance(found).min(axis=1)
    assert changed.any() and not changed.all()
    assert least[changed] == pytest.approx(0, abs=1e-9)
    assert (found[~changed] == probes[~changed]).all()
    # A lamp: m / (m + 19/480) with the mean m = 1/4.
    assert shares_of_variation(lamp((0, 1, 0))) == pytest.approx(0.25 / (0.25 + 19 / 480))
    assert shares_of_variation(np.zeros((1, 9, 3))) == 1


def test_the_window_of_sloan_is_the_weakest_without_negative_light(probes: np.ndarray) -> None:
    strength = least_strengths(probes)
    found, changed = windowed(probes, "sloan")
    assert (changed == (strength > 0)).all() and changed.any()
    assert (least_irradiance(found) >= 0).all()
    weaker = probes * factors(0.999 * strength)[..., None]
    assert (least_irradiance(weaker)[changed].min(axis=1) < 0).all()
    assert factors(np.array([0.5]))[0] == pytest.approx([1, *3 * [1 / 3], *5 * [1 / 19]])


def test_fixed_windows_are_those_of_harmonics(probes: np.ndarray) -> None:
    found, changed = windowed(probes, "hanning")
    assert changed.all()
    assert found[7, :, 1] == pytest.approx(harmonics.window("hanning", probes[7, :, 1]))
    assert (windowed(probes, "none")[0] == probes).all()
    with pytest.raises(EclatError, match="did you mean 'lanczos'"):
        check_window("lanczo")
