# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Measures of the difference between a picture and a reference: the relative error that all figures of this project
use, and FLIP.

Symbol    name here    meaning                                                             unit
  x       x            the picture to measure, (H, W, 3) linear radiance                   W·sr⁻¹·m⁻²
  A, B    a, b         two independent references; the seeds of x, A and B are unrelated
  R       reference    (A + B) / 2
  c       c            a constant that keeps dark pixels from dominating                   (W·sr⁻¹·m⁻²)²

Let A = T + n_A and B = T + n_B, where T is the true radiance and the noise n_A and n_B is independent with mean zero.
Then (x − A)(x − B) has the same expectation as (x − T)²: the noise of the references does not bias the error. It only
adds variance, so for tiny errors the mean may be negative; it is then replaced by 0.
"""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat.errors import EclatError
from eclat.images.tone import to_display

Float64 = NDArray[np.float64]

TARGET_C = 0.01
"""Value of c for the built-in benchmark scenes, whose radiances are fixed, in (W·sr⁻¹·m⁻²)²."""

RELATIVE_C = 0.01
"""Default of c relative to the mean of R², which makes the error independent of the exposure."""

EDGE_DEGREES = 10.0
"""Angle between the normals of two neighbouring pixels, in degrees, above which an edge lies between them."""
EDGE_DEPTH = 0.02
"""Difference of the depths of two neighbouring pixels, relative to the nearer one, above which an edge lies between them."""
EDGE_PIXELS = 2
"""Distance from an edge, in pixels, up to which pixels count as being at the edge."""

PIXELS_PER_DEGREE = 67.0
"""Pixels per degree of the visual field for FLIP: a 4K screen 0.7 m wide, seen from 0.7 m. It is the default of the
authors of FLIP [Andersson et al. 2020]."""


def relative_rmse(
    x: ArrayLike, a: ArrayLike, b: ArrayLike, c: float | None = None, mask: NDArray[np.bool_] | None = None
) -> float:
    """Compute the relative error sqrt(max(0, mean((x − A)(x − B) / (R² + c)))) over channels and pixels.

    Parameters
    ----------
    x, a, b : (H, W, 3) linear radiance. If there is only one reference, give it as a and b; its noise then counts as
        error of x.
    c : the constant c. None means `RELATIVE_C` times the mean of R² over all pixels, including those outside the mask.
    mask : (H, W), True for the pixels to include, for instance those of `away_from_edges`; None includes all.

    Returns
    -------
    The error; 0.01 is 1 %. It is NaN if x or a reference is not finite at an included pixel.

    Raises
    ------
    EclatError : the shapes differ, or the mask includes no pixel.

    Examples
    --------
    >>> grey = np.full((4, 4, 3), 0.5)
    >>> round(relative_rmse(1.01 * grey, grey, grey, c=0.0), 6)
    0.01
    """
    x, a, b = _same_shape(x, a, b)
    reference = (a + b) / 2
    scale = reference**2 + _c(reference, c)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Where all pictures are black, the quotient is 0 / 0 and counts as no error.
        squares = np.where((scale == 0) & (x == a) & (x == b), 0.0, (x - a) * (x - b) / scale)
    counted = squares if mask is None else squares[np.asarray(mask, dtype=bool)]
    if counted.size == 0:
        raise EclatError("relative error: expected a mask that includes at least one pixel, got one that includes none")
    mean = float(counted.mean())
    return mean if np.isnan(mean) else max(0.0, mean) ** 0.5


def signed_error(x: ArrayLike, reference: ArrayLike, c: float | None = None) -> Float64:
    """Compute the mean over channels of (x − R) / sqrt(R² + c), (H, W), which is positive where x is too bright. `c` is
    that of `relative_rmse`."""
    x, reference = _same_shape(x, reference)
    with np.errstate(divide="ignore", invalid="ignore"):
        error = (x - reference) / np.sqrt(reference**2 + _c(reference, c))
    return np.asarray(np.where(x == reference, 0.0, error).mean(axis=-1))


def away_from_edges(depth: ArrayLike, normal: ArrayLike) -> NDArray[np.bool_]:
    """Make a mask (H, W) that is True for pixels with no edge within `EDGE_PIXELS` pixels horizontally and vertically.

    An edge lies between two neighbouring pixels, including diagonal ones, if their normals differ by more than
    `EDGE_DEGREES`, if their depths differ by more than `EDGE_DEPTH` of the nearer depth, or if only one of them shows a
    surface.

    Parameters
    ----------
    depth : (H, W) in metres; infinite or 0 for pixels that show no surface.
    normal : (H, W, 3), of any length; zero for pixels that show no surface.

    Raises
    ------
    EclatError : the shapes do not match.
    """
    z, n = np.asarray(depth, np.float64), np.asarray(normal, np.float64)
    if z.ndim != 2 or n.shape != (*z.shape, 3):
        raise EclatError(f"edges: expected depth (H, W) and normals (H, W, 3), got {z.shape} and {n.shape}")
    hit = np.isfinite(z) & (z > 0)
    z = np.where(hit, z, 0.0)
    length = np.linalg.norm(n, axis=-1, keepdims=True)
    n = np.divide(n, length, out=np.zeros_like(n), where=length > 0)
    edge = np.zeros(z.shape, dtype=bool)
    # Each pair of neighbours is compared once: right, down, and the two diagonals downwards.
    for rows, columns in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here, there = _shifted(z.shape, rows, columns)
        differs = np.abs(z[here] - z[there]) > EDGE_DEPTH * np.minimum(z[here], z[there])
        turned = (n[here] * n[there]).sum(axis=-1) < np.cos(np.radians(EDGE_DEGREES))
        differs |= (turned & hit[here]) | (hit[here] != hit[there])
        edge[here] |= differs
        edge[there] |= differs
    # Both pixels of a pair are marked, and the edge is half a pixel from each, so the mask grows by one pixel less.
    return ~_dilated(edge, EDGE_PIXELS - 1)


def flip(x: ArrayLike, reference: ArrayLike, exposure: float = 0.0) -> tuple[Float64, float]:
    """Compute the LDR-FLIP map (H, W) in 0..1 of two pictures that are displayed at `exposure` stops, and its mean.

    FLIP is that of Andersson et al. 2020, *FLIP: A Difference Evaluator for Alternating Images*, at
    `PIXELS_PER_DEGREE`.

    Raises
    ------
    EclatError : the shapes differ, or the package flip-evaluator is not installed.
    """
    x, reference = _same_shape(x, reference)
    if not has_flip():
        raise EclatError("FLIP needs the package flip-evaluator, which is not installed: pip install flip-evaluator")
    flip_evaluator = importlib.import_module("flip_evaluator")
    shown, truth = (to_display(p, exposure).astype(np.float32) / np.float32(255) for p in (x, reference))
    error, mean, _ = flip_evaluator.evaluate(
        truth, shown, "LDR", applyMagma=False, parameters={"ppd": PIXELS_PER_DEGREE}
    )
    return np.asarray(error, dtype=np.float64).reshape(x.shape[:2]), float(mean)


def has_flip() -> bool:
    """Return whether the package flip-evaluator is installed, which `flip` needs."""
    return importlib.util.find_spec("flip_evaluator") is not None


def _same_shape(*arrays: ArrayLike) -> tuple[Float64, ...]:
    pictures = tuple(np.asarray(array, dtype=np.float64) for array in arrays)
    shapes = [picture.shape for picture in pictures]
    if len(shapes[0]) != 3 or shapes[0][2] != 3 or len(set(shapes)) != 1:
        got = ", ".join(str(shape) for shape in shapes)
        raise EclatError(f"metrics: expected pictures of the same shape (height, width, 3), got {got}")
    return pictures


def _c(reference: Float64, c: float | None) -> float:
    return RELATIVE_C * float((reference**2).mean()) if c is None else c


def _shifted(shape: tuple[int, ...], rows: int, columns: int) -> tuple[Any, Any]:
    """Return the indices of all pixels that have a neighbour at the offset (rows, columns), and of these neighbours."""
    height, width = shape
    top, bottom = slice(0, height - rows), slice(rows, height)
    if columns >= 0:
        return (top, slice(0, width - columns)), (bottom, slice(columns, width))
    return (top, slice(-columns, width)), (bottom, slice(0, width + columns))


def _dilated(mask: NDArray[np.bool_], pixels: int) -> NDArray[np.bool_]:
    grown = mask.copy()
    for axis in (0, 1):
        source = grown.copy()
        for shift in range(1, pixels + 1):
            ahead = [slice(None), slice(None)]
            behind = [slice(None), slice(None)]
            ahead[axis], behind[axis] = slice(shift, None), slice(None, -shift)
            grown[tuple(ahead)] |= source[tuple(behind)]
            grown[tuple(behind)] |= source[tuple(ahead)]
    return grown
