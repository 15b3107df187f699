# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Options refuse what they cannot mean, in words that say what they can."""

from __future__ import annotations

import numpy as np
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
        ("irradiance-cache", {"max_error": "small"}, "IrradianceCache: max_error must be a number, got 'small'"),
        ("irradiance-cache", {"rows": 2.5}, "IrradianceCache: rows must be a whole number or None, got 2.5"),
        ("irradiance-cache", {"rows": True}, "rows must be a whole number or None, got True"),
        ("irradiance-cache", {"rotation_gradient": 1}, "rotation_gradient must be True or False, got 1"),
        ("irradiance-cache", {"far_spacing": None}, "far_spacing must be a number, got None"),
        ("radiance-cache", {"order": "ten"}, "RadianceCache: order must be a whole number, got 'ten'"),
        ("photon-map", {"photons": 1e5}, "PhotonMap: photons must be a whole number, got 100000.0"),
        ("radiosity", {"patches": [1]}, "Radiosity: patches must be a whole number, got [1]"),
        ("path", {"roulette_depth": 5.0}, "Path: roulette_depth must be a whole number, got 5.0"),
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


def test_unknown_names_suggest_similar_ones() -> None:
    with pytest.raises(EclatError, match="did you mean 'path'"):
        make_options("pat")
    with pytest.raises(EclatError, match="unknown option max_eror for irradiance-cache; did you mean 'max_error'"):
        make_options("irradiance-cache", max_eror=0.1)


def test_numbers_of_numpy_become_pythons() -> None:
    options = make_options("irradiance-cache", rows=np.int64(9), spacing=np.float32(0.5))
    assert (type(options.rows), type(options.spacing)) == (int, float)
    assert options.rows == 9 and options.spacing == 0.5
