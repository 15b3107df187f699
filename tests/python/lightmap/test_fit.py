# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The fit of texels, against dense least squares and closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.lightmap.fit import GATHERED_WEIGHT, SEAM_WEIGHT, Rows, bilinear, differences, fit

NOTHING = Rows(np.zeros((0, 8), int), np.zeros((0, 8)))


def dense(rows: Rows, count: int) -> np.ndarray:
    matrix = np.zeros((len(rows.columns), count))
    for i in range(len(matrix)):
        np.add.at(matrix[i], rows.columns[i], rows.weights[i])
    return matrix


def test_bilinear_lookups() -> None:
    """A plane in u and v is read exactly, and a missing texel's weight goes to the others."""
    numbers = np.arange(30).reshape(5, 6)
    rng = np.random.default_rng(1)
    places = rng.uniform(0.5, (5.5, 4.5), (100, 2))
    values = (2 + 3 * (np.arange(6) + 0.5) - 5 * (np.arange(5)[:, None] + 0.5)).reshape(-1, 1)
    rows = bilinear(numbers, places)
    np.testing.assert_allclose(rows.times(values)[:, 0], 2 + 3 * places[:, 0] - 5 * places[:, 1])
    numbers[2, 3] = -1
    ones = bilinear(numbers, places).times(np.ones((30, 1)))
    near = np.clip(1 - np.abs(places - (3.5, 2.5)), 0, 1).prod(axis=1) > 0.5
    assert near.any()
    np.testing.assert_allclose(ones[~near], 1)
    assert not bilinear(numbers, np.array([[3.5, 2.5]])).weights.any(), "nothing is there to be read"


def test_the_fit_agrees_with_dense_least_squares() -> None:
    rng = np.random.default_rng(4)
    numbers = np.arange(48).reshape(6, 8)
    gathered = rng.uniform(1, 2, (48, 3))
    places = np.column_stack((np.arange(48) % 8, np.arange(48) // 8)) + 0.5 + rng.uniform(-0.4, 0.4, (48, 2))
    lookups = bilinear(numbers, places)
    a, b = (bilinear(numbers, rng.uniform(0.5, (7.5, 5.5), (30, 2))) for _ in range(2))
    seams = differences(a, b)
    A, D = dense(lookups, 48), dense(seams, 48)
    left = A.T @ A + GATHERED_WEIGHT * np.eye(48) + SEAM_WEIGHT * D.T @ D
    wanted = np.linalg.solve(left, A.T @ gathered + GATHERED_WEIGHT * gathered)
    np.testing.assert_allclose(fit(gathered, lookups, seams), wanted, rtol=1e-3)


def test_texels_at_their_centres_stay_what_was_gathered() -> None:
    numbers = np.arange(20).reshape(4, 5)
    gathered = np.random.default_rng(5).uniform(0, 3, (20, 3))
    centers = np.column_stack((np.arange(20) % 5, np.arange(20) // 5)) + 0.5
    np.testing.assert_allclose(fit(gathered, bilinear(numbers, centers), NOTHING), gathered, rtol=1e-6)


def test_borders_are_read_right() -> None:
    """Irradiance grows along u; the first texel's centre lies outside the surface, which begins at u = 0.9."""
    numbers = np.arange(12).reshape(3, 4)
    places = np.column_stack((np.arange(12) % 4, np.arange(12) // 4)) + 0.5
    places[:, 0] = np.maximum(places[:, 0], 0.9)
    gathered = places[:, :1].repeat(3, axis=1)
    rows = bilinear(numbers, places)
    before = np.abs(rows.times(gathered) - gathered).max()
    after = np.abs(rows.times(fit(gathered, rows, NOTHING)) - gathered).max()
    assert before == pytest.approx(0.24, rel=0.01) and after < 0.05


def test_seams_meet_and_darkness_stays_dark() -> None:
    """Two texels of one place become their mean, and nothing is below 0."""
    numbers = np.arange(2).reshape(1, 2)
    centers = np.array([[0.5, 0.5], [1.5, 0.5]])
    rows = bilinear(numbers, centers)
    pair = differences(bilinear(numbers, centers[:1]), bilinear(numbers, centers[1:]))
    found = fit(np.array([[1.0, 0.0], [3.0, 0.0]]), rows, pair)
    gap = 2 * (1 + GATHERED_WEIGHT) / (1 + GATHERED_WEIGHT + 2 * SEAM_WEIGHT)
    np.testing.assert_allclose(found[:, 0], [2 - gap / 2, 2 + gap / 2])
    assert (found[:, 1] == 0).all()
    away = differences(bilinear(numbers, centers[:1]), bilinear(np.full((1, 2), -1), centers[1:]))
    assert not away.weights.any(), "a seam of which one side has no texels joins nothing"
