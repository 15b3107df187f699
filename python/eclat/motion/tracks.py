# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tracks: values at key times, and the value between them [glTF 2.0 specification, appendix C, Animation Sampler
Interpolation Modes].

Symbol   name here      meaning
  t_k    times          time of key k, s
  v_k    values         value of key k
  a_k    values[:, 0]   in-tangent of key k of a cubic track, per second
  b_k    values[:, 2]   out-tangent of key k, per second
  t_d    span           t_{k+1} − t_k, s
  t      share          (time − t_k) / t_d, 0..1
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError

Numbers = NDArray[np.float64]
Interpolation = Literal["step", "linear", "cubic"]

_PARALLEL = 1.0 - 1e-9
"""The cosine between two quaternions above which they are interpolated linearly: the sine of their angle, which would be
divided by, is then below 5e-5, and the difference between both ways below 1e-13."""


@dataclass(frozen=True, eq=False)
class Track:
    """A value that changes over time. Before the first key it is that of the first key, after the last that of the last.

    Parameters
    ----------
    times : (K,) the times of the keys in seconds, strictly increasing.
    values : (K, W) the values of the keys; for cubic tracks (K, 3, W): in-tangent, value and out-tangent.
    interpolation : how values between keys are found.
    rotation : whether the values are quaternions (x, y, z, w). Linear interpolation then follows the shorter arc between
        two rotations at a constant speed, and the result is normalised.

    Raises
    ------
    EclatError : there are no keys, the shapes do not fit, a number is not finite, times do not increase, or a quaternion is
        0.
    """

    times: Numbers
    values: Numbers
    interpolation: Interpolation = "linear"
    rotation: bool = False

    def __post_init__(self) -> None:
        cubic = self.interpolation == "cubic"
        times, values = np.asarray(self.times, np.float64), np.asarray(self.values, np.float64)
        if times.ndim != 1 or not len(times):
            raise EclatError(f"expected at least one key with a time, got {times.size}")
        if len(values) != len(times) or values.ndim != 2 + cubic or (cubic and values.shape[1] != 3):
            raise EclatError(f"expected {len(times)} values, as many as times, got the shape {values.shape}")
        for name, numbers in (("times", times), ("values", values)):
            bad = ~np.isfinite(numbers.reshape(len(times), -1)).all(axis=1)
            if bad.any():
                raise EclatError(
                    f"expected finite {name}, got others at {int(bad.sum())} keys, first at key {bad.argmax()}"
                )
        falls = np.diff(times) <= 0
        if falls.any():
            key = int(falls.argmax())
            raise EclatError(
                f"expected times that increase, got {times[key]:g} s at key {key} and {times[key + 1]:g} s at the next"
            )
        keys = values[:, 1] if cubic else values
        if self.rotation and (keys.shape[1] != 4 or not (np.linalg.norm(keys, axis=1) > 0).all()):
            raise EclatError("expected quaternions other than 0 as rotations, got others")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)

    @property
    def moves(self) -> bool:
        """Whether the value changes at all."""
        if self.interpolation != "cubic":
            return bool((self.values != self.values[0]).any())
        keys = self.values[:, 1]
        return len(keys) > 1 and bool((keys != keys[0]).any() or self.values[:, ::2].any())

    def at(self, time: float) -> Numbers:
        """Return the value (W,) at a time in seconds."""
        last = len(self.times) - 1
        k = int(np.searchsorted(self.times, time, side="right")) - 1
        if k < 0 or k >= last:
            found = self._key(min(max(k, 0), last))
        elif self.interpolation == "step":
            found = self._key(k)
        else:
            span = float(self.times[k + 1] - self.times[k])
            share = (time - float(self.times[k])) / span
            found = self._cubic(k, span, share) if self.interpolation == "cubic" else self._linear(k, share)
        return normalized(found) if self.rotation else found

    def _key(self, k: int) -> Numbers:
        found: Numbers = self.values[k, 1] if self.interpolation == "cubic" else self.values[k]
        return found

    def _linear(self, k: int, share: float) -> Numbers:
        if self.rotation:
            return slerp(normalized(self.values[k]), normalized(self.values[k + 1]), share)
        found: Numbers = (1 - share) * self.values[k] + share * self.values[k + 1]
        return found

    def _cubic(self, k: int, span: float, t: float) -> Numbers:
        (_, v0, b0), (a1, v1, _) = self.values[k], self.values[k + 1]
        found: Numbers = (
            (2 * t**3 - 3 * t**2 + 1) * v0
            + span * (t**3 - 2 * t**2 + t) * b0
            + (-2 * t**3 + 3 * t**2) * v1
            + span * (t**3 - t**2) * a1
        )
        return found


def slerp(first: Numbers, second: Numbers, share: float) -> Numbers:
    """Interpolate between two unit quaternions along the shorter arc, at a constant angular speed."""
    cosine = float(first @ second)
    if cosine < 0:
        second, cosine = -second, -cosine
    if cosine > _PARALLEL:
        return normalized((1 - share) * first + share * second)
    angle = np.arccos(cosine)
    found: Numbers = (np.sin(angle * (1 - share)) * first + np.sin(angle * share) * second) / np.sin(angle)
    return found


def normalized(quaternion: Numbers) -> Numbers:
    """Return the unit quaternion of the same direction, or the identity for 0."""
    length = float(np.linalg.norm(quaternion))
    return quaternion / length if length > 0 else np.array([0.0, 0.0, 0.0, 1.0])


def rotation_matrix(quaternion: Numbers) -> Numbers:
    """Return the rotation (3, 3) of a unit quaternion (x, y, z, w)."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_of(matrix: Numbers) -> Numbers:
    """Return the unit quaternion (x, y, z, w) of a rotation (3, 3).

    It is the eigenvector of a symmetric matrix for its largest eigenvalue, which has no singular cases.
    """
    m = np.asarray(matrix, np.float64)
    (a, b, c), (d, e, f), (g, h, i) = m
    symmetric = np.array(
        [
            [a - e - i, b + d, c + g, h - f],
            [b + d, e - a - i, f + h, c - g],
            [c + g, f + h, i - a - e, d - b],
            [h - f, c - g, d - b, a + e + i],
        ]
    )
    _, vectors = np.linalg.eigh(symmetric)
    found: Numbers = vectors[:, -1]
    return found if found[3] >= 0 else -found


def smooth_track(times: Numbers, values: Numbers) -> Track:
    """Make a cubic track through the values (K, W), whose speed is continuous.

    The tangent at a key is that of the parabola through it and its two neighbours; at the ends it is that of the first or
    last segment.
    """
    times, values = np.asarray(times, np.float64), np.asarray(values, np.float64)
    if len(times) < 2 or (np.diff(times) <= 0).any():
        return Track(times, values)
    spans = np.diff(times)[:, None]
    slopes = np.diff(values, axis=0) / spans
    tangents = np.concatenate([slopes[:1], slopes[-1:]]) if len(times) == 2 else np.empty_like(values)
    tangents[0], tangents[-1] = slopes[0], slopes[-1]
    tangents[1:-1] = (slopes[:-1] * spans[1:] + slopes[1:] * spans[:-1]) / (spans[:-1] + spans[1:])
    return Track(times, np.stack([tangents, values, tangents], axis=1), "cubic")
