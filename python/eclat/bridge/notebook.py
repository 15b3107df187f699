# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A progress bar in notebooks, for long calls that were given no function to report to."""

from __future__ import annotations

import importlib
import sys
import threading
import time
from collections.abc import Callable
from html import escape
from typing import Any

SECONDS_BETWEEN = 0.25
"""The least number of seconds between two updates of the bar, each of which is a message to the browser."""

_last: list[Any] = [None, None, 0.0]
"""The cell that has a bar, what displays it, and when it was last updated."""

AFTER_CELL = "post_run_cell"
"""The event of IPython after which nothing more is computed by a cell."""


def notebook_report() -> Callable[[str, float, dict[str, float]], None] | None:
    """Return a function that shows the progress below the cell that is running, or None outside of a notebook.

    All calls of one cell share one bar. When the cell has ended without an error, the bar is full and tells its time.
    """
    # Only a program that runs in IPython has imported it.
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    if shell is None or not hasattr(shell, "kernel") or threading.current_thread() is not threading.main_thread():
        return None

    def report(phase: str, fraction: float, statistics: dict[str, float]) -> None:
        cell, handle, when = _last
        now = time.perf_counter()
        if cell == shell.execution_count and now - when < SECONDS_BETWEEN:
            return
        display = importlib.import_module("IPython.display")
        bar = display.HTML(bar_html(phase, fraction, statistics))
        if cell == shell.execution_count:
            handle.update(bar)
        else:
            handle = display.display(bar, display_id=True)
            fill_at_end(shell, handle, display.HTML)
        _last[:] = [shell.execution_count, handle, now]

    return report


def fill_at_end(shell: Any, handle: Any, html: Callable[[str], Any]) -> None:
    """Fill the bar that `handle` displays when the running cell of `shell` ends; after an error it stays where it is."""
    started = time.perf_counter()

    def ended(result: Any) -> None:
        shell.events.unregister(AFTER_CELL, ended)
        if result.success:
            seconds = time.perf_counter() - started
            handle.update(html(f'<progress value="100" max="100"></progress> done in {seconds:.1f} s'))

    shell.events.register(AFTER_CELL, ended)


def bar_html(phase: str, fraction: float, statistics: dict[str, float]) -> str:
    """Return a bar with the phase, the part that is done in per cent, and the rays per second."""
    seconds = statistics.get("seconds", 0.0)
    speed = f", {statistics.get('rays', 0.0) / seconds / 1e6:.1f} Mrays/s" if seconds > 0 else ""
    percent = f"{100 * fraction:.0f}"
    return f'<progress value="{percent}" max="100"></progress> {escape(phase)} {percent} %{speed}'
