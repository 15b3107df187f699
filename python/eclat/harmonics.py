# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Functions of direction as coefficients of real harmonics: evaluate, project, fit, rotate, window, reconstruct.

`basis` is "spherical" (orthonormal on the sphere) or "hemispherical" (orthonormal on z ≥ 0, 0 below; Gautron et al.
2004). Order n means n bands, n² coefficients; that of (l, m) stands at l² + l + m, m > 0 with √2 cos mφ, m < 0 with
√2 sin |m|φ, without Condon–Shortley phase. Directions are (N, 3) unit vectors. All computation is in double precision.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat import _core
from eclat.errors import EclatError, did_you_mean

Basis = Literal["spherical", "hemispherical"]
Window = Literal["hanning", "lanczos"]
Domain = Literal["sphere", "hemisphere"]
Horizon = Literal["continued", "dark"]
Doubles = NDArray[np.float64]

MAX_ORDER = int(_core.max_harmonic_order)

_BASES = {"spherical": _core.Basis.spherical, "hemispherical": _core.Basis.hemispherical}
_HORIZONS = {"continued": _core.Horizon.continued, "dark": _core.Horizon.dark}
_WINDOWS = {"hanning": _core.Window.hanning, "lanczos": _core.Window.lanczos}


def evaluate(basis: Basis, order: int, directions: ArrayLike) -> Doubles:
    """Values of all harmonics of `order` in each direction: (N, order²).

    Hemispherical harmonics are 0 below the horizon.

    Examples
    --------
    >>> evaluate("spherical", 2, [[0, 0, 1]]).round(4)  # √(1/4π), and √(3/4π) (y, z, x)
    array([[0.2821, 0.    , 0.4886, 0.    ]])
    """
    return np.asarray(_core.evaluate_harmonics(_basis(basis), _order(order), _directions(directions)))


def quadrature(count: int, domain: Domain = "hemisphere") -> tuple[Doubles, Doubles]:
    """Directions (N, 3) and weights (N,) in sr, N = 2 count², for integrals over the sphere or over z ≥ 0.

    `count` Gauss–Legendre heights (of cosθ on the sphere; of √cosθ on the hemisphere, so that lobes along the surface
    and hemispherical harmonics are smooth) times 2 `count` azimuths. Harmonics up to order `count` come out orthonormal
    to rounding on the sphere; on the hemisphere take twice as many.

    Examples
    --------
    >>> directions, weights = quadrature(16)
    >>> bool(np.isclose(weights @ directions[:, 2], np.pi))  # irradiance of a sky of radiance 1
    True
    """
    if domain not in get_args(Domain):
        raise EclatError(f"domain must be one of {', '.join(get_args(Domain))}, got {domain!r}")
    if count < 1:
        raise EclatError(f"count must be at least 1, got {count}")
    x, weight = np.polynomial.legendre.leggauss(count)
    if domain == "hemisphere":
        x, weight = (x + 1) / 2, weight / 2
        x, weight = x * x, 2 * x * weight
    phi = np.pi * (np.arange(2 * count) + 0.5) / count
    sine = np.sqrt(1 - x * x)
    directions = np.empty((count, 2 * count, 3))
    directions[..., 0] = sine[:, None] * np.cos(phi)
    directions[..., 1] = sine[:, None] * np.sin(phi)
    directions[..., 2] = x[:, None]
    return directions.reshape(-1, 3), np.repeat(weight * np.pi / count, 2 * count)


