# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Lux."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.measure.photometry import illuminance


def test_white_light_in_both_kinds_of_scene() -> None:
    white = np.ones((2, 3))
    assert illuminance(white, photometric=True) == pytest.approx([1, 1])
    assert illuminance(white, photometric=False) == pytest.approx([179, 179])


def test_colours_count_by_their_luminance() -> None:
    assert illuminance(np.eye(3), photometric=True) == pytest.approx([0.2126, 0.7152, 0.0722])
