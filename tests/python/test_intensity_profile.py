# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles of luminaires: their three coordinate systems, symmetries and flux by closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.interpolate

import eclat
from eclat.intensity_profile import IntensityProfile
from support.luminaires import cosine_lamp, lopsided_lamp


def towards(profile: IntensityProfile, w: np.ndarray) -> float:
    """The intensity towards a direction of the luminaire's frame, by SciPy's interpolation on the unfolded grid."""
    grid = profile.grid()
    x, y, z = grid.axes @ w
    polar, azimuth = np.degrees(np.arctan2(np.hypot(x, y), z)), np.degrees(np.arctan2(y, x))
    turns = [a for a in (azimuth - 360, azimuth, azimuth + 360) if grid.azimuth[0] <= a <= grid.azimuth[-1]]
    if not turns or not grid.polar[0] <= polar <= grid.polar[-1]:
        return 0.0
    at = scipy.interpolate.RegularGridInterpolator((grid.polar, grid.azimuth), grid.values)
    return float(at((polar, turns[0])))


def test_flux_in_closed_form() -> None:
    assert cosine_lamp().flux == pytest.approx(100 * np.pi, rel=1e-4)
    # ∫ sin³ is 4/3, and the mean over H is 1.
    assert lopsided_lamp().flux == pytest.approx(100 * 2 * np.pi * 4 / 3, rel=1e-3)


@pytest.mark.parametrize("photometry", ["A", "B"])
def test_flux_of_types_a_and_b(photometry: Any) -> None:
    # I = 100 sin θ from the pole, over a half turn: 100 π ∫ sin² θ dθ = 50 π². In A the pole is vertical, so that θ is 90° − V;
    # in B it is horizontal, so that θ is 90° − H.
    angles = np.arange(-90, 91, 2.0)
    latitude = 100 * np.cos(np.radians(angles))
    candela = np.tile(latitude, (len(angles), 1))
    profile = IntensityProfile(photometry, angles, angles, candela if photometry == "A" else candela.T)
    assert profile.flux == pytest.approx(50 * np.pi**2, rel=1e-3)
    folded = IntensityProfile(photometry, angles[45:], angles[45:], np.asarray(profile.candela)[45:, 45:])
    assert folded.flux == pytest.approx(profile.flux, rel=1e-9)


def test_directions_of_the_three_types() -> None:
    down, up, right = np.array([0, 0, -1.0]), np.array([1.0, 0, 0]), np.array([0, -1.0, 0])
    d = np.degrees
    slant = np.array([0.3, -0.5, -0.8]) / np.linalg.norm([0.3, -0.5, -0.8])
    angles = np.arange(-90, 91, 5.0)
    vertical, horizontal = np.meshgrid(angles, angles)  # rows are horizontal angles
    for photometry, v, h in (
        ("A", d(np.arcsin(slant[0])), d(np.arctan2(-slant[1], -slant[2]))),  # V is a latitude above the horizon
        ("B", d(np.arctan2(slant[0], -slant[2])), d(np.arcsin(-slant[1]))),  # H is a latitude beside the vertical plane
    ):
        profile = IntensityProfile(photometry, angles, angles, 1000 + 3 * vertical + horizontal)  # type: ignore[arg-type]
        assert towards(profile, slant) == pytest.approx(1000 + 3 * v + h, rel=1e-6)
        assert towards(profile, down) == pytest.approx(1000)
        assert towards(profile, (up + down) / 2**0.5) == pytest.approx(1000 + 3 * 45)
        assert towards(profile, (right + down) / 2**0.5) == pytest.approx(1000 + 45)
        assert towards(profile, np.array([0.1, 0.1, 0.9])) == 0
    c = lopsided_lamp()
    assert towards(c, np.array([1.0, 0, 0])) == pytest.approx(150)  # H = 0 is +x
    assert towards(c, np.array([0, 1.0, 0])) == pytest.approx(125)  # H = 90 is +y
    assert towards(c, down) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("kept", "same"),
    [
        ([0, 30, 90], lambda h: h if h <= 90 else 180 - h if h <= 180 else h - 180 if h <= 270 else 360 - h),
        ([0, 45, 180], lambda h: h if h <= 180 else 360 - h),
        ([90, 200, 270], lambda h: h if 90 <= h <= 270 else 180 - h if h < 90 else 540 - h),
        ([0, 100, 250, 360], lambda h: h),
        ([0, 100, 250], lambda h: h),
        ([0], lambda h: 0),
    ],
)
def test_symmetries_of_type_c(kept: list[float], same: Any) -> None:
    rows = np.array([[10.0 + i, 10.0 + i] for i in range(len(kept))])
    if kept[-1] == 360:
        rows[-1] = rows[0]
    profile = IntensityProfile("C", [0, 180], kept, rows)
    closed = kept if kept[-1] != 250 else [*kept, 360]
    values = rows[:, 0] if kept[-1] != 250 else [*rows[:, 0], rows[0, 0]]
    for h in np.arange(2, 360, 17.0):
        w = np.array([np.cos(np.radians(h)), np.sin(np.radians(h)), 0])
        assert towards(profile, w) == pytest.approx(np.interp(same(h), closed, values)), h


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("D", [0, 90], [0], [[1, 1]]), "expected photometry of type A, B or C, got 'D'"),
        (("C", [0, 90], [0], [[1, 1, 1]]), r"shapes \(V,\), \(H,\) and \(H, V\), got \(2,\), \(1,\) and \(1, 3\)"),
        (("C", [0], [0], [[1]]), "at least two vertical angles"),
        (("C", [90, 0], [0], [[1, 1]]), "ascending vertical angles"),
        (("C", [-90, 90], [0], [[1, 1]]), "vertical angles from 0 to 180 in type C, got -90 to 90"),
        (("C", [0, 90], [0, 120], [[1, 1]] * 2), "expected horizontal angles 0, 0 to 90"),
        (("B", [0, 80], [0, 90], [[1, 1]] * 2), "expected vertical angles from −90 or 0 to 90 in type B, got 0 to 80"),
        (("C", [0, 90], [0], [[1, -1]]), "intensities that are finite and at least 0"),
        (("C", [0, 90], [0], [["a", 1]]), "expected an array of numbers as candela"),
    ],
)
def test_mistakes(arguments: Any, message: str) -> None:
    with pytest.raises(eclat.EclatError, match=message):
        IntensityProfile(*arguments)


def test_repr_is_short() -> None:
    assert repr(cosine_lamp()) == "<IntensityProfile 'cosine': type C, 91×1 angles, 314.2 lm>"
