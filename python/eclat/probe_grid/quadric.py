# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Irradiance from the nine coefficients of a probe, which is a quadric of the normal, and windows against its negative
lobes.

The coefficients of incident radiance are in the order of `eclat.harmonics`: (l, m) stands at l² + l + m. The irradiance
on a surface with the unit normal n is E(n) = Σ A_l c_lm Y_lm(n) [RamamoorthiHanrahan01], in which bands 0 to 2
hold nearly all light: nine numbers, of degree 2 in n.
"""

from __future__ import annotations

import math
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from eclat import harmonics
from eclat.errors import EclatError, did_you_mean
from eclat.scene import FloatArray

Window = Literal["none", "nonnegative", "sloan", "hanning", "lanczos"]
"""What keeps irradiance from negative lobes: nothing; for each probe by itself the least share of its mean, or the weakest
window of [Sloan08], without negative irradiance; or a fixed window."""

ORDER = 3
"""Number of bands of a probe."""
COUNT = ORDER**2
"""Number of coefficients of a probe, for each channel."""

COSINE_LOBE = (math.pi, 2 * math.pi / 3, math.pi / 4, 0.0, -math.pi / 24, 0.0, math.pi / 64)
"""The factors A_l of the bands l = 0, 1, …: the clamped cosine as a zonal function [RamamoorthiHanrahan01]."""

BANDS = np.array([0, 1, 1, 1, 2, 2, 2, 2, 2])
"""The band l of each coefficient."""

_BISECTIONS = 60
"""Halvings of an interval of floats, after which its ends agree to the last bits."""
_STRONGEST = 2.0**20
"""A λ at which no more than a 4-millionth of band 1 is left."""


def irradiance_of(coefficients: FloatArray, normals: FloatArray) -> FloatArray:
    """Compute the irradiance (N, 3) on surfaces with the unit `normals` (N, 3) from coefficients (N, 9, 3) of incident
    radiance."""
    shown = harmonics.evaluate("spherical", ORDER, normals) * np.take(COSINE_LOBE, BANDS)
    found: FloatArray = np.einsum("ni,nic->nc", shown, np.asarray(coefficients, np.float64))
    return found


def least_irradiance(coefficients: FloatArray) -> FloatArray:
    """Compute the least irradiance over all unit normals, (N, 3), from coefficients (N, 9, 3).

    E(n) = q + b · n + nᵀ A n on the unit sphere is the trust-region problem, which has no duality gap: its least value is
    q + max over μ ≤ λ₁ of μ − ¼ Σ β_i² / (λ_i − μ), where λ_i are the eigenvalues of A, λ₁ the least, and β_i the parts
    of b along their eigenvectors. The function of μ is concave, and its slope is 0 where 4 = Σ β_i² / (λ_i − μ)².
    """
    e = np.moveaxis(np.asarray(coefficients, np.float64), 1, 2) * np.take(COSINE_LOBE, BANDS)  # (N, 3, 9)
    k0, k1, k2 = (math.sqrt(n / (4 * math.pi)) for n in (1, 3, 15))
    k3, k4 = math.sqrt(5 / (16 * math.pi)), math.sqrt(15 / (16 * math.pi))
    q = k0 * e[..., 0] - k3 * e[..., 6]
    b = k1 * e[..., (3, 1, 2)]
    xy, yz, xz = (0.5 * k2 * e[..., i] for i in (4, 5, 7))
    A = np.stack(
        [
            np.stack([k4 * e[..., 8], xy, xz], -1),
            np.stack([xy, -k4 * e[..., 8], yz], -1),
            np.stack([xz, yz, 3 * k3 * e[..., 6]], -1),
        ],
        -2,
    )
    values, vectors = np.linalg.eigh(A)
    beta = np.einsum("...ji,...j->...i", vectors, b)
    length = np.linalg.norm(b, axis=-1)
    # With μ = λ₁ − t, the slope is positive at t = |b| / 2 and falls with μ.
    gaps = values - values[..., :1]
    near, far = np.zeros_like(length), 0.5 * length
    for _ in range(_BISECTIONS):
        t = 0.5 * (near + far)
        with np.errstate(divide="ignore", invalid="ignore"):
            steep = np.nansum((beta / (gaps + t[..., None])) ** 2, axis=-1) > 4
        near, far = np.where(steep, t, near), np.where(steep, far, t)
    with np.errstate(divide="ignore", invalid="ignore"):
        lost = np.where(beta == 0, 0.0, beta**2 / (gaps + far[..., None]))
    least: FloatArray = q + values[..., 0] - far - 0.25 * lost.sum(axis=-1)
    return least


def windowed(coefficients: FloatArray, window: Window) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Apply a window to coefficients (N, 9, 3); return them, and a mask (N,) of the probes that it changed."""
    c = np.asarray(coefficients, np.float64)
    if window == "none":
        return c, np.zeros(len(c), bool)
    if window == "nonnegative":
        share = shares_of_variation(c)
        return c * np.where(BANDS == 0, 1.0, share[:, None])[..., None], share < 1
    if window == "sloan":
        strength = least_strengths(c)
        return c * factors(strength)[..., None], strength > 0
    flat = harmonics.window(window, np.moveaxis(c, 1, 0).reshape(COUNT, -1))
    return np.moveaxis(flat.reshape(COUNT, len(c), 3), 0, 1), np.ones(len(c), bool)


