# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Measured intensities of a luminaire by direction, in the three coordinate systems of photometry [IES19].

Symbol  name here       meaning
  V     vertical        the vertical angle in degrees
  H     horizontal      the horizontal angle in degrees
  I     candela         the intensity towards (V, H)

The frame of a luminaire is that of glTF's EXT_lights_ies: it aims along −z, which is the direction V = H = 0. In type C, V is
the angle from −z, and H grows from +x towards +y. In types A and B, +x is up and −y is to the right of someone who looks along
−z; V is the angle upwards and H the angle to the right. Type A turns about the vertical axis, so that V is a latitude, and
type B about the horizontal axis, so that H is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat.errors import EclatError

Angles = NDArray[np.float64]

_AXES = {
    "C": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)),
    "A": ((0.0, 0.0, -1.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)),
    "B": ((0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0)),
}
"""By type: the directions of azimuth 0 and 90 degrees and of the pole, in the frame of the luminaire."""


@dataclass(frozen=True)
class Grid:
    """Intensities on spherical coordinates without symmetry: `values` (P, A) at the angles `polar` (P,) from the pole and
    `azimuth` (A,) in degrees, both ascending. `axes` (3, 3) are the rows described at `_AXES`. No light goes outside of the
    angles.
    """

    axes: Angles
    polar: Angles
    azimuth: Angles
    values: Angles


