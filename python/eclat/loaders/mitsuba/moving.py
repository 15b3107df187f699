# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Transforms that change over time: the element `<animation>` of Mitsuba 0.5 and 0.6.

Each key is decomposed into a translation, a rotation and a symmetric stretch (the polar decomposition M = R S), which are
interpolated apart: the rotation along the shorter arc, the others linearly. The stretch is kept whole, so that
each key is met exactly.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eclat.motion.tracks import Track, quaternion_of, rotation_matrix

Matrix = NDArray[np.float64]

_now: ContextVar[float | None] = ContextVar("now", default=None)
"""The time in seconds at which transforms are read, or None for the rest pose, which is that of the first key."""


@contextmanager
def at_time(time: float) -> Iterator[None]:
    """Read all transforms in the block as they are at a time in seconds."""
    token = _now.set(time)
    try:
        yield
    finally:
        _now.reset(token)


@dataclass(frozen=True, eq=False)
class MovingTransform:
    """A 4×4 matrix over time. The first key is the rest pose."""

    first: Matrix
    translation: Track
    rotation: Track
    stretch: Track

    @staticmethod
    def of(times: list[float], matrices: list[Matrix]) -> MovingTransform:
        """Make a transform of keys at increasing times in seconds. Raises EclatError if the times do not increase."""
        parts = [_decomposed(matrix) for matrix in matrices]
        keys = np.array(times, np.float64)
        rotations = np.array([quaternion for _, quaternion, _ in parts])
        return MovingTransform(
            matrices[0],
            Track(keys, np.array([translation for translation, _, _ in parts])),
            Track(keys, rotations, rotation=True),
            Track(keys, np.array([stretch.ravel() for _, _, stretch in parts])),
        )

    @property
    def moves(self) -> bool:
        """Whether the matrix changes at all."""
        return self.translation.moves or self.rotation.moves or self.stretch.moves

    @property
    def span(self) -> tuple[float, float]:
        """The times of the first and the last key in seconds."""
        return float(self.translation.times[0]), float(self.translation.times[-1])

    def now(self) -> Matrix:
        """Return the matrix at the time of the surrounding `at_time`, or that of the first key."""
        time = _now.get()
        if time is None:
            return self.first
        matrix = np.eye(4)
        matrix[:3, :3] = rotation_matrix(self.rotation.at(time)) @ self.stretch.at(time).reshape(3, 3)
        matrix[:3, 3] = self.translation.at(time)
        return matrix


def _decomposed(matrix: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Return the translation (3,), the rotation as a quaternion (4,) and the stretch (3, 3) of a matrix (4, 4)."""
    u, values, vt = np.linalg.svd(matrix[:3, :3])
    if np.linalg.det(u @ vt) < 0:
        u, values = -u, -values
    return matrix[:3, 3], quaternion_of(u @ vt), vt.T @ np.diag(values) @ vt