def shares_of_variation(coefficients: FloatArray) -> FloatArray:
    """Compute for each probe the greatest share s (N,), at most 1, of bands 1 and 2 with which no channel has negative
    irradiance.

    Band 0 is the mean m over all normals, so that the least irradiance becomes m + s (least − m). One share for all
    channels keeps the colour.
    """
    mean = np.asarray(coefficients, np.float64)[:, 0] * COSINE_LOBE[0] / math.sqrt(4 * math.pi)
    least = least_irradiance(coefficients)
    share = np.divide(mean, mean - least, out=np.ones_like(mean), where=least < 0)
    found: FloatArray = np.clip(share, 0, 1).min(axis=1)
    return found


def factors(strength: FloatArray) -> FloatArray:
    """Compute the factors (N, 9) of the window 1 / (1 + λ l² (l + 1)²) [Sloan08] for the `strength` λ (N,).

    Of all functions near the given one, in the mean square, this window makes the smoothest, by its squared Laplacian.
    """
    found: FloatArray = 1 / (1 + np.asarray(strength)[:, None] * (BANDS * (BANDS + 1.0)) ** 2)
    return found


def least_strengths(coefficients: FloatArray) -> FloatArray:
    """Find for each probe the least λ (N,) with which no channel has negative irradiance; one λ for all channels keeps the
    colour."""
    negative = (least_irradiance(coefficients) < 0).any(axis=1)
    strength = np.zeros(len(coefficients))
    c = np.asarray(coefficients, np.float64)[negative]
    low, high = np.zeros(len(c)), np.full(len(c), _STRONGEST)
    for _ in range(_BISECTIONS):
        # The first steps are by magnitude, because most windows are weak: λ is about 10⁻³.
        middle = np.where(low > 0, np.sqrt(low * high), high * 2.0**-6)
        middle = np.where(middle < 2.0**-40, 0.5 * (low + high), middle)
        bad = (least_irradiance(c * factors(middle)[..., None]) < 0).any(axis=1)
        low, high = np.where(bad, middle, low), np.where(bad, high, middle)
    strength[negative] = high
    return strength


def check_window(window: str) -> None:
    """Raise EclatError for an unknown window."""
    known = get_args(Window)
    if window not in known:
        raise EclatError(f"window must be one of {', '.join(known)}, got {window!r}{did_you_mean(window, known)}")
