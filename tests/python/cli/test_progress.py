# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Progress for people and for programs, with a clock that the test winds."""

from __future__ import annotations

import io
import json
import math

import pytest
from rich.console import Console

from eclat.cli.progress import JsonEvents, Meter, ProgressBar, left_text, rate_text


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_rays_per_second_follow_the_last_seconds() -> None:
    clock = Clock()
    meter = Meter(clock)
    assert meter.rays_per_second is None
    rays = 0.0
    for step in range(100):
        rays += 1e5 if step < 50 else 3e5
        meter.update("render", step / 100, rays)
        clock.now += 0.1
    assert meter.rays_per_second == pytest.approx(3e6)


def test_seconds_left_at_the_pace_so_far() -> None:
    clock = Clock()
    meter = Meter(clock)
    meter.update("render", 0.0, 0)
    assert meter.seconds_left is None
    clock.now += 3
    meter.update("render", 0.25, 0)
    assert meter.seconds_left == pytest.approx(9)


@pytest.mark.parametrize(("phase", "fraction"), [("render", 0.5), ("solve", 0.1)])
def test_another_phase_or_pass_begins_anew(phase: str, fraction: float) -> None:
    clock = Clock()
    meter = Meter(clock)
    meter.update("solve", 0.9, 1e6)
    clock.now += 10
    meter.update(phase, fraction, 0)
    assert meter.rays_per_second is None
    clock.now += 1
    meter.update(phase, fraction + 0.25, 5e5)
    assert meter.rays_per_second == pytest.approx(5e5)
    assert meter.seconds_left == pytest.approx((0.75 - fraction) / 0.25)


def bar_text(terminal: bool, seconds: float) -> str:
    file, clock = io.StringIO(), Clock()
    console = Console(file=file, force_terminal=terminal, width=100, legacy_windows=False, color_system=None)
    with ProgressBar(console, clock) as bar:
        bar("solve", 0.1, {"rays": 0.0})
        clock.now += seconds
        bar("solve", 0.5, {"rays": 24.6e6})
    return file.getvalue()


def test_a_bar_shows_phase_rate_and_time_left() -> None:
    text = bar_text(terminal=True, seconds=2.5)
    for part in ("solve", "50 %", "9.8 Mrays/s", "0:04 left"):
        assert part in text


def test_no_bar_is_shown_for_short_calls() -> None:
    assert bar_text(terminal=True, seconds=1.5) == ""
    assert bar_text(terminal=False, seconds=1.5) == ""


def test_lines_are_printed_without_a_terminal() -> None:
    assert bar_text(terminal=False, seconds=2.5) == "eclat: solve 50 %, 9.8 Mrays/s, 0:04 left\n"


def printed_lines(reports: list[tuple[float, str, float]]) -> list[str]:
    """The plain lines for reports of (time, phase, fraction), without rate and time left."""
    file, clock = io.StringIO(), Clock()
    begun = clock.now
    with ProgressBar(Console(file=file, force_terminal=False, width=40), clock) as bar:
        for seconds, phase, fraction in reports:
            clock.now = begun + seconds
            bar(phase, fraction, {})
    return [line.partition(",")[0] for line in file.getvalue().splitlines()]


def test_plain_lines_tell_each_tenth_phase_and_half_minute() -> None:
    slow = [(second, "solve", 0.001 * second) for second in range(100)]
    assert printed_lines(slow) == [f"eclat: solve {percent} %" for percent in (0, 3, 6, 9)]
    quick = [(float(second), "solve", second / 25) for second in range(25)] + [(26.5, "render", 0.0)]
    steps = [f"eclat: solve {percent} %" for percent in (8, 20, 32, 44, 56, 68, 80, 92)]
    assert printed_lines(quick) == [*steps, "eclat: render 0 %"]
    day = [(60.0 * i, "solve", (i * 0.37) % 1) for i in range(24 * 60)]
    assert len(printed_lines(day)) < 150
    assert printed_lines([(3.0, "odd\x1b[2J", 0.0)]) == [r"eclat: odd\x1b[2J 0 %"]


def test_a_bar_accepts_numbers_that_are_not_finite() -> None:
    file, clock = io.StringIO(), Clock()
    with ProgressBar(Console(file=file, force_terminal=True, width=100), clock) as bar:
        clock.now += 3
        bar("solve [odd]", math.nan, {})
        bar("solve [odd]", 7.0, {"rays": 1.0})
    assert "solve [odd]" in file.getvalue()


def test_events_are_lines_of_json() -> None:
    file, clock = io.StringIO(), Clock()
    events = JsonEvents(file, clock)
    events("render", 0.0, {"rays": 0.0})
    clock.now += 0.5
    events("render", 0.25, {"rays": 1e6, "error": math.nan})
    events.emit("result", file="Ümlaut.png", pixels=(1, 2))
    first, second, third = map(json.loads, file.getvalue().splitlines())
    assert first == {
        "event": "progress",
        "time": 0.0,
        "phase": "render",
        "fraction": 0.0,
        "seconds_left": None,
        "rays_per_second": None,
        "statistics": {"rays": 0.0},
    }
    assert (second["time"], second["seconds_left"], second["rays_per_second"]) == (0.5, 1.5, 2e6)
    assert second["statistics"] == {"rays": 1e6, "error": None}
    assert third == {"event": "result", "time": 0.5, "file": "Ümlaut.png", "pixels": [1, 2]}


def test_numbers_are_formatted_for_people() -> None:
    assert [rate_text(r) for r in (None, 12, 1.25e4, 3.45e7, 2e9)] == [
        "",
        "12 rays/s",
        "12.5 krays/s",
        "34.5 Mrays/s",
        "2.0 Grays/s",
    ]
    assert [left_text(s) for s in (None, 0.2, 65, 7200, math.inf, math.nan)] == [
        "",
        "0:01 left",
        "1:05 left",
        "2:00:00 left",
        "",
        "",
    ]


def test_the_bar_of_a_bake_shows_at_once() -> None:
    clock, out = Clock(), io.StringIO()
    for show_after, lines in ((0.0, 1), (2.0, 0)):
        out = io.StringIO()
        bar = ProgressBar(Console(file=out), clock, show_after=show_after)
        bar("load", 0.0, {})
        assert out.getvalue().count("load") == lines