@dataclass(frozen=True, eq=False)
class IntensityProfile:
    """The intensities of a luminaire, as files of LM-63 hold them (`eclat.load_ies`).

    Parameters
    ----------
    photometry : the coordinate system; most files have C.
    vertical : (V,) ascending angles in degrees: within 0..180 for type C, from −90 or 0 to 90 for A and B.
    horizontal : (H,) ascending angles in degrees. In type C they are 0 alone for symmetry about the axis, 0..90 for two planes of
        symmetry, 0..180 or 90..270 for one, or 0..360. In A and B they go from −90 to 90, or from 0 to 90 for symmetry.
    candela : (H, V) the intensities in candela, finite and at least 0.
    name : a name for messages.

    Raises
    ------
    EclatError : the arrays do not fit together, or angles or intensities are not as described.

    Examples
    --------
    >>> even = IntensityProfile("C", [0, 180], [0], [[100, 100]])
    >>> round(even.flux / (4 * np.pi), 6)
    100.0
    """

    photometry: Literal["A", "B", "C"]
    vertical: ArrayLike
    horizontal: ArrayLike
    candela: ArrayLike
    name: str = ""

    def __post_init__(self) -> None:
        where = self.name or "profile"
        if self.photometry not in _AXES:
            raise EclatError(f"{where}: expected photometry of type A, B or C, got {self.photometry!r}")
        for field in ("vertical", "horizontal", "candela"):
            try:
                array = np.asarray(getattr(self, field), np.float64)
            except (TypeError, ValueError):
                raise EclatError(f"{where}: expected an array of numbers as {field}, got something else") from None
            object.__setattr__(self, field, array)
        vertical, horizontal, candela = self._arrays()
        if vertical.ndim != 1 or horizontal.ndim != 1 or candela.shape != (len(horizontal), len(vertical)):
            shapes = f"{vertical.shape}, {horizontal.shape} and {candela.shape}"
            raise EclatError(f"{where}: expected arrays of shapes (V,), (H,) and (H, V), got {shapes}")
        if len(vertical) < 2:
            raise EclatError(f"{where}: expected at least two vertical angles, got {len(vertical)}")
        for name, angles in (("vertical", vertical), ("horizontal", horizontal)):
            if not np.isfinite(angles).all() or (np.diff(angles) <= 0).any():
                raise EclatError(f"{where}: expected ascending {name} angles, got others")
        if not np.isfinite(candela).all() or candela.min(initial=0) < 0:
            raise EclatError(f"{where}: expected intensities that are finite and at least 0, got others")
        self.grid()

    def __repr__(self) -> str:
        horizontal, vertical = np.shape(self.candela)
        return f"<IntensityProfile {self.name!r}: type {self.photometry}, {vertical}×{horizontal} angles, {self.flux:.4g} lm>"

    def grid(self) -> Grid:
        """Return the intensities on spherical coordinates, with their symmetries unfolded. Raises EclatError for angles that the
        type does not allow.
        """
        vertical, horizontal, candela = self._arrays()
        axes = np.array(_AXES[self.photometry])
        if self.photometry == "C":
            if vertical[0] < 0 or vertical[-1] > 180:
                raise self._bad("vertical", "from 0 to 180", vertical)
            azimuth, values = self._around(horizontal, candela)
            return Grid(axes, vertical, azimuth, values.T)
        vertical, by_vertical = self._whole("vertical", vertical, candela.T)
        horizontal, values = self._whole("horizontal", horizontal, by_vertical.T)
        if self.photometry == "A":
            return Grid(axes, 90 - vertical[::-1], horizontal, values.T[::-1])
        return Grid(axes, 90 - horizontal[::-1], vertical, values[::-1])

    @property
    def flux(self) -> float:
        """The luminous flux in lumens of intensities that are linear between the angles."""
        grid = self.grid()
        theta = np.radians(grid.polar)
        width = np.diff(theta)
        means = 0.5 * (grid.values[:, 1:] + grid.values[:, :-1]) @ np.radians(np.diff(grid.azimuth))
        # ∫ sin θ dθ and ∫ (θ − θ₀) sin θ dθ over each interval, for an integrand that is linear in θ.
        zones = np.cos(theta[:-1]) - np.cos(theta[1:])
        moments = np.diff(np.sin(theta)) - width * np.cos(theta[1:])
        return float(means[:-1] @ zones + np.diff(means) / width @ moments)

    def _arrays(self) -> tuple[Angles, Angles, Angles]:
        return np.asarray(self.vertical), np.asarray(self.horizontal), np.asarray(self.candela)

    def _bad(self, which: str, expected: str, angles: Angles) -> EclatError:
        got = f"{angles[0]:g} to {angles[-1]:g}"
        return EclatError(
            f"{self.name or 'profile'}: expected {which} angles {expected} in type {self.photometry}, got {got}"
        )

    def _around(self, angles: Angles, rows: Angles) -> tuple[Angles, Angles]:
        """Unfold the horizontal angles of type C to a full turn."""
        first, last = angles[0], angles[-1]
        if len(angles) == 1:
            return np.array([0.0, 360.0]), np.repeat(rows, 2, axis=0)
        if (first, last) == (0, 90):
            angles, rows = _mirrored(angles, rows, 90)
            last = 180.0
        if (first, last) == (0, 180):
            return _mirrored(angles, rows, 180)
        if (first, last) == (90, 270):
            angles, rows = _mirrored(angles, rows, 270)
            return angles - 360, rows
        if first == 0 and 180 < last < 360:
            # Some files leave out the angle 360, which is the same as 0.
            return np.append(angles, 360.0), np.concatenate([rows, rows[:1]])
        if (first, last) != (0, 360):
            raise self._bad("horizontal", "0, 0 to 90, 0 to 180, 90 to 270 or 0 to 360", angles)
        return angles, rows

    def _whole(self, which: str, angles: Angles, rows: Angles) -> tuple[Angles, Angles]:
        """Unfold angles of types A and B to −90..90."""
        if angles[-1] != 90 or angles[0] not in (0, -90) or len(angles) < 2:
            raise self._bad(which, "from −90 or 0 to 90", angles)
        if angles[0] == -90:
            return angles, rows
        return np.concatenate([-angles[:0:-1], angles]), np.concatenate([rows[:0:-1], rows])


def _mirrored(angles: Angles, rows: Angles, at: float) -> tuple[Angles, Angles]:
    """Append the mirror image of the angles, and of their rows, beyond the last angle, which is `at`."""
    return np.concatenate([angles, 2 * at - angles[-2::-1]]), np.concatenate([rows, rows[-2::-1]])
