# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Error against cost: each method at several levels of effort, and the cost of one method at another's error."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from eclat.images.image import Image
from eclat.report.svg_plot import log_log_plot
from eclat.scene import Scene
from harness.timing import in_turn

if TYPE_CHECKING:
    from eclat.methods.records.solution import Solution

T = TypeVar("T", bound="Image | Solution")

BUDGET = 60.0
"""Seconds for the repetitions of one level; what takes longer is measured fewer times."""


@dataclass(frozen=True)
class Point:
    """What one level of effort cost and reached. Errors are relative (0.01 = 1 %)."""

    label: str
    seconds: float
    error: float
    error_away: float | None
    """Away from edges; None where it was not measured."""
    records: int
    rays: int
    rounds: int
    """Of which `seconds` is the median."""


Levels = Mapping[str, Callable[[Scene], T]]
"""Label → what is timed. It gets a scene that the core has not seen, so that its time includes the tree."""


def measure(
    scene: Scene, series: Mapping[str, Levels[T]], judge: Callable[[T], tuple[float, float | None]], repeats: int
) -> dict[str, list[Point]]:
    """The points of each series. The first levels of all run in turn, then the second ones, and so on.

    `judge` gives the errors of what a level returned, everywhere and away from edges.
    """
    points: dict[str, list[Point]] = {name: [] for name in series}
    for i in range(max(len(levels) for levels in series.values())):
        present = {name: list(levels.items())[i] for name, levels in series.items() if i < len(levels)}
        timed = in_turn(
            {name: partial(_call_afresh, call, scene) for name, (_, call) in present.items()},
            repeats,
            warm_up=i == 0,
            budget=BUDGET,
        )
        for name, result in timed.items():
            label = present[name][0]
            everywhere, away = judge(result.value)
            records, rays = _counts(result.value)
            points[name].append(Point(label, result.seconds, everywhere, away, records, rays, len(result.rounds)))
            print(f"  {name}, {label}: {result.seconds:.2f} s, error {100 * everywhere:.2f} %", flush=True)
    return points


def _call_afresh(call: Callable[[Scene], T], scene: Scene) -> T:
    return call(replace(scene))


def _counts(value: Image | Solution) -> tuple[int, int]:
    statistics = value.metadata["statistics"] if isinstance(value, Image) else value.statistics
    return int(statistics.get("records", 0)), int(statistics["rays"])  # paths have none


@dataclass(frozen=True)
class Cost:
    """Of a method at a given error; extrapolated where none of its measured points is as good."""

    value: float
    extrapolated: bool


def cost_at(points: Sequence[Point], error: float, key: str = "seconds", slope: float | None = None) -> Cost | None:
    """The least `key` with which `points` reach `error`: between two of them by a power law.

    Beyond the best point: by cost ∝ error^`slope` (−2 for an unbiased method, whose noise falls with the square root of
    its samples); None without a slope: biased methods promise nothing there. Worse than the cheapest point: its cost.
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


def error_plots(prefix: str, result: Mapping[str, Any]) -> dict[str, str]:
    """Error against time of each scene of a result whose `points` are rows of each method."""
    return {
        f"{prefix}-{name}": log_log_plot(
            {method: [(p.seconds, p.error) for p in from_rows(rows)] for method, rows in scene["points"].items()},
            "seconds",
            f"{name}: error",
            lambda error: f"{100 * error:g} %",
        )
        for name, scene in result["scenes"].items()
    }
