# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Wall-clock time of competitors that run in turn, so that whatever else the machine does meets all of them alike."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True)
class Timed(Generic[T]):
    """Seconds of each round, and what the last one returned."""

    rounds: tuple[float, ...]
    value: T

    @property
    def seconds(self) -> float:
        """Median of the rounds."""
        return statistics.median(self.rounds)


def in_turn(
    runs: Mapping[str, Callable[[], T]], repeats: int, *, warm_up: bool = True, budget: float = float("inf")
) -> dict[str, Timed[T]]:
    """Call all `runs`, one after another, `repeats` times over; fewer where that would take more than `budget` seconds.

    With `warm_up` each is called once before, untimed.
    """
    if warm_up:
        for run in runs.values():
            run()
    rounds: dict[str, list[float]] = {name: [] for name in runs}
    values: dict[str, T] = {}
    first = time.perf_counter()
    for i in range(repeats):
        for name, run in runs.items():
            gc.collect()
            before = time.perf_counter()
            values[name] = run()
            rounds[name].append(time.perf_counter() - before)
        if (time.perf_counter() - first) * (i + 2) / (i + 1) > budget:
            break
    return {name: Timed(tuple(rounds[name]), values[name]) for name in runs}
