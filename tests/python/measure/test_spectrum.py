# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Spectra to linear sRGB, against Mitsuba 3's RGB mode and against facts of the CIE's tables."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat.measure import spectrum

CURVES = [
    ([360.0, 830.0], [0.5, 0.5]),
    ([400.0, 500.0, 600.0, 700.0], [0.1, 0.2, 0.7, 0.6]),
    ([400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0], [0.2, 0.3, 0.4, 0.5, 0.4, 0.3, 0.2]),
    ([400.0, 460.0, 520.0, 700.0], [0.6, 0.5, 0.3, 0.1]),
]


@pytest.mark.parametrize("value", [0.0, 0.2, 1.0])
def test_a_constant_reflectance_is_grey(value: float) -> None:
    assert spectrum.reflectance_to_rgb([300, 900], [value, value]) == pytest.approx((value,) * 3)


def test_the_equal_energy_spectrum_is_x_equals_y_equals_z() -> None:
    assert spectrum.emission_to_rgb([300, 900], [1, 1]) == pytest.approx(spectrum.XYZ_TO_RGB.sum(axis=1))


@pytest.mark.parametrize(("wavelengths", "values"), CURVES)
def test_curves_as_mitsuba_reads_them(wavelengths: list[float], values: list[float]) -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    pairs = ", ".join(f"{w}:{v}" for w, v in zip(wavelengths, values, strict=True))
    color = f'value="{pairs}"/>'
    bsdf = mi.load_string(f'<bsdf version="3.0.0" type="diffuse"><spectrum name="reflectance" {color}</bsdf>')
    expected = np.array(mi.traverse(bsdf)["reflectance.value"])
    assert np.allclose(spectrum.reflectance_to_rgb(wavelengths, values), expected, atol=0.004)
    emitter = mi.load_string(f'<emitter version="3.0.0" type="constant"><spectrum name="radiance" {color}</emitter>')
    interaction = mi.SurfaceInteraction3f()
    interaction.wi = [0, 0, 1]
    assert np.allclose(spectrum.emission_to_rgb(wavelengths, values), emitter.eval(interaction), atol=0.006)


def test_colour_matching_peaks_where_the_cie_has_it() -> None:
    y = spectrum.color_matching(spectrum.WAVELENGTHS)[1]
    assert abs(spectrum.WAVELENGTHS[np.argmax(y)] - 555) < 5
    assert y.max() == pytest.approx(1, abs=0.01)


def test_a_black_body_of_daylights_temperature_is_nearly_white() -> None:
    rgb = np.array(spectrum.blackbody_to_rgb(6504))
    assert np.ptp(rgb) / rgb.mean() < 0.08
    warm = spectrum.blackbody_to_rgb(2700)
    assert warm[0] > warm[1] > warm[2] > 0
    # Y in W·sr⁻¹·m⁻²·nm⁻¹: Planck's formula has 413 at 560 nm.
    assert spectrum.blackbody_to_rgb(3000) @ np.array([0.2127, 0.7152, 0.0722]) == pytest.approx(414, rel=0.02)


def test_srgb_is_decoded_as_the_standard_says() -> None:
    assert spectrum.srgb_to_linear([0, 0.04045, 0.5, 1]) == pytest.approx([0, 0.0031308, 0.2140411, 1], abs=1e-6)


@pytest.mark.parametrize(
    ("wavelengths", "values", "message"),
    [
        ([], [], "as many wavelengths as values, at least one, got 0 and 0"),
        ([400], [1, 2], "got 1 and 2"),
        ([500, 400], [1, 2], "increasing wavelengths, got 500 nm before 400 nm"),
        ([400, 500], [1, float("nan")], "finite"),
    ],
)
def test_invalid_spectra_are_refused(wavelengths: list[float], values: list[float], message: str) -> None:
    with pytest.raises(EclatError, match=message):
        spectrum.emission_to_rgb(wavelengths, values)


def test_a_temperature_below_zero_is_refused() -> None:
    with pytest.raises(EclatError, match="above 0 K, got -3"):
        spectrum.blackbody_to_rgb(-3)
    for cold in (1e-3, 1e-320):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert spectrum.blackbody_to_rgb(cold) == (0, 0, 0)
