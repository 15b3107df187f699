# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""One scene's race: every entrant draws every level of its own, in turn, and one measure judges them all."""

from __future__ import annotations

import gc
import math
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Protocol

import numpy as np

from eclat.images.image import Image
from eclat.measure.metrics import flip, has_flip
from harness.curves import Cost, Point, cost_at
from harness.entrant import Picture
from harness.references import Reference
from harness.unavailable import UnavailableError
from harness.worker import WorkerError

BUDGET = 60.0
"""Seconds for the rounds of one level of all entrants; what takes longer is measured fewer times."""

MATCH = 0.01
"""An unbiased entrant's mean may differ by this from the reference's, and by `SIGMAS` standard errors of its noise."""

SIGMAS = 5.0
MEASURES = ("error", "error_away", "flip")


class Runner(Protocol):
    """What the race needs of an entrant: `worker.Worker`, or anything like it."""

    levels: tuple[str, ...]
    version: str
    unbiased: bool
    own_truth: bool

    def render(self, level: int) -> Picture: ...
    def truth(self, samples: int, seed: int) -> Picture: ...
    def close(self) -> None: ...


@dataclass(frozen=True)
class Judged:
    """One level: the median time, and how far its picture is from the truth. Errors are relative (0.01 = 1 %)."""

    label: str
    seconds: float
    rounds: tuple[float, ...]
    error: float
    error_away: float
    flip: float | None
    mean_ratio: float
    """Of the picture's mean over the reference's."""


@dataclass
class Course:
    """What one entrant did, and why it stopped where it did."""

    version: str
    unbiased: bool
    levels: list[Judged] = field(default_factory=list)
    stopped: str = ""

    def as_row(self) -> dict[str, Any]:
        """As JSON holds it."""
        return asdict(self)

    @staticmethod
    def from_row(row: Mapping[str, Any]) -> Course:
        """The inverse of `as_row`."""
        levels = [Judged(**{**level, "rounds": tuple(level["rounds"])}) for level in row["levels"]]
        return Course(row["version"], row["unbiased"], levels, row["stopped"])


class Judge:
    """The measures of one scene. FLIP is of the picture as shown at `exposure` stops; None without its package."""

    def __init__(self, truth: Reference, exposure: float, processors: int | None = None) -> None:
        """With `processors`, a time is that of all processors over their number, for a machine that does other work."""
        self.truth, self.exposure, self.processors = truth, exposure, processors
        self.mean = (truth.a + truth.b) / 2

    def __call__(self, label: str, pictures: Sequence[Picture]) -> Judged:
        rounds = tuple(self._seconds(picture) for picture in pictures)
        pixels = pictures[-1].pixels
        everywhere, away = self.truth.error(Image(pixels))
        seen = flip(pixels, self.mean, self.exposure)[1] if has_flip() else None
        ratio = float(pixels.mean(dtype=np.float64) / self.mean.mean())
        return Judged(label, statistics.median(rounds), rounds, everywhere, away, seen, ratio)

    def _seconds(self, picture: Picture) -> float:
        if self.processors is None or picture.processor is None:
            return picture.seconds
        return picture.processor / self.processors

    def mismatch(self, pixels: np.ndarray) -> str:
        """Why an unbiased picture cannot be one of this scene; empty where it can."""
        difference = (pixels - self.mean).mean(axis=-1)
        error = float(difference.mean() / self.mean.mean())
        noise = float(difference.std() / math.sqrt(difference.size) / self.mean.mean())
        if abs(error) <= MATCH + SIGMAS * noise:
            return ""
        return f"its mean is {1 + error:.4f} × the reference's, noise {noise:.4f}: not the same scene"


