# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Long calls beside the main thread: results, errors, reports, and an end when the reporter gives up."""

from __future__ import annotations

import threading

import pytest

from eclat import _core
from eclat.bridge.running import run


def test_the_result_and_the_progress_come_back() -> None:
    mine = _core.Progress()
    result, progress = run("solve", lambda progress: ("done", progress), None, mine)
    assert result == "done"
    assert progress is mine


def test_the_call_has_a_thread_of_its_own() -> None:
    thread = run("solve", lambda progress: threading.current_thread(), None, _core.Progress())
    assert thread is not threading.main_thread()


def test_an_error_of_the_call_is_raised_here() -> None:
    def fail(progress: _core.Progress) -> None:
        raise RuntimeError("no light")

    with pytest.raises(RuntimeError, match="no light"):
        run("solve", fail, None, _core.Progress())


def test_the_phase_is_reported_while_the_call_runs() -> None:
    told = threading.Event()
    phases: list[tuple[str, float, set[str]]] = []

    def report(phase: str, fraction: float, statistics: dict[str, float]) -> None:
        phases.append((phase, fraction, set(statistics)))
        told.set()

    assert run("render", lambda progress: told.wait(60), report, _core.Progress())
    assert phases[0] == ("render", 0.0, {"rays", "seconds"})


def test_a_reporter_that_raises_cancels_the_call_and_waits_for_its_end() -> None:
    release = threading.Event()
    ended = threading.Event()

    def call(progress: _core.Progress) -> None:
        release.wait(60)
        ended.set()

    def report(phase: str, fraction: float, statistics: dict[str, float]) -> None:
        release.set()
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run("render", call, report, _core.Progress())
    assert ended.is_set()
