# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How much the light at a record changes between gathers at different times, from which lives follow (`lives`).

Symbol   name here    meaning                                                                          unit
  L_i      cells        luminance that cell i of N saw, in a gather of irradiance                          W·m⁻²·sr⁻¹
  λ        cells        coefficients of the luminance, in a gather of radiance                             W·m⁻²
  E, X     —            luminance of the irradiance and of the excess                                      W·m⁻²
  Ē        mean         mean of E in the scene                                                             W·m⁻²
  s        share        how much changes in single cells count that cancel in their sum                    1
  ε        LEAST_SHARE  lower bound of what changes are compared to, as a share of the mean                1

Irradiance   c = max(|Δ(E + X)|, s (π/N Σ |ΔL_i| + |ΔX|)) / √(max(E + X)² + (ε Ē)²)
Radiance     c = (‖Δλ‖ + √(2/π) |ΔX|) / √(max(‖λ‖ + √(2/π) X)² + (ε √(2/π) Ē)²)

A lobe with coefficients f reflects λ · f. By the inequality of Cauchy and Schwarz its relative change is at most c divided by
the cosine of the angle between λ and f. The same radiance from everywhere has ‖λ‖ = √(2/π) E.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

LEAST_SHARE = 0.1
"""The lower bound of the irradiance that changes are compared to, as a share of the mean: that of the error measure."""
_UNIFORM = float(np.sqrt(2 / np.pi))


@dataclass(frozen=True, eq=False)
class Seen:
    """What a gather saw; without cells if its surface has no extent."""

    cells: NDArray[np.floating]
    irradiance: float = 0.0
    excess: float = 0.0


NOTHING = Seen(np.zeros(0, np.float32))


class Measure(Protocol):
    """The measure of changes of one kind of record."""

    def change(self, a: Seen, b: Seen) -> float:
        """Return the change c between two gathers."""
        ...

    def bend(self, a: Seen, middle: Seen, b: Seen, share: float) -> float:
        """Return how far the light of a gather is from the line between two others, relative to the largest. On the line
        it would have the given share of the second."""
        ...


@dataclass(frozen=True)
class IrradianceMeasure:
    """The measure of records of irradiance."""

    mean: float
    share: float

    def change(self, a: Seen, b: Seen) -> float:
        if len(a.cells) != len(b.cells):
            return np.inf if len(a.cells) or len(b.cells) else 0.0
        gained = float(np.abs(a.cells - b.cells).mean(dtype=np.float64)) * np.pi if len(a.cells) else 0.0
        sums = [seen.irradiance + seen.excess for seen in (a, b)]
        cells = gained + abs(a.excess - b.excess)
        return _relative(max(abs(sums[0] - sums[1]), self.share * cells), max(sums), self.mean)

    def bend(self, a: Seen, middle: Seen, b: Seen, share: float) -> float:
        first, at, last = (seen.irradiance + seen.excess for seen in (a, middle, b))
        return _relative(abs(at - (1 - share) * first - share * last), max(first, at, last), self.mean)


@dataclass(frozen=True)
class RadianceMeasure:
    """The measure of records of radiance."""

    mean: float

    def change(self, a: Seen, b: Seen) -> float:
        if len(a.cells) != len(b.cells):
            return np.inf if len(a.cells) or len(b.cells) else 0.0
        gained = float(np.linalg.norm(a.cells - b.cells)) + _UNIFORM * abs(a.excess - b.excess)
        return _relative(gained, max(_norm(a), _norm(b)), _UNIFORM * self.mean)

    def bend(self, a: Seen, middle: Seen, b: Seen, share: float) -> float:
        if not len(a.cells) == len(middle.cells) == len(b.cells):
            return np.inf
        off = float(np.linalg.norm(middle.cells - (1 - share) * a.cells - share * b.cells))
        off += _UNIFORM * abs(middle.excess - (1 - share) * a.excess - share * b.excess)
        return _relative(off, max(_norm(a), _norm(middle), _norm(b)), _UNIFORM * self.mean)


def _norm(seen: Seen) -> float:
    return float(np.linalg.norm(seen.cells)) + _UNIFORM * seen.excess


def _relative(change: float, largest: float, mean: float) -> float:
    whole = float(np.hypot(largest, LEAST_SHARE * mean))
    return change / whole if whole > 0 else 0.0
