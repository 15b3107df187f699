# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Means over windows against sums that are written out, and interpolation against a plane, which it must reproduce."""

from __future__ import annotations

import numpy as np

from eclat.sampling.windows import WINDOW, between_centres, local_means, window_means, window_sums


def test_windows_at_the_border_are_smaller_and_only_pixels_that_count_have_a_part() -> None:
    values = np.arange(15.0).reshape(3, 5)
    np.testing.assert_array_equal(window_sums(values, 2), [[12, 20, 13], [21, 25, 14]])
    counted = (values % 2 == 0).astype(float)
    np.testing.assert_array_equal(window_means(values, counted, 2), [[3, 5, 4], [10, 12, 14]])
    np.testing.assert_array_equal(window_means(values, np.zeros_like(values), 2), np.zeros((2, 3)))


def test_windows_that_do_not_count_have_no_part_in_the_mean_of_their_neighbours() -> None:
    values = np.repeat([1.0, 5.0, 100.0], WINDOW)[None].repeat(WINDOW, axis=0)
    everywhere = np.ones_like(values)
    np.testing.assert_allclose(local_means(values, everywhere), [[8 / 4, 111 / 4, 305 / 4]])
    np.testing.assert_allclose(local_means(values, (values < 100).astype(float)), [[8 / 4, 11 / 3, 5]])


def test_between_the_centres_of_windows_a_plane_is_reproduced_and_beyond_them_the_outermost_value() -> None:
    y, x = np.mgrid[0:3, 0:4].astype(float)
    found = between_centres(2 * x - y, (3 * WINDOW, 4 * WINDOW))
    row, column = np.mgrid[0 : 3 * WINDOW, 0 : 4 * WINDOW]
    across, down = (np.clip((k + 0.5) / WINDOW - 0.5, 0, most) for k, most in ((column, 3), (row, 2)))
    np.testing.assert_allclose(found, 2 * across - down, atol=1e-12)