def start(makers: Mapping[str, Callable[[], Runner]]) -> tuple[dict[str, Runner], dict[str, str]]:
    """Runners that drew their first picture, untimed, so that they are warm; and why the others are missing."""
    runners: dict[str, Runner] = {}
    skipped: dict[str, str] = {}
    for name, make in makers.items():
        try:
            runner = make()
            runner.render(0)
            runners[name] = runner
        except UnavailableError as reason:
            skipped[name] = str(reason)
        except WorkerError as reason:
            skipped[name] = f"failed: {reason}"
        if name in skipped:
            print(f"  {name}: skipped: {skipped[name]}", flush=True)
    return runners, skipped


def race(
    runners: Mapping[str, Runner],
    judge: Judge,
    repeats: int,
    most: int | None = None,
    budget: float = BUDGET,
    own_judges: Mapping[str, Judge] | None = None,
) -> dict[str, Course]:
    """The first `most` levels of all. The first levels of all run in turn, then the second ones, and so on.

    `own_judges` judge, in place of `judge`, the runners that have a reference of their own.
    """
    own_judges = own_judges or {}
    courses = {name: Course(runner.version, runner.unbiased) for name, runner in runners.items()}
    last = max((len(runner.levels) for runner in runners.values()), default=0)
    for level in range(last if most is None else min(most, last)):
        present = [n for n, r in runners.items() if level < len(r.levels) and not courses[n].stopped]
        drawn: dict[str, list[Picture]] = {name: [] for name in present}
        first = time.perf_counter()
        for turn in range(repeats):
            for name in present:
                if courses[name].stopped:
                    continue
                gc.collect()
                try:
                    drawn[name].append(runners[name].render(level))
                except WorkerError as reason:
                    courses[name].stopped = f"{runners[name].levels[level]}: {reason}"
                    print(f"  {name}: {courses[name].stopped}", flush=True)
            if (time.perf_counter() - first) * (turn + 2) / (turn + 1) > budget:
                break
        for name, pictures in drawn.items():
            if pictures:
                _enter(courses[name], runners[name].levels[level], name, own_judges.get(name, judge), pictures)
    return courses


def _enter(course: Course, label: str, name: str, judge: Judge, pictures: Sequence[Picture]) -> None:
    """A level's place in the course, or why the entrant draws another scene."""
    if course.unbiased and (reason := judge.mismatch(pictures[-1].pixels)):
        course.levels.clear()
        course.stopped = reason
        print(f"  {name}, {label}: {reason}", flush=True)
        return
    found = judge(label, pictures)
    course.levels.append(found)
    print(
        f"  {name}, {label}: {found.seconds:.2f} s, error {100 * found.error:.2f} %, away from edges "
        f"{100 * found.error_away:.2f} %, mean {found.mean_ratio:.4f}",
        flush=True,
    )


def flip_at(course: Course, seconds: float) -> float | None:
    """The least FLIP that is reached within a time, between levels by a power law.

    None where no level is done by then, or FLIP was not measured. After the last level its FLIP stays.
    """
    levels = sorted((level for level in course.levels if level.flip is not None), key=lambda level: level.seconds)
    reached: float | None = None
    for before, level in zip([None, *levels], levels, strict=False):
        assert level.flip is not None
        if level.seconds <= seconds:
            reached = level.flip if reached is None else min(reached, level.flip)
        elif before is not None and before.flip and level.flip > 0:
            share = math.log(seconds / before.seconds) / math.log(level.seconds / before.seconds)
            between = before.flip * (level.flip / before.flip) ** share
            return between if reached is None else min(reached, between)
        else:
            break
    return reached


def time_to(course: Course, wanted: float, measure: str = "error") -> tuple[Cost | None, bool]:
    """Seconds at which a measure reaches a value, between levels by a power law, and whether its first level is better.

    None where no level is as good: nothing is extrapolated.
    """
    points = [
        Point(level.label, level.seconds, value, None, 0, 0, len(level.rounds))
        for level in course.levels
        if (value := getattr(level, measure)) is not None
    ]
    if not points:
        return None, False
    quickest = min(points, key=lambda point: point.seconds)
    return cost_at(points, wanted), quickest.error <= wanted