def project(
    basis: Basis, order: int, directions: ArrayLike, values: ArrayLike, weights: ArrayLike | None = None
) -> Doubles:
    """The inner products with all harmonics, Σ weight · value · harmonic, shape (order²,) or (order², C).

    Parameters
    ----------
    values : (N,) or (N, C), the function in each direction.
    weights : (N,) in sr: those of a quadrature, or 1 / (N · density) of random directions. None is 2π / N, that of
        directions spread evenly over the hemisphere.

    Examples
    --------
    >>> directions, weights = quadrature(16)
    >>> sky = project("hemispherical", 4, directions, np.ones(len(directions)), weights)
    >>> bool(np.isclose(sky[0], np.sqrt(2 * np.pi)))  # all others are 0
    True
    """
    w = _directions(directions)
    f, one_channel = _channels("values", values, len(w))
    d = np.full(len(w), 2 * np.pi / max(len(w), 1)) if weights is None else np.ascontiguousarray(weights, np.float64)
    if d.shape != (len(w),) or not np.isfinite(d).all():
        raise EclatError(f"weights must be {len(w)} finite numbers, one a direction, got shape {d.shape}")
    return _result(_core.project_harmonics(_basis(basis), _order(order), w, f, d), one_channel)


def fit(inner_products: ArrayLike, tikhonov: float = 1e-6) -> Doubles:
    """The spherical coefficients of the best fit on the hemisphere, from inner products over it. The shape stays.

    `project("spherical", …)` over the hemisphere gives coefficients of a function that is 0 below the horizon; its step
    there costs accuracy. A least-squares fit leaves the lower half free; `tikhonov` times the squared norm of the
    coefficients is added to keep it bounded. It is the best of the three representations for lobes along the surface.

    Examples
    --------
    >>> directions, weights = quadrature(16)
    >>> ones = project("spherical", 3, directions, np.ones(len(directions)), weights)
    >>> fit(ones).round(3) + 0.0  # √4π: the constant, below the horizon too
    array([3.545, 0.   , 0.   , 0.   , 0.   , 0.   , 0.   , 0.   , 0.   ])
    """
    c, one_channel, order = _coefficients(inner_products)
    if not (tikhonov >= 0 and np.isfinite(tikhonov)):
        raise EclatError(f"tikhonov must be a finite number ≥ 0, got {tikhonov}")
    try:
        return _result(_core.fit_hemisphere(order, tikhonov, c), one_channel)
    except ValueError as error:
        raise EclatError(str(error)) from None


def reconstruct(basis: Basis, coefficients: ArrayLike, directions: ArrayLike) -> Doubles:
    """The sum of coefficients times harmonics in each direction: (N,) or (N, C).

    Examples
    --------
    >>> reconstruct("spherical", [np.sqrt(4 * np.pi)], [[0, 0, 1], [1, 0, 0]])
    array([1., 1.])
    """
    c, one_channel, order = _coefficients(coefficients)
    return _result(_core.reconstruct_harmonics(_basis(basis), order, c, _directions(directions)), one_channel)


def window(kind: Window, coefficients: ArrayLike) -> Doubles:
    """Coefficients with a factor for each band that reduces ringing. The factor of band 0 is 1, which keeps the mean.

    "hanning" is (1 + cos πl/n) / 2, "lanczos" is sin(πl/n) / (πl/n). Use it for lighting in an orthonormal basis, not
    for BRDFs or for the inputs and outputs of `fit`.

    Examples
    --------
    >>> window("hanning", [1.0, 1.0, 1.0, 1.0])
    array([1. , 0.5, 0.5, 0.5])
    """
    if kind not in _WINDOWS:
        raise EclatError(
            f"window must be one of {', '.join(_WINDOWS)}, got {kind!r}{did_you_mean(str(kind), _WINDOWS)}"
        )
    c, one_channel, order = _coefficients(coefficients)
    return _result(_core.window_harmonics(_WINDOWS[kind], order, c), one_channel)


