# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of the harmonic coefficients of BRDF lobes: for each view direction, f · cosθ_i as a function of the incident
direction. Tables are kept on disk.

If the incident light is also given by coefficients, the reflected radiance is the dot product of the two vectors of
coefficients. docs/algorithms/radiance_cache.md describes the accuracy of the tables.
"""

from __future__ import annotations

import hashlib
import io
import os
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat import _core
from eclat.bridge.arguments import thread_count
from eclat.bridge.running import ProgressReport, run
from eclat.errors import EclatError, did_you_mean, warn
from eclat.files.arrays import arrays_from, read_file
from eclat.files.atomic_file import write_file
from eclat.harmonics import Basis

Kind = Literal["lambert", "phong", "ward", "ggx", "beckmann", "metallic-roughness"]
Floats = NDArray[np.float32]

MAX_ORDER = int(_core.max_table_order)
"""Largest order of a table."""

_BASES = {"spherical": _core.Basis.spherical, "hemispherical": _core.Basis.hemispherical}
_CORE_KINDS = {
    "lambert": _core.TableLobeKind.lambert,
    "phong": _core.TableLobeKind.phong,
    "ward": _core.TableLobeKind.ward,
    "ggx": _core.TableLobeKind.ggx,
    "beckmann": _core.TableLobeKind.beckmann,
    "metallic-roughness": _core.TableLobeKind.ggx,
}
# Values of α in a metallic-roughness table, uniform in √α. Lobes with α below 0.1 are too sharp for orders up to 12.
_ROUGHNESS_AXIS = tuple(float(x) for x in np.linspace(0.1**0.5, 1, 20) ** 2)


_LARGEST = 1e3
"""Largest absolute value of a number in a valid table file. The coefficients of a white lobe are at most the largest
basis function, which is below 10."""


class Lookup(NamedTuple):
    """The coefficients of a lobe for N view directions."""

    orders: NDArray[np.int64]
    """(N,) order that each direction needs; 0 if the largest order of the table is not sufficient, so that the lobe
    must be traced."""
    coefficients: Floats
    """(N, terms, order²) coefficients, which are 0 beyond the order of each direction."""
    errors: Floats
    """(N,) relative L2 error with the largest order of the table."""


@dataclass(frozen=True)
class BrdfTable:
    """The table of a lobe, which `brdf_table` makes."""

    kind: Kind
    basis: Basis
    order: int
    core: _core.BrdfTable

    @property
    def terms(self) -> int:
        """Number of terms: 3 for microfacet lobes, whose terms are multiplied by F0, by F90 and by the dip of the
        reflectance of metals (`split_conductor`); 1 for other lobes."""
        return int(self.core.terms)

    def lookup(self, directions: ArrayLike, alpha: ArrayLike | None = None) -> Lookup:
        """Look up the coefficients for view directions (N, 3), unit vectors with z > 0 in the frame of the surface.

        `alpha` is the GGX roughness, a number or an array (N,); it is required for "metallic-roughness" and not allowed
        otherwise. Raises EclatError for wrong shapes or numbers that are not finite.
        """
        w = np.ascontiguousarray(directions, np.float32)
        if w.ndim != 2 or w.shape[1] != 3 or not np.isfinite(w).all():
            raise EclatError(f"directions must be finite and have shape (N, 3), got {w.shape}")
        if (alpha is not None) != (self.kind == "metallic-roughness"):
            raise EclatError(
                f"alpha must be given for tables of 'metallic-roughness' and for no others; this table is of {self.kind!r}"
            )
        roughness = np.asarray(0.0 if alpha is None else alpha, np.float32)
        if roughness.shape not in ((), (len(w),)) or not np.isfinite(roughness).all():
            raise EclatError(f"alpha must be one finite number or an array of {len(w)}, got shape {roughness.shape}")
        orders, coefficients, errors = self.core.lookup(w, np.ascontiguousarray(np.broadcast_to(roughness, len(w))))
        return Lookup(np.asarray(orders).astype(np.int64), np.asarray(coefficients), np.asarray(errors))


def brdf_table(
    kind: Kind,
    *,
    alpha: float | tuple[float, float] | None = None,
    exponent: float | None = None,
    masking: Literal["separable", "correlated"] = "separable",
    basis: Basis = "hemispherical",
    order: int = 10,
    max_error: float = 0.2,
    keep: bool = True,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> BrdfTable:
    """Return the table of the coefficients of a white lobe for all view directions. A table is computed once, in about
    a second, and then read from disk.

    Parameters
    ----------
    kind : the lobe: "lambert"; "phong" with `exponent`; "ward", "ggx" or "beckmann" with `alpha`; or
        "metallic-roughness", the GGX lobe of glTF with all roughnesses in one table. Only reflection is tabulated.
    alpha : roughness, one number or a pair along u and v, 0.001..1.
    exponent : exponent of Phong's lobe, at least 0.
    masking : for "ggx": "correlated" if shadowing and masking are correlated by height, as in "metallic-roughness";
        otherwise "separable".
    basis : "hemispherical", or "spherical" for coefficients of least-squares fits. With fits, the light is given by its
        inner products over the hemisphere (`harmonics.project`).
    order : largest order, 1 to 12.
    max_error : largest relative L2 error, in (0, 1], with which a direction is represented. It determines the order of
        each direction.
    keep : whether to read and write tables in the cache folder of the user, `$XDG_CACHE_HOME/eclat`, or
        `~/.cache/eclat` if that variable is not set.

    Raises
    ------
    EclatError : an argument is out of range or missing.

    Examples
    --------
    >>> table = brdf_table("lambert", keep=False)
    >>> found = table.lookup([[0.0, 0.0, 1.0]])
    >>> sky = np.sqrt(2 * np.pi)  # the only coefficient of a sky of radiance 1
    >>> int(found.orders[0]), round(float(found.coefficients[0, 0, 0] * sky), 4)
    (2, 1.0)
    """
    lobes = _lobes(kind, alpha, exponent)
    if basis not in _BASES:
        raise EclatError(f"basis must be one of {', '.join(_BASES)}, got {basis!r}{did_you_mean(str(basis), _BASES)}")
    if not 1 <= order <= MAX_ORDER:
        raise EclatError(f"order must be in [1, {MAX_ORDER}], got {order}")
    if not 0 < max_error <= 1:
        raise EclatError(f"max_error must be in (0, 1], got {max_error}")
    if masking not in ("separable", "correlated"):
        raise EclatError(f"masking must be separable or correlated, got {masking!r}")
    if masking == "correlated" and kind != "ggx":
        raise EclatError(f"masking 'correlated' is only for the kind 'ggx', got {kind!r}")
    correlated = masking == "correlated" or kind == "metallic-roughness"
    isotropic = all(u == v for u, v in lobes)
    resolution = 2 if kind == "lambert" else 64 if isotropic else 32
    key = _key(kind, lobes, correlated, basis, order, max_error, resolution)
    made = [_core.TableLobe(_CORE_KINDS[kind], u, v, correlated) for u, v in lobes]
    options = _core.BrdfTableOptions(_BASES[basis], order, max_error, resolution, thread_count(threads))
    path = _file(key) if keep else None
    core = None if path is None else _read(path, made, options)
    if core is None:
        core = run("table", lambda p: _core.BrdfTable(made, options, p), progress, _core.Progress())
        if path is not None:
            _write(path, core)
    return BrdfTable(kind, basis, order, core)


def split_conductor(eta: tuple[float, float, float], k: tuple[float, float, float]) -> Floats:
    """Compute the factors (3 terms, RGB) of the Fresnel reflectance of a conductor with the complex index eta + i·k per
    channel."""
    return np.asarray(_core.split_conductor(eta, k))


def split_dielectric(ior: float) -> Floats:
    """Compute the factors (3 terms, RGB) of the reflectance of a dielectric interface; `ior` is the index inside
    divided by that outside."""
    return np.asarray(_core.split_dielectric(ior))


def cache_folder() -> Path:
    """Return the folder of the tables according to the XDG base directory specification.

    Raises EclatError if neither HOME nor XDG_CACHE_HOME is an absolute path. Without HOME, the home folder of the user
    counts that the system knows.
    """
    given = os.environ.get("XDG_CACHE_HOME", "")
    # The specification says that a relative path is ignored.
    try:
        base = Path(given) if os.path.isabs(given) else Path.home() / ".cache"
        # With an empty HOME, Python takes the root of the file system for the home folder.
        if not base.is_absolute() or (os.environ.get("HOME") == "" and not os.path.isabs(given)):
            raise RuntimeError
    except RuntimeError:
        raise EclatError(
            "cache folder: expected HOME or XDG_CACHE_HOME to be an absolute path, but neither is"
        ) from None
    return base / "eclat"


def _lobes(kind: Kind, alpha: float | tuple[float, float] | None, exponent: float | None) -> list[tuple[float, float]]:
    """Return the parameters along u and v, one pair for each lobe of the table."""
    if kind not in get_args(Kind):
        known = get_args(Kind)
        raise EclatError(f"kind must be one of {', '.join(known)}, got {kind!r}{did_you_mean(str(kind), known)}")
    takes = {"phong": "exponent", "ward": "alpha", "ggx": "alpha", "beckmann": "alpha"}.get(kind)
    for name, value in (("alpha", alpha), ("exponent", exponent)):
        if (value is not None) != (name == takes):
            got = "but it is missing" if name == takes else f"got {value!r}"
            raise EclatError(f"{name}: the kind {kind!r} {'needs' if name == takes else 'takes no'} {name}, {got}")
    if kind == "phong" and exponent is not None:
        if not 0 <= exponent < np.inf:
            raise EclatError(f"exponent must be finite and at least 0, got {exponent}")
        return [(float(exponent), float(exponent))]
    if alpha is not None:
        pair = tuple(float(a) for a in alpha) if isinstance(alpha, tuple) else (float(alpha), float(alpha))
        if len(pair) != 2 or not all(0.001 <= a <= 1 for a in pair):
            raise EclatError(f"alpha must be one or two numbers in [0.001, 1], got {alpha}")
        return [pair]
    return [(a, a) for a in _ROUGHNESS_AXIS] if kind == "metallic-roughness" else [(1.0, 1.0)]


@cache
def _core_digest() -> str:
    """Compute a digest of the compiled core, so that tables computed by another version are not used."""
    return hashlib.sha256(Path(str(_core.__file__)).read_bytes()).hexdigest()


def _key(*parameters: object) -> str:
    return hashlib.sha256(repr((_core_digest(), parameters)).encode()).hexdigest()[:32]


def _file(key: str) -> Path | None:
    """Return the path of the file for a table, or warn and return None if there is no cache folder."""
    try:
        return cache_folder() / f"brdf-{key}.npz"
    except EclatError as error:
        warn(f"{error}; the table is not kept and will be computed again")
        return None


def _read(path: Path, lobes: list[_core.TableLobe], options: _core.BrdfTableOptions) -> _core.BrdfTable | None:
    """Read the table in a file; return None if there is no file, or, with a warning, if it is damaged."""
    if not os.path.lexists(path):
        return None
    try:
        arrays = arrays_from(read_file(path, where=str(path)), str(path))
        values = [arrays[name] for name in ("orders", "errors", "coefficients")]
        # The checksum of the file shows that no byte has changed, but not that the numbers were valid when they were
        # written.
        if not all(array.dtype.kind in "fu" and (np.abs(array) <= _LARGEST).all() for array in values):
            raise ValueError(f"numbers that are not finite, or larger than {_LARGEST:g}")
        return _core.BrdfTable(lobes, options, *values)
    except (ValueError, TypeError, KeyError) as error:
        reason = str(error).removeprefix(f"{path}: ")
        warn(f"{path}: the table cannot be read ({reason}) and is computed again")
        return None


def _write(path: Path, table: _core.BrdfTable) -> None:
    data = io.BytesIO()
    orders = np.frombuffer(table.orders, np.uint8)
    np.savez(data, orders=orders, errors=table.errors, coefficients=table.coefficients)
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        write_file(path, data.getvalue())
    except (OSError, EclatError) as error:
        warn(f"{path}: the table could not be kept and will be computed again ({error})")
