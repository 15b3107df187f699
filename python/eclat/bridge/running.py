# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Long calls into the core, which run in a second thread, while the main thread reports progress and cancels them on
Ctrl-C."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TypeVar

from eclat import _core
from eclat.bridge.notebook import notebook_report

ProgressReport = Callable[[str, float, dict[str, float]], None]
"""A function that is called about ten times a second in the main thread, with the phase, the finished fraction (0..1)
and statistics."""

T = TypeVar("T")


def run(phase: str, call: Callable[[_core.Progress], T], report: ProgressReport | None, progress: _core.Progress) -> T:
    """Run `call(progress)` in another thread and return its result.

    In a notebook, a call without `report` shows a progress bar.

    An exception in `report`, or Ctrl-C, cancels the call and is raised. The call has always ended when this function
    returns or raises. Raises MemoryError if no thread can be started.
    """
    report = report or notebook_report()
    outcome: list[T] = []
    failure: list[BaseException] = []
    # Thread.join is not used, because after Ctrl-C it may treat a running thread as finished (CPython 3.11).
    ended = threading.Event()

    def work() -> None:
        try:
            outcome.append(call(progress))
        except BaseException as error:
            failure.append(error)
        finally:
            ended.set()

    thread = threading.Thread(target=work, daemon=True)
    started = time.perf_counter()
    try:
        thread.start()
    except RuntimeError:  # The system refuses another thread, usually because there is no memory for its stack.
        raise MemoryError("there is no memory for another thread") from None
    try:
        while not ended.wait(0.1):
            if report is not None:
                seconds = max(time.perf_counter() - started, 1e-9)
                fraction = min(1.0, progress.done / progress.total) if progress.total else 0.0
                report(phase, fraction, {"rays": float(progress.rays), "seconds": seconds})
    except BaseException:
        progress.cancel()
        ended.wait()
        raise
    if failure:
        raise failure[0]
    return outcome[0]
