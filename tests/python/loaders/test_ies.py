# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Photometric files: LM-63 as it is and as it should not be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatWarning
from eclat.intensity_profile import IntensityProfile
from eclat.loaders.ies import encode_ies, parse_ies
from support.luminaires import DOWNLIGHT, cosine_lamp, lopsided_lamp


def parsed(text: str) -> IntensityProfile:
    return parse_ies(text.encode(), "lamp.ies")


def test_a_file_with_its_multipliers(tmp_path: Path) -> None:
    (tmp_path / "lamp.ies").write_text(DOWNLIGHT)
    profile = eclat.load_ies(tmp_path / "lamp.ies")
    assert (profile.photometry, profile.name) == ("C", "lamp")
    np.testing.assert_array_equal(profile.vertical, [0, 30, 60, 90])
    np.testing.assert_array_equal(profile.horizontal, [0, 45, 90])
    np.testing.assert_allclose(np.asarray(profile.candela)[1], [200, 160, 80, 0])


def test_the_first_format_and_utf_16() -> None:
    old = DOWNLIGHT.partition("\n")[2].partition("\n")[2]  # without a version and a keyword
    np.testing.assert_array_equal(parsed(old).candela, parsed(DOWNLIGHT).candela)
    np.testing.assert_array_equal(parse_ies(DOWNLIGHT.encode("utf-16"), "a").candela, parsed(DOWNLIGHT).candela)


def test_tilt_is_skipped_with_a_warning() -> None:
    tilted = DOWNLIGHT.replace("TILT=NONE", "TILT=INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8")
    with pytest.warns(EclatWarning, match="the tilt of the lamp .* is not supported and is ignored"):
        np.testing.assert_array_equal(parsed(tilted).candela, parsed(DOWNLIGHT).candela)


@pytest.mark.parametrize("photometry", ["A", "B", "C"])
def test_profiles_that_are_written_are_read_again(photometry: str) -> None:
    angles = np.arange(0, 91, 4.5)
    candela = np.random.default_rng(2).random((len(angles), len(angles))) * 1000
    profile = IntensityProfile(photometry, angles, angles, candela, "lamp")  # type: ignore[arg-type]
    text = encode_ies(profile)
    assert max(map(len, text.splitlines())) <= 132
    again = parse_ies(text, "lamp.ies")
    assert again.photometry == photometry
    np.testing.assert_allclose(again.candela, candela, rtol=1e-8)
    assert parse_ies(encode_ies(lopsided_lamp()), "a").flux == pytest.approx(lopsided_lamp().flux)
    assert parse_ies(encode_ies(cosine_lamp()), "a").flux == pytest.approx(cosine_lamp().flux)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("TILT=NONE", "", "expected a photometric file .LM-63. with a line TILT=, got none"),
        ("2.5 4 3 1", "2.5 4 3 7", "expected the photometric type 1 .C., 2 .B. or 3 .A., got 7"),
        ("2.5 4 3 1", "2.5 4e9 3 1", "expected a number of vertical angles that fits the file, got 4e.09"),
        ("2.5 4 3 1", "2.5 4 0 1", "expected a number of horizontal angles that fits the file, got 0"),
        ("2.5 4 3 1", "2.5 4 6 1", "numbers as"),
        ("100 70 30 0", "100 70", "expected 12 numbers as candela values, got 10"),
        ("100 70 30 0", "100 x 30 0", "expected numbers as candela values, got"),
        ("100 70 30 0", "100 nan 30 0", "expected finite numbers as candela values"),
        ("0 30, 60 90", "0 60, 30 90", "lamp: expected ascending vertical angles"),
        ("2.5 4", "-2.5 4", "expected multipliers of at least 0"),
    ],
)
def test_damage(old: str, new: str, message: str) -> None:
    with pytest.raises(eclat.EclatError, match=message):
        parsed(DOWNLIGHT.replace(old, new))


def test_negative_candela_are_replaced() -> None:
    with pytest.warns(EclatWarning, match="negative candela values are replaced by 0"):
        assert np.asarray(parsed(DOWNLIGHT.replace("100 70 30 0", "100 70 -30 0")).candela).min() == 0
