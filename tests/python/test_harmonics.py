# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The bases against SciPy, the round trip from function to coefficients and back, and what is refused."""

from __future__ import annotations

import doctest

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.special import lpmv, sph_harm_y

from eclat import harmonics
from eclat.errors import EclatError

ORDER = 12


def random_directions(count: int, upper: bool = False) -> np.ndarray:
    w = np.random.default_rng(1).normal(size=(count, 3))
    if upper:
        w[:, 2] = np.abs(w[:, 2])
    return w / np.linalg.norm(w, axis=1, keepdims=True)


def test_spherical_harmonics_are_those_of_scipy() -> None:
    w = random_directions(50)
    theta, phi = np.arccos(w[:, 2]), np.arctan2(w[:, 1], w[:, 0])
    ours = harmonics.evaluate("spherical", ORDER, w)
    for band in range(ORDER):
        for m in range(band + 1):
            theirs = (-1) ** m * sph_harm_y(band, m, theta, phi) * (np.sqrt(2) if m else 1)  # without their phase
            np.testing.assert_allclose(ours[:, band * band + band + m], theirs.real, atol=1e-12)
            if m:
                np.testing.assert_allclose(ours[:, band * band + band - m], theirs.imag, atol=1e-12)


def test_hemispherical_harmonics_are_shifted_legendre_functions_of_scipy() -> None:
    w = random_directions(50, upper=True)
    phi = np.arctan2(w[:, 1], w[:, 0])
    ours = harmonics.evaluate("hemispherical", 6, w)
    for band in range(6):
        norm = np.sqrt((2 * band + 1) / (2 * np.pi))
        for m in range(band + 1):
            if m:
                norm /= np.sqrt((band + m) * (band - m + 1))
            polar = (-1) ** m * norm * lpmv(m, band, 2 * w[:, 2] - 1) * (np.sqrt(2) if m else 1)
            np.testing.assert_allclose(ours[:, band * band + band + m], polar * np.cos(m * phi), atol=1e-12)
            if m:
                np.testing.assert_allclose(ours[:, band * band + band - m], polar * np.sin(m * phi), atol=1e-12)


@pytest.mark.parametrize(("basis", "domain"), [("spherical", "sphere"), ("hemispherical", "hemisphere")])
def test_projecting_and_reconstructing_a_function_returns_it(basis: harmonics.Basis, domain: harmonics.Domain) -> None:
    w, weights = harmonics.quadrature(2 * ORDER, domain)
    values = np.stack([1 + w[:, 2] ** 3, w[:, 2]], axis=1)
    coefficients = harmonics.project(basis, ORDER, w, values, weights)
    assert coefficients.shape == (ORDER**2, 2)
    some = random_directions(20, upper=True)
    expected = np.stack([1 + some[:, 2] ** 3, some[:, 2]], axis=1)
    np.testing.assert_allclose(harmonics.reconstruct(basis, coefficients, some), expected, atol=1e-12)
    np.testing.assert_allclose(harmonics.reconstruct(basis, coefficients[:, 0], some), expected[:, 0], atol=1e-12)


def test_without_weights_directions_are_taken_as_even_over_the_hemisphere() -> None:
    w = random_directions(4000, upper=True)
    sky = harmonics.project("hemispherical", 2, w, np.ones(len(w)))
    np.testing.assert_allclose(sky, [np.sqrt(2 * np.pi), 0, 0, 0], atol=0.1)


def test_rotation_agrees_with_turned_directions_by_scipy() -> None:
    rng = np.random.default_rng(4)
    coefficients = rng.normal(size=(ORDER**2, 3))
    w = random_directions(30)
    for R in Rotation.random(5, rng=rng).as_matrix():
        turned = harmonics.rotate("spherical", coefficients, R)
        there = harmonics.reconstruct("spherical", coefficients, w @ R)
        np.testing.assert_allclose(harmonics.reconstruct("spherical", turned, w), there, atol=1e-11)


def test_the_series_is_as_good_as_its_tolerance() -> None:
    coefficients = np.random.default_rng(5).normal(size=ORDER**2)
    R = Rotation.from_euler("zyz", [2.0, 0.2, -1.0]).as_matrix()
    exact = harmonics.rotate("spherical", coefficients, R)
    error = np.linalg.norm(harmonics.rotate("spherical", coefficients, R, tolerance=1e-4) - exact)
    assert 0 < error < 1e-4 * np.linalg.norm(coefficients)


def test_continuing_a_constant_sky_below_the_horizon_keeps_it_constant() -> None:
    sky = np.zeros(100)
    sky[0] = np.sqrt(2 * np.pi)
    tilt = Rotation.from_euler("y", 0.2).as_matrix()
    up = [[0.0, 0.0, 1.0]]
    irradiance_coefficients = [np.sqrt(np.pi / 2), np.pi / 3 * np.sqrt(3 / (2 * np.pi))]
    for horizon, worst in (("continued", 0.004), ("dark", 0.012)):
        turned = harmonics.rotate("hemispherical", sky, tilt, horizon=horizon)  # type: ignore[arg-type]
        E = irradiance_coefficients @ turned[[0, 2]]
        assert abs(E / np.pi - 1) < worst
        assert abs(harmonics.reconstruct("hemispherical", turned, up)[0] - 1) < 0.05


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: harmonics.evaluate("sphericall", 2, [[0, 0, 1]]), "got 'sphericall'; did you mean 'spherical'?"),
        (lambda: harmonics.evaluate("spherical", 0, [[0, 0, 1]]), r"order must be in \[1, 48\], got 0"),
        (lambda: harmonics.evaluate("spherical", 2, [[0, 0, 2]]), "unit vectors, got .* at index 0"),
        (lambda: harmonics.evaluate("spherical", 2, [[0, 0, float("nan")]]), "unit vectors"),
        (lambda: harmonics.evaluate("spherical", 2, [0, 0, 1]), r"shape \(N, 3\), got \(3,\)"),
        (lambda: harmonics.project("spherical", 2, [[0, 0, 1]], [1, 2]), "for 1 directions, got"),
        (lambda: harmonics.project("spherical", 2, [[0, 0, 1]], [np.inf]), "values must be finite"),
        (lambda: harmonics.project("spherical", 2, [[0, 0, 1]], [1], [1, 2]), "weights must be 1 finite"),
        (lambda: harmonics.window("hanning", [1, 2, 3]), "got 3"),
        (lambda: harmonics.window("hann", [1]), "did you mean 'hanning'"),
        (lambda: harmonics.rotate("spherical", [1], np.eye(2)), r"shape \(3, 3\)"),
        (lambda: harmonics.rotate("spherical", [1], -np.eye(3)), "got a reflection"),
        (lambda: harmonics.rotate("spherical", [1], 2 * np.eye(3)), "must be orthogonal"),
        (lambda: harmonics.rotate("hemispherical", [1], np.eye(3), horizon="bright"), "got 'bright'"),
        (
            lambda: harmonics.rotate("hemispherical", np.ones(9), np.eye(3), spherical_order=2),
            "at least 3, the hemispherical order, got 2",
        ),
        (lambda: harmonics.fit(np.ones(9), -1), "tikhonov must be"),
        (lambda: harmonics.fit(np.ones(1600), 0), "singular"),
        (lambda: harmonics.quadrature(4, "disk"), "domain must be one of"),
        (lambda: harmonics.quadrature(0), "count must be at least 1"),
    ],
)
def test_impossible_values_are_refused(call: object, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        call()  # type: ignore[operator]


def test_examples() -> None:
    assert doctest.testmod(harmonics).failed == 0