def rotate(
    basis: Basis,
    coefficients: ArrayLike,
    rotation: ArrayLike,
    *,
    horizon: Horizon = "continued",
    spherical_order: int | None = None,
    tolerance: float = 0.0,
) -> Doubles:
    """Coefficients of w ↦ f(Rᵀ w) from those of f: same shape.

    Parameters
    ----------
    rotation : (3, 3) rotation matrix R.
    horizon : hemispherical basis only: the values that rise above the horizon if R tilts z. "continued" continues the
        function smoothly, which is good for tilts up to about 0.2 rad. "dark" is 0, as in Gautron et al. 2004. Both
        lose accuracy (docs/algorithms/radiance_cache.md says how much); only turns about z are exact.
    spherical_order : hemispherical basis only: order of the spherical harmonics used in between; by default the order +
        2 for "continued", twice the order for "dark".
    tolerance : spherical basis only: above 0, use a series that stops at this relative error; faster for single vectors
        where R tilts z by little.

    Examples
    --------
    >>> quarter_turn_about_z = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    >>> rotate("spherical", [0.0, 0.0, 0.0, 1.0], quarter_turn_about_z)  # x becomes y
    array([0., 1., 0., 0.])
    """
    kind = _basis(basis)
    if horizon not in _HORIZONS:
        raise EclatError(f"horizon must be one of {', '.join(_HORIZONS)}, got {horizon!r}")
    c, one_channel, order = _coefficients(coefficients)
    R = np.asarray(rotation, np.float64)
    if R.shape != (3, 3):
        raise EclatError(f"rotation must have shape (3, 3), got {R.shape}")
    flat = tuple(float(x) for x in R.ravel())
    try:
        if kind == _core.Basis.spherical:
            if tolerance > 0:
                return _result(_core.rotate_by_tilt(order, flat, tolerance, c), one_channel)
            return _result(_core.rotate_spherical(order, flat, c), one_channel)
        through = 0 if spherical_order is None else _order(spherical_order)
        return _result(_core.rotate_hemispherical(order, flat, _HORIZONS[horizon], through, c), one_channel)
    except ValueError as error:
        raise EclatError(str(error)) from None


def _basis(basis: str) -> _core.Basis:
    if basis not in _BASES:
        raise EclatError(f"basis must be one of {', '.join(_BASES)}, got {basis!r}{did_you_mean(str(basis), _BASES)}")
    return _BASES[basis]


def _order(order: int) -> int:
    if not 1 <= order <= MAX_ORDER:
        raise EclatError(f"order must be in [1, {MAX_ORDER}], got {order}")
    return int(order)


def _directions(directions: ArrayLike) -> Doubles:
    w = np.ascontiguousarray(directions, np.float64)
    if w.ndim != 2 or w.shape[1] != 3:
        raise EclatError(f"directions must have shape (N, 3), got {w.shape}")
    wrong = np.flatnonzero(~(np.abs(np.einsum("ij,ij->i", w, w) - 1) <= 1e-5))
    if len(wrong):
        raise EclatError(f"directions must be unit vectors, got {w[wrong[0]].tolist()} at index {wrong[0]}")
    return w


def _channels(name: str, values: ArrayLike, count: int | None = None) -> tuple[Doubles, bool]:
    """(N, C), and whether it was (N,)."""
    f = np.ascontiguousarray(values, np.float64)
    if f.ndim not in (1, 2) or (count is not None and len(f) != count):
        expected = "" if count is None else f" for {count} directions"
        raise EclatError(f"{name} must have shape (N,) or (N, C){expected}, got {f.shape}")
    if not np.isfinite(f).all():
        raise EclatError(f"{name} must be finite")
    return f.reshape(len(f), -1), f.ndim == 1


def _coefficients(values: ArrayLike) -> tuple[Doubles, bool, int]:
    """(order², C), whether it was (order²,), and the order."""
    c, one_channel = _channels("coefficients", values)
    order = round(len(c) ** 0.5)
    if order * order != len(c) or not 1 <= order <= MAX_ORDER:
        raise EclatError(f"coefficients must be order² of them with order in [1, {MAX_ORDER}], got {len(c)}")
    return c, one_channel, order


def _result(values: NDArray[np.float64], one_channel: bool) -> Doubles:
    out = np.asarray(values)
    return out[:, 0] if one_channel else out
