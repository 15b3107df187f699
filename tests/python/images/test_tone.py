# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The way to the screen: transfer function, tone curve, rounding."""

from __future__ import annotations

import math

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat.images.tone import (
    MID_GREY,
    NOT_FINITE,
    auto_exposure,
    exposure_stops,
    filmic,
    srgb_decode,
    srgb_encode,
    to_display,
)


@pytest.mark.parametrize(
    ("linear", "encoded"),
    # Computed by hand from IEC 61966-2-1: the black level's slope, both sides of the joint, mid grey, white.
    [(0.0, 0.0), (0.001, 0.01292), (0.0031308, 0.04045), (0.18, 0.46135613), (0.5, 0.73535698), (1.0, 1.0)],
)
def test_values_agree_with_the_standard(linear: float, encoded: float) -> None:
    assert srgb_encode(np.array(linear)) == pytest.approx(encoded, abs=2e-6)
    assert srgb_decode(np.array(encoded)) == pytest.approx(linear, abs=2e-6)


def test_decoding_undoes_encoding() -> None:
    values = np.linspace(0, 1, 1001)
    np.testing.assert_allclose(srgb_decode(srgb_encode(values)), values, atol=1e-7)


def test_all_bytes_survive_a_round_trip() -> None:
    grey = np.arange(256, dtype=np.float64) / 255
    pixels = np.repeat(srgb_decode(grey)[None, :, None], 3, axis=2)
    np.testing.assert_array_equal(to_display(pixels)[0, :, 0], np.arange(256))


def test_values_outside_are_clipped() -> None:
    pixels = np.array([[[-1.0, 0.0, 7.0]]])
    np.testing.assert_array_equal(to_display(pixels), [[[0, 0, 255]]])


def test_a_stop_is_a_factor_of_two() -> None:
    pixels = np.array([[[0.05, 0.1, 0.2]]])
    np.testing.assert_array_equal(to_display(pixels, exposure=1.0), to_display(2 * pixels))
    np.testing.assert_array_equal(to_display(pixels, exposure=-0.5), to_display(pixels / math.sqrt(2)))


def test_filmic_keeps_mid_grey_and_its_contrast() -> None:
    assert filmic(np.array(MID_GREY)) == pytest.approx(MID_GREY, rel=1e-12)
    step = 1e-6
    slope = (np.log(filmic(np.array(MID_GREY * (1 + step)))) - np.log(filmic(np.array(MID_GREY * (1 - step))))) / (
        np.log1p(step) - np.log1p(-step)
    )
    assert slope == pytest.approx(1.0, abs=1e-6)


def test_filmic_grows_from_black_to_white_without_reaching_it() -> None:
    values = filmic(np.concatenate([[0.0], np.geomspace(1e-6, 1e4, 500)]))
    assert values[0] == 0
    assert (np.diff(values) > 0).all()
    assert values[-1] < 1
    # A toe: dark tones get darker. A shoulder: four stops over mid grey are not yet white.
    assert filmic(np.array(0.01)) < 0.01
    assert 0.8 < filmic(np.array(MID_GREY * 16)) < 0.9


def test_filmic_of_the_largest_float_is_white_without_overflow() -> None:
    with np.errstate(all="raise"):
        assert filmic(np.array(np.finfo(np.float32).max)) == pytest.approx(1.0)
        assert filmic(np.array(-1.0)) == 0


def test_pixels_that_are_not_finite_are_magenta() -> None:
    pixels = np.zeros((1, 4, 3))
    pixels[0, 0, 1], pixels[0, 1, 0], pixels[0, 2, 2] = math.nan, math.inf, -math.inf
    shown = to_display(pixels, tone_mapping="filmic")
    assert [tuple(pixel) for pixel in shown[0]] == [NOT_FINITE] * 3 + [(0, 0, 0)]


@pytest.mark.parametrize("exposure", [math.nan, math.inf, 65.0])
def test_bad_exposures(exposure: float) -> None:
    with pytest.raises(EclatError) as caught:
        to_display(np.zeros((1, 1, 3)), exposure=exposure)
    assert str(caught.value) == f"exposure: expected a number of stops between −64 and 64, got {exposure}"


def test_an_unknown_tone_mapping_gets_a_hint() -> None:
    with pytest.raises(EclatError) as caught:
        to_display(np.zeros((1, 1, 3)), tone_mapping="filmik")
    assert str(caught.value) == ("tone_mapping: expected one of none, filmic, got 'filmik'; did you mean 'filmic'?")


def test_exposure_takes_the_log_average_to_mid_grey() -> None:
    pixels = np.full((2, 2, 3), 0.18 / 8, dtype=np.float32)
    pixels[0, 0] = 0
    pixels[0, 1] = np.nan
    assert auto_exposure(pixels) == 3.0
    assert auto_exposure(np.zeros((1, 1, 3), dtype=np.float32)) == 0.0
    assert auto_exposure(np.full((1, 1, 3), 1e-37, dtype=np.float32)) == 64.0, "as far as exposure goes"


def test_exposure_accepts_the_word_auto() -> None:
    pixels = np.full((1, 1, 3), 0.09, dtype=np.float32)
    assert exposure_stops("auto", pixels) == 1.0
    assert exposure_stops(-2.5, pixels) == -2.5
    with pytest.raises(EclatError, match="expected a number of stops or 'auto', got 'best'"):
        exposure_stops("best", pixels)  # type: ignore[arg-type]
