# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The progress of long calls, shown to people as a bar and to programs as lines of JSON.

Instances of both classes are passed as the argument `progress` of `solve`, `render` and `irradiance`, which call it as
`progress(phase, fraction, statistics)` about ten times a second. `fraction` is the finished share (0..1) of the phase.
The fraction decreases if more work is left than was expected, for example because the error of a picture decreases
slowly, or if the phase has started again.
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
from contextlib import suppress
from types import TracebackType
from typing import Any, Self, TextIO

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn

from eclat.errors import printable

_CONTROL = re.compile("[\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Characters that JSON does not escape, but that control terminals or break lines."""

SHOW_AFTER = 2.0
"""Seconds before the bar appears; shorter calls need no bar."""

LINE_EVERY = 30.0
"""The number of seconds after which another plain line is printed, also if the finished share has hardly changed."""
LINE_PAUSE = 0.05
"""The shortest pause between two plain lines, as a share of the time since the start: 20 s after 400 s."""

RATE_WINDOW = 2.0
"""Seconds over which the rays per second are averaged: long enough to read the number, short enough to follow a new
phase."""

Clock = Callable[[], float]


class Meter:
    """Computes the rays per second and the seconds left from reports of progress."""

    def __init__(self, clock: Clock = time.monotonic) -> None:
        self._clock = clock
        self._phase: str | None = None
        self._first_fraction = self._fraction = 0.0
        self._started = clock()
        self._counts: deque[tuple[float, float]] = deque()

    def update(self, phase: str, fraction: float, rays: float) -> None:
        """Add one report: the phase, the finished share of it (0..1), and the number of rays so far."""
        now = self._clock()
        if phase != self._phase or fraction < self._fraction:
            self._phase, self._started, self._first_fraction = phase, now, fraction
            self._counts.clear()
        # The number of rays falls when another call begins.
        if self._counts and rays < self._counts[-1][1]:
            self._counts.clear()
        self._fraction = fraction
        self._counts.append((now, rays))
        while len(self._counts) > 2 and now - self._counts[0][0] > RATE_WINDOW:
            self._counts.popleft()

    @property
    def rays_per_second(self) -> float | None:
        """The rays per second, averaged over the last `RATE_WINDOW` seconds; None before the second report."""
        if len(self._counts) < 2:
            return None
        (first, before), (last, after) = self._counts[0], self._counts[-1]
        return (after - before) / (last - first) if last > first else None

    @property
    def seconds_left(self) -> float | None:
        """The expected number of seconds until this phase ends, if its pace stays the same; None if nothing is finished
        yet.
        """
        spent, done = self._clock() - self._started, self._fraction - self._first_fraction
        return spent * (1.0 - self._fraction) / done if done > 0 and spent > 0 else None


class ProgressBar:
    """A line with the phase, a bar, the rays per second and the time left.

    It is shown only after `show_after` seconds, and removed when the `with` block ends. Without a terminal, plain lines
    are printed instead: one for each new phase, for each tenth of a phase, and every `LINE_EVERY` seconds. To keep logs
    short, the pause between two lines is at least `LINE_PAUSE` of the time since the start.
    """

    def __init__(
        self, console: Console | None = None, clock: Clock = time.monotonic, show_after: float = SHOW_AFTER
    ) -> None:
        self._console = console or Console(stderr=True)
        self._show_after = show_after
        self._clock = clock
        self._begun = clock()
        self._meter = Meter(clock)
        self._bar: Progress | None = None
        self._line: tuple[str, float, float] | None = None  # phase, fraction and time of the last plain line
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
        if self._clock() - self._begun < self._show_after:
            return
        if not self._console.is_terminal:
            self._print_line(phase, fraction, statistics)
            return
        if self._bar is None:
            self._start()
        assert self._bar is not None
        self._bar.update(
            self._task,
            description=phase_text(phase, statistics.get("error")),
            completed=fraction,
            rate=rate_text(self._meter.rays_per_second),
            left=left_text(self._meter.seconds_left),
        )
        # The bar is refreshed at each report; rich's own refreshing thread would take processor time from the renderer.
        self._bar.refresh()

    def _print_line(self, phase: str, fraction: float, statistics: Mapping[str, float]) -> None:
        """Print a plain line if it differs from the last one."""
        now = self._clock()
        if self._line is not None:
            last_phase, last_fraction, last = self._line
            is_new = phase != last_phase or abs(fraction - last_fraction) >= 0.1 or now - last >= LINE_EVERY
            if not is_new or now - last < max(SHOW_AFTER, LINE_PAUSE * (now - self._begun)):
                return
        self._line = phase, fraction, now
        parts = [
            f"{phase_text(phase, statistics.get('error'))} {100 * fraction:.0f} %",
            rate_text(self._meter.rays_per_second),
            left_text(self._meter.seconds_left),
        ]
        # A log that cannot be written, or a closed standard error, must not stop the work.
        with suppress(OSError, ValueError):
            self._console.file.write(f"eclat: {printable(', '.join(filter(None, parts)))}\n")
            self._console.file.flush()

    def close(self) -> None:
        """Remove the bar from the screen."""
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
    """Writes events as JSON objects, one per line, and flushes each line at once.

    Every object has the fields `event` and `time` (seconds since the start). The event `progress` has phase, fraction,
    seconds_left and rays_per_second (null while unknown), and statistics. The command line adds the events `warning`
    and `error`, with a message, and `result`, with what the command computed or wrote. Numbers that are not finite are
    written as null, because JSON cannot represent them.
    """

    def __init__(self, stream: TextIO | None = None, clock: Clock = time.monotonic) -> None:
        self._stream = stream or sys.stdout or io.StringIO()  # sys.stdout is None if standard output is closed
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
        # `json.dumps` escapes the control characters below the space, but not the others.
        text = json.dumps(_finite(record), ensure_ascii=False, allow_nan=False)
        self._stream.write(_CONTROL.sub(lambda c: f"\\u{ord(c[0]):04x}", text) + "\n")
        self._stream.flush()


def rate_text(rays_per_second: float | None) -> str:
    """Format rays per second as in `12.3 Mrays/s`; the text is empty if the number is unknown."""
    if rays_per_second is None:
        return ""
    for unit, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if rays_per_second >= size:
            return f"{rays_per_second / size:.1f} {unit}rays/s"
    return f"{rays_per_second:.0f} rays/s"


def phase_text(phase: str, error: float | None) -> str:
    """Describe the phase and, if it is known, the error, as in `render, error 4.2 %`."""
    return phase if error is None or not math.isfinite(error) else f"{phase}, error {100 * error:.2g} %"


def left_text(seconds: float | None) -> str:
    """Format seconds as in `1:05 left` or `2:00:00 left`; the text is empty if unknown or a hundred hours or more."""
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
