# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How an estimated error is told."""

from __future__ import annotations

import math

import pytest

from eclat.measure.error_estimate import ErrorEstimate, error_text


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (ErrorEstimate(0.009, 0.008, 0.010), "estimated error 0.9 % ± 0.1 (95 %)"),
        (ErrorEstimate(0.12, 0.10, 0.14), "estimated error 12 % ± 2 (95 %)"),
        (ErrorEstimate(0.36, 0.358, 0.362), "estimated error 36.0 % ± 0.2 (95 %)"),
        (ErrorEstimate(0.005, 0.0, 0.009), "estimated error at most 0.9 % (95 %)"),
        (ErrorEstimate(0.0, 0.0, 0.0), "estimated error 0 % (95 %)"),
        (ErrorEstimate(0.03, 0.02, 0.04, in_one_tile=0.2), "estimated error 3.0 % ± 1.0 (95 %)"),
        (
            ErrorEstimate(0.03, 0.02, 0.04, in_one_tile=0.31),
            "estimated error at least 2 % (95 %), about 3 %: 31 % of its square lies in one place",
        ),
        (
            ErrorEstimate(0.03, 0.02, 0.06, in_one_tile=0.31),
            "estimated error at least 2 % (95 %), perhaps 6 %: 31 % of its square lies in one place",
        ),
        (ErrorEstimate(0.03, 0.0, 0.06, in_one_tile=0.5), "estimated error at most 6 % (95 %)"),
    ],
)
def test_text(estimate: ErrorEstimate, text: str) -> None:
    assert error_text(estimate.statistics()) == text


def test_errors_that_were_not_estimated_are_not_stated() -> None:
    assert error_text({"rays": 1.0}) == ""


def test_noise_of_a_picture_adds_in_squares() -> None:
    assert ErrorEstimate(0.03, 0.0, 0.03).with_noise(0.04) == ErrorEstimate(0.05, 0.04, 0.05)


def test_an_uncertain_estimate_is_quoted_as_its_upper_bound() -> None:
    assert ErrorEstimate(0.01, 0.0, 0.0149).quoted == 0.01
    assert ErrorEstimate(0.01, 0.0, 0.016).quoted == 0.016


@pytest.mark.parametrize("squared", [0.0, -1e-4, -1.0])
def test_a_square_below_zero_states_no_more_certainty_than_zero(squared: float) -> None:
    """Two standard errors below 0 it was stated as 0, with certainty: true errors of 12 % and more stood behind it."""
    estimate = ErrorEstimate.of_squared(squared, 1e-4, 0.0)
    assert (estimate.error, estimate.low) == (0.0, 0.0)
    assert estimate.quoted == estimate.high == pytest.approx((1.96 * 1e-4) ** 0.5)


def test_a_further_deviation_widens_the_interval_of_the_square() -> None:
    known = ErrorEstimate.of_squared(0.01, 0.001, 0.0)
    assert known.less_certain(0.0) == known
    wider = known.less_certain(0.002)
    expected = ErrorEstimate.of_squared(0.01, math.hypot(0.001, 0.002), 0.0)
    assert (wider.error, wider.low, wider.high) == pytest.approx((expected.error, expected.low, expected.high))
    assert known.less_certain(1.0).low == 0
