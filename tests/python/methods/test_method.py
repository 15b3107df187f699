# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Options refuse what they cannot mean, in words that say what they can."""

from __future__ import annotations

import pytest

from eclat.errors import EclatError
from eclat.methods import METHODS, make_options


@pytest.mark.parametrize("method", METHODS)
def test_defaults_are_within_their_own_ranges(method: str) -> None:
    assert make_options(method).name == method  # or an EclatError names the option


@pytest.mark.parametrize(
    ("method", "settings", "message"),
    [
        ("irradiance-cache", {"max_error": 0}, "IrradianceCache: max_error must be between 0.0005 and 0.5, got 0"),
        ("irradiance-cache", {"max_error": float("nan")}, "max_error must be between"),
        ("irradiance-cache", {"max_error": "small"}, "max_error must be between"),
        ("irradiance-cache", {"least_pixels": 50.0}, "largest_pixels must be between 50 and"),
        ("irradiance-cache", {"weight": "tabelion"}, "did you mean 'tabellion'?"),
        (
            "irradiance-cache",
            {"metric": "median"},
            "metric must be one of occlusion, radiometric, geometric, minimum, harmonic",
        ),
        ("irradiance-cache", {"spacing": 9.0}, "spacing must be between"),
        ("path", {"roulette_depth": 0}, "Path: roulette_depth must be between 1 and"),
    ],
)
def test_values_out_of_range(method: str, settings: dict[str, object], message: str) -> None:
    with pytest.raises(EclatError) as caught:
        make_options(method, **settings)
    assert message in str(caught.value)


def test_unknown_names_are_answered_with_near_ones() -> None:
    with pytest.raises(EclatError, match="did you mean 'path'"):
        make_options("pat")
    with pytest.raises(EclatError, match="unknown option max_eror for irradiance-cache; did you mean 'max_error'"):
        make_options("irradiance-cache", max_eror=0.1)
