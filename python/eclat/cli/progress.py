# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The progress of long calls, shown to people as a bar or to programs as lines of JSON.

Both classes are the `progress` argument of `solve`, `render` and `irradiance`: they are called as
`progress(phase, fraction, statistics)` about ten times a second, with `fraction` (0..1) of that phase. A fraction that
falls means that more is to be done than was expected (pictures whose error falls slowly), or that the phase began anew.
"""

from __future__ import annotations

import io
import json
import math
import re
import sys
import time
from collections import deque
from collections.abc import Callable, Mapping
from types import TracebackType
from typing import Any, Self, TextIO

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn

_CONTROL = re.compile("[\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""What JSON leaves as it is though terminals, or readers of lines, obey it."""

SHOW_AFTER = 2.0
"""Seconds before a bar appears: shorter calls need none."""

RATE_WINDOW = 2.0
"""Seconds over which rays per second are averaged: calm enough to read, quick enough to follow a new phase."""

Clock = Callable[[], float]


class Meter:
    """Rays per second and seconds left, from reports as they come."""

    def __init__(self, clock: Clock = time.monotonic) -> None:
        self._clock = clock
        self._phase: str | None = None
        self._first_fraction = self._fraction = 0.0
        self._started = clock()
        self._counts: deque[tuple[float, float]] = deque()

    def update(self, phase: str, fraction: float, rays: float) -> None:
        """Take one report into account."""
        now = self._clock()
        if phase != self._phase or fraction < self._fraction:
            self._phase, self._started, self._first_fraction = phase, now, fraction
            self._counts.clear()
        # A count that falls belongs to another call.
        if self._counts and rays < self._counts[-1][1]:
            self._counts.clear()
        self._fraction = fraction
        self._counts.append((now, rays))
        while len(self._counts) > 2 and now - self._counts[0][0] > RATE_WINDOW:
            self._counts.popleft()

    @property
    def rays_per_second(self) -> float | None:
        """Over the last `RATE_WINDOW` seconds, None before two reports."""
        if len(self._counts) < 2:
            return None
        (first, before), (last, after) = self._counts[0], self._counts[-1]
        return (after - before) / (last - first) if last > first else None

    @property
    def seconds_left(self) -> float | None:
        """Seconds until this phase ends if its pace stays the same; None where nothing is done yet."""
        spent, done = self._clock() - self._started, self._fraction - self._first_fraction
        return spent * (1.0 - self._fraction) / done if done > 0 and spent > 0 else None


class ProgressBar:
    """A line with phase, bar, rays per second and time left; only on a terminal, only after `SHOW_AFTER` seconds.

    It vanishes when the `with` block ends, however that happens.
    """

    def __init__(self, console: Console | None = None, clock: Clock = time.monotonic) -> None:
        self._console = console or Console(stderr=True)
        self._clock = clock
        self._begun = clock()
        self._meter = Meter(clock)
        self._bar: Progress | None = None
        self._task = TaskID(0)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __call__(self, phase: str, fraction: float, statistics: Mapping[str, float]) -> None:
        fraction = min(1.0, max(0.0, fraction)) if math.isfinite(fraction) else 0.0
        self._meter.update(phase, fraction, float(statistics.get("rays", 0.0)))
        if not self._console.is_terminal or self._clock() - self._begun < SHOW_AFTER:
            return
        if self._bar is None:
            self._start()
        assert self._bar is not None
        self._bar.update(
            self._task,
            description=phase,
            completed=fraction,
            rate=rate_text(self._meter.rays_per_second),
            left=left_text(self._meter.seconds_left),
        )
        # Reports come often enough; rich's own refreshing thread would only compete for the processor.
        self._bar.refresh()

    def close(self) -> None:
        """Take the bar off the screen."""
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def _start(self) -> None:
        columns = (
            "{task.description:<10}",
            "{task.percentage:>3.0f} %",
            "{task.fields[rate]:>14}",
            "{task.fields[left]}",
        )
        texts = [TextColumn(column, markup=False) for column in columns]
        bar = Progress(texts[0], BarColumn(), *texts[1:], console=self._console, transient=True, auto_refresh=False)
        self._task = bar.add_task("", total=1.0, rate="", left="")
        bar.start()
        self._bar = bar


class JsonEvents:
    """One JSON object a line, flushed at once; each has `event` and `time` (seconds since the start).

    `progress`: phase, fraction, seconds_left, rays_per_second (null while unknown), statistics. Other events are the
    command line's: `warning` and `error` (message), `result` (what the command found or wrote). Numbers that are not
    finite become null, since JSON has none.
    """

    def __init__(self, stream: TextIO | None = None, clock: Clock = time.monotonic) -> None:
        self._stream = stream or sys.stdout or io.StringIO()  # None where standard output is closed
        self._clock = clock
        self._begun = clock()
        self._meter = Meter(clock)

    def __call__(self, phase: str, fraction: float, statistics: Mapping[str, float]) -> None:
        self._meter.update(phase, fraction, float(statistics.get("rays", 0.0)))
        self.emit(
            "progress",
            phase=phase,
            fraction=fraction,
            seconds_left=self._meter.seconds_left,
            rays_per_second=self._meter.rays_per_second,
            statistics=dict(statistics),
        )

    def emit(self, event: str, **fields: Any) -> None:
        """Write one event."""
        record = {"event": event, "time": round(self._clock() - self._begun, 3), **fields}
        # JSON spells out what is below a space itself, and leaves other control characters as they are.
        text = json.dumps(_finite(record), ensure_ascii=False, allow_nan=False)
        self._stream.write(_CONTROL.sub(lambda c: f"\\u{ord(c[0]):04x}", text) + "\n")
        self._stream.flush()


def rate_text(rays_per_second: float | None) -> str:
    """`12.3 Mrays/s`; empty where unknown."""
    if rays_per_second is None:
        return ""
    for unit, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if rays_per_second >= size:
            return f"{rays_per_second / size:.1f} {unit}rays/s"
    return f"{rays_per_second:.0f} rays/s"


def left_text(seconds: float | None) -> str:
    """`1:05 left`, `2:00:00 left`; empty where unknown or beyond a hundred hours."""
    if seconds is None or not seconds < 360_000:
        return ""
    minutes, rest = divmod(math.ceil(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02} left" if hours else f"{minutes}:{rest:02} left"


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return value
