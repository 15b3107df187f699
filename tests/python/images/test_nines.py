# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mean, maximum and median of a pixel and its neighbours, against loops over them."""

from __future__ import annotations

import numpy as np

from eclat.images.nines import mean_of_nine, most_of_nine, own_or_median


def test_against_loops() -> None:
    values = np.random.default_rng(4).exponential(size=(5, 4, 3))
    row, column = np.mgrid[0:5, 0:4]
    around = [
        values[np.clip(row + down, 0, 4), np.clip(column + across, 0, 3)]
        for down in (-1, 0, 1)
        for across in (-1, 0, 1)
    ]
    np.testing.assert_allclose(mean_of_nine(values), np.mean(around, axis=0))
    np.testing.assert_array_equal(most_of_nine(values), np.max(around, axis=0))
    pixels = values[..., 0] > 1
    expected = np.maximum(values, np.median(around, axis=0))
    np.testing.assert_array_equal(own_or_median(values, pixels), expected[pixels])
