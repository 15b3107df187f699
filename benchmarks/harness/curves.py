# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Error against cost: each method at several levels of effort, and the cost of one method at another's error."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from eclat.image import Image
from eclat.scene import Scene

from harness.references import Reference
from harness.timing import in_turn

BUDGET = 60.0
"""Seconds for the repetitions of one level; what takes longer is measured fewer times."""


@dataclass(frozen=True)
class Level:
    """One setting of a method. `render` gets a scene that the core has not seen, so its time includes the tree."""

    label: str
    render: Callable[[Scene], Image]


@dataclass(frozen=True)
class Point:
    """What a level cost and reached. Errors are relative (0.01 = 1 %)."""

    label: str
    seconds: float
    error: float
    error_away: float
    records: int
    rays: int
    cache_misses: int
    rounds: int


def measure(
    scene: Scene, truth: Reference, series: Mapping[str, Sequence[Level]], repeats: int
) -> dict[str, list[Point]]:
    """The points of each series. The first levels of all run in turn, then the second ones, and so on."""
    points: dict[str, list[Point]] = {name: [] for name in series}
    for i in range(max(len(levels) for levels in series.values())):
        present = {name: levels[i] for name, levels in series.items() if i < len(levels)}
        timed = in_turn(
            {name: lambda level=level: level.render(replace(scene)) for name, level in present.items()},  # type: ignore[misc]
            repeats,
            warm_up=i == 0,
            budget=BUDGET,
        )
        for name, result in timed.items():
            statistics = result.value.metadata["statistics"]
            everywhere, away = truth.error(result.value)
            points[name].append(
                Point(
                    present[name].label, result.seconds, everywhere, away, int(statistics["records"]),
                    int(statistics["rays"]), int(statistics["cache_misses"]), len(result.rounds),
                )  # fmt: skip
            )
            print(f"  {name}, {present[name].label}: {result.seconds:.2f} s, error {100 * everywhere:.2f} %", flush=True)
    return points


@dataclass(frozen=True)
class Cost:
    """Of a method at a given error; extrapolated where none of its measured points is as good."""

    value: float
    extrapolated: bool


def cost_at(points: Sequence[Point], error: float, key: str = "seconds", slope: float | None = None) -> Cost | None:
    """The least `key` with which `points` reach `error`: between two of them by a power law.

    Beyond the best point: by cost ∝ error^`slope` (−2 for an unbiased method, whose noise falls with the square root of
    its samples); None without a slope, for biased methods promise nothing there. Cheaper than the first point: its cost.
    """
    best = sorted(points, key=lambda p: getattr(p, key))
    before = None
    for point in best:
        cost = float(getattr(point, key))
        if point.error <= error:
            if before is None or before.error <= point.error or point.error <= 0:
                return Cost(cost, False)
            share = math.log(before.error / error) / math.log(before.error / point.error)
            low = float(getattr(before, key))
            return Cost(low * (cost / low) ** share if low > 0 else cost, False)
        if before is None or point.error < before.error:
            before = point
    if slope is None or before is None:
        return None
    return Cost(float(getattr(before, key)) * (error / before.error) ** slope, True)


def as_rows(points: Sequence[Point]) -> list[dict[str, object]]:
    """As JSON holds them."""
    return [asdict(point) for point in points]


def from_rows(rows: Sequence[Mapping[str, object]]) -> list[Point]:
    """The inverse of `as_rows`."""
    return [Point(**row) for row in rows]  # type: ignore[arg-type]
