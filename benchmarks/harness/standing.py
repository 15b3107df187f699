# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How Éclat stands in the race: ratios of times to the same error, and what others show by the time it is done."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from harness.document import percent, seconds
from harness.race import Course, flip_at, time_to

Courses = Mapping[str, Course]


def ratio_rows(
    scene: str, courses: Courses, ours: Sequence[str], paths: str, wanted: Sequence[float]
) -> list[list[str]]:
    """A row for each error that Éclat or another program reaches.

    `ours` are the names of Éclat's caches, of which the fastest counts, and `paths` is that of its denoised paths.
    """
    rows = []
    for error in wanted:
        cache = best({name: courses[name] for name in ours if name in courses}, error)
        others = {name: course for name, course in courses.items() if name not in ours and not name.startswith("Éclat")}
        other = best(others, error)
        path = best({paths: courses[paths]}, error) if paths in courses else None
        if cache is None and other is None and path is None:
            continue
        rows.append([
            scene, percent(error), _named(cache), _named(other), _ratio(cache, other),
            _named(path) if paths in courses else "not measured", _ratio(cache, path),
        ])  # fmt: skip
    return rows


def flip_rows(scene: str, courses: Courses, ours: Sequence[str], error: float) -> list[list[str]]:
    """The FLIP of all renderers at the time that Éclat's fastest cache needs for an error; no row if it never gets there."""
    cache = best({name: courses[name] for name in ours if name in courses}, error)
    if cache is None:
        return []
    found = [(name, flip_at(course, cache[1])) for name, course in courses.items()]
    return [
        [scene, seconds(cache[1]), name, "no picture yet" if value is None else f"{value:.4f}"] for name, value in found
    ]


def best(courses: Courses, error: float) -> tuple[str, float, bool] | None:
    """The fastest to an error: its name, its seconds, and whether its cheapest level is better already."""
    times = [
        (name, cost.value, at_once)
        for name, course in courses.items()
        for cost, at_once in [time_to(course, error)]
        if cost is not None
    ]
    return min(times, key=lambda time: time[1], default=None)


def _named(time: tuple[str, float, bool] | None) -> str:
    return "not reached" if time is None else f"{'≤ ' if time[2] else ''}{seconds(time[1])} ({time[0]})"


def _ratio(ours: tuple[str, float, bool] | None, theirs: tuple[str, float, bool] | None) -> str:
    """Our time over theirs; a time that the cheapest level beats bounds the ratio from above or from below."""
    if ours is None or theirs is None:
        return ""
    sign = {(True, False): "≤ ", (False, True): "≥ ", (True, True): "about ", (False, False): ""}[ours[2], theirs[2]]
    return f"{sign}{ours[1] / theirs[1]:.2f} ×"
