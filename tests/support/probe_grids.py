# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A grid of probes of random numbers."""

from __future__ import annotations

import numpy as np

from eclat.probe_grid.grid import ProbeGrid


def some_grid(counts: tuple[int, int, int] = (3, 2, 4)) -> ProbeGrid:
    """One of the probes lies inside a solid."""
    rng = np.random.default_rng(1)
    inside = np.zeros(counts, bool)
    inside[0, 1, 2 % counts[2]] = True
    return ProbeGrid(
        origin=np.array([1.0, -2.0, 0.1]),
        spacing=np.array([0.5, 1.0, 0.25]),
        coefficients=rng.normal(size=(*counts, 9, 3)).astype(np.float32),
        inside=inside,
        component="total",
        method="path",
        window="none",
        unit="W/m2",
        statistics={"rays": 5.0},
        settings={"samples": 4, "max_error": None},
    )
