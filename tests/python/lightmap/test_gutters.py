# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Texels filled from their neighbours."""

from __future__ import annotations

import numpy as np

from eclat.lightmap.gutters import dilate, fill_nearest


def test_rings_around_one_texel() -> None:
    values, known = np.full((9, 9, 3), np.nan), np.zeros((9, 9), bool)
    values[4, 4], known[4, 4] = (1, 2, 3), True
    for rings in (0, 1, 2, 3):
        filled, now = dilate(values, known, rings)
        assert now.sum() == (2 * rings + 1) ** 2
        np.testing.assert_allclose(filled[now], np.tile([1.0, 2, 3], (now.sum(), 1)))
        assert (filled[~now] == 0).all()


def test_means_of_the_ring_before_and_only_where_wanted() -> None:
    values, known = np.zeros((1, 5, 1)), np.array([[True, False, False, False, True]])
    values[0, :, 0] = 1, 9, 9, 9, 5
    filled, _ = dilate(values, known, 5)
    np.testing.assert_allclose(filled[0, :, 0], [1, 1, 3, 5, 5])
    wanted = np.array([[False, True, False, False, False]])
    filled, now = dilate(values, known, 5, wanted)
    assert now.tolist() == [[True, True, False, False, True]]
    assert known.sum() == 2, "the arguments are left alone"


def test_the_nearest_texel_fills_the_rest() -> None:
    random = np.random.default_rng(3)
    known = random.random((40, 57)) < 0.02
    values = random.random((40, 57, 3))
    filled = fill_nearest(values, known)
    rows, columns = np.nonzero(known)
    y, x = np.mgrid[0:40, 0:57]
    distances = (y[..., None] - rows) ** 2 + (x[..., None] - columns) ** 2
    nearest = values[rows, columns][distances.argmin(axis=2)]
    ties = (np.sort(distances, axis=2)[..., 1] == distances.min(axis=2))[..., None]
    assert ((filled == nearest) | ties).mean() > 0.99  # jump flooding errs now and then
    np.testing.assert_array_equal(filled[known], values[known])
    assert not fill_nearest(values, np.zeros_like(known)).any()
    np.testing.assert_array_equal(fill_nearest(values[:1, :1], np.ones((1, 1), bool)), values[:1, :1])
