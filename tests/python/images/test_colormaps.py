# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Colours of error maps."""

from __future__ import annotations

import numpy as np

from eclat.images.colormaps import AMOUNT, NOT_A_NUMBER, SIGNED, colored
from eclat.measure.photometry import LUMINANCE


def test_signed_map_is_light_in_the_middle_and_dark_at_both_ends() -> None:
    colors = colored([-1.0, 0.0, 1.0], SIGNED)
    low, middle, high = colors @ LUMINANCE
    assert middle > 240 and abs(low - high) < 25 and max(low, high) < 60
    assert colors[0, 2] > colors[0, 0] and colors[2, 0] > colors[2, 2]


def test_the_colormap_of_amounts_gets_brighter_monotonically() -> None:
    brightness = colored(np.linspace(0, 1, 101), AMOUNT) @ LUMINANCE
    assert (np.diff(brightness) > -0.5).all()
    assert brightness[-1] > 240


def test_beyond_the_ends_and_not_a_number() -> None:
    colors = colored([-9.0, 9.0, np.inf, np.nan], SIGNED)
    assert [tuple(color) for color in colors] == [(5, 30, 110), (120, 10, 25), (120, 10, 25), NOT_A_NUMBER]


def test_shape_follows_the_numbers() -> None:
    assert colored(np.zeros((2, 5)), AMOUNT).shape == (2, 5, 3)
