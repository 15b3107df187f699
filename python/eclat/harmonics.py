# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Functions of direction, represented by coefficients of real spherical or hemispherical harmonics in double precision.

`basis` is "spherical" (orthonormal on the sphere) or "hemispherical" (orthonormal on the hemisphere z ≥ 0 and 0 below
it; Gautron et al. 2004). Order n means n bands and n² coefficients. The coefficient of (l, m) has the index l² + l + m;
the azimuthal factor is √2 cos mφ for m > 0 and √2 sin |m|φ for m < 0, without the Condon–Shortley phase. Directions are
unit vectors (N, 3).
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
"""Largest order of all functions of this module."""

_BASES = {"spherical": _core.Basis.spherical, "hemispherical": _core.Basis.hemispherical}
_HORIZONS = {"continued": _core.Horizon.continued, "dark": _core.Horizon.dark}
_WINDOWS = {"hanning": _core.Window.hanning, "lanczos": _core.Window.lanczos}


def evaluate(basis: Basis, order: int, directions: ArrayLike) -> Doubles:
    """Evaluate all harmonics of degrees below `order` in N directions, as an array (N, order²).

    Hemispherical harmonics are 0 below the horizon.

    Examples
    --------
    >>> evaluate("spherical", 2, [[0, 0, 1]]).round(4)  # √(1/4π), and √(3/4π) (y, z, x)
    array([[0.2821, 0.    , 0.4886, 0.    ]])
    """
    return np.asarray(_core.evaluate_harmonics(_basis(basis), _order(order), _directions(directions)))


def quadrature(count: int, domain: Domain = "hemisphere") -> tuple[Doubles, Doubles]:
    """Make N = 2 count² directions (N, 3) and weights (N,) in sr for integrals over the sphere or over the hemisphere z
    ≥ 0.

    There are 2 `count` azimuths and `count` polar angles. The polar angles are Gauss–Legendre nodes of cosθ on the
    sphere and of √cosθ on the hemisphere, because grazing lobes and hemispherical harmonics are smooth functions of
    √cosθ. On the sphere, harmonics up to order `count` are orthonormal up to rounding errors; on the hemisphere,
    `count` must be twice the order.

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
    """Compute the inner products Σ weight · value · harmonic with all harmonics, of shape (order²,) or (order², C).

    Parameters
    ----------
    values : (N,) or (N, C), the values of the function in each direction.
    weights : (N,) in sr: those of a quadrature, or 1 / (N · density) for random directions. None means 2π / N, for
        directions that are distributed uniformly over the hemisphere.

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
        raise EclatError(f"weights must be {len(w)} finite numbers, one per direction, got shape {d.shape}")
    return _result(_core.project_harmonics(_basis(basis), _order(order), w, f, d), one_channel)


def fit(inner_products: ArrayLike, tikhonov: float = 1e-6) -> Doubles:
    """Compute the spherical coefficients of the least-squares fit on the hemisphere from inner products over the
    hemisphere.

    The result has the shape of `inner_products`. `project("spherical", …)` over the hemisphere gives the coefficients
    of a function that is 0 below the horizon, and its discontinuity there reduces the accuracy. The least-squares fit
    does not constrain the function below the horizon; `tikhonov` times the squared norm of the coefficients is added to
    the squared error to keep it bounded. For grazing lobes, the fit is more accurate than this projection and than the
    hemispherical basis.

    Examples
    --------
    >>> directions, weights = quadrature(16)
    >>> ones = project("spherical", 3, directions, np.ones(len(directions)), weights)
    >>> fit(ones).round(3) + 0.0  # √4π: the constant, below the horizon too
    array([3.545, 0.   , 0.   , 0.   , 0.   , 0.   , 0.   , 0.   , 0.   ])
    """
    c, one_channel, order = _coefficients(inner_products)
    if not (tikhonov >= 0 and np.isfinite(tikhonov)):
        raise EclatError(f"tikhonov must be a finite number of at least 0, got {tikhonov}")
    try:
        return _result(_core.fit_hemisphere(order, tikhonov, c), one_channel)
    except ValueError as error:
        raise EclatError(str(error)) from None


def reconstruct(basis: Basis, coefficients: ArrayLike, directions: ArrayLike) -> Doubles:
    """Evaluate the function that coefficients represent in each direction, (N,) or (N, C).

    Examples
    --------
    >>> reconstruct("spherical", [np.sqrt(4 * np.pi)], [[0, 0, 1], [1, 0, 0]])
    array([1., 1.])
    """
    c, one_channel, order = _coefficients(coefficients)
    return _result(_core.reconstruct_harmonics(_basis(basis), order, c, _directions(directions)), one_channel)


def window(kind: Window, coefficients: ArrayLike) -> Doubles:
    """Multiply the coefficients of each band by a factor that reduces ringing. The factor of band 0 is 1, which keeps
    the mean.

    The factor of band l of n is (1 + cos πl/n) / 2 for "hanning" and sin(πl/n) / (πl/n) for "lanczos". Windows are for
    light in an orthonormal basis, and not for BRDFs or for the inputs and outputs of `fit`.

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
    """Rotate a function: compute the coefficients of w ↦ f(Rᵀ w) from those of f, in the same shape.

    Parameters
    ----------
    rotation : (3, 3) rotation matrix R.
    horizon : for the hemispherical basis: the values of the function below the horizon, parts of which rotate above it
        if R tilts the z axis. "continued" continues the function smoothly, which is accurate for tilts up to about 0.2
        rad. "dark" takes 0, as in Gautron et al. 2004. Both lose accuracy, as docs/algorithms/radiance_cache.md
        describes; only rotations about z are exact.
    spherical_order : for the hemispherical basis: order of the spherical harmonics that are used as an intermediate
        basis. The default is the order + 2 for "continued" and twice the order for "dark".
    tolerance : for the spherical basis: if this is above 0, the rotation is evaluated as a series that is truncated at
        this relative error. The series is faster for single vectors and for rotations that tilt the z axis only a
        little.

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
    """Return the values as (N, C), and whether they were given as (N,)."""
    f = np.ascontiguousarray(values, np.float64)
    if f.ndim not in (1, 2) or (count is not None and len(f) != count):
        expected = "" if count is None else f" for {count} directions"
        raise EclatError(f"{name} must have shape (N,) or (N, C){expected}, got {f.shape}")
    if not np.isfinite(f).all():
        raise EclatError(f"{name} must be finite")
    return f.reshape(len(f), -1), f.ndim == 1


def _coefficients(values: ArrayLike) -> tuple[Doubles, bool, int]:
    """Return the coefficients as (order², C), whether they were given as (order²,), and the order."""
    c, one_channel = _channels("coefficients", values)
    order = round(len(c) ** 0.5)
    if order * order != len(c) or not 1 <= order <= MAX_ORDER:
        raise EclatError(f"coefficients must be order² numbers for an order in [1, {MAX_ORDER}], got {len(c)}")
    return c, one_channel, order


def _result(values: NDArray[np.float64], one_channel: bool) -> Doubles:
    out = np.asarray(values)
    return out[:, 0] if one_channel else out
