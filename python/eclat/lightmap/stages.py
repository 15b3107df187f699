# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Progress of the parts of a bake that run outside the core."""

from __future__ import annotations

import time
from collections.abc import Callable

from eclat.bridge.running import ProgressReport

Told = Callable[[float], None]
"""A function that is told the finished share (0..1) of a long loop."""


def stage(progress: ProgressReport | None, phase: str) -> Told | None:
    """Report that `phase` begins, and return the function that reports how much of it is finished; None without
    `progress`."""
    if progress is None:
        return None
    started = time.perf_counter()

    def told(fraction: float) -> None:
        progress(phase, fraction, {"rays": 0.0, "seconds": time.perf_counter() - started})

    told(0.0)
    return told
