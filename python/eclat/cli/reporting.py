# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The output of a command: a progress bar and text for people, or lines of JSON for programs.

Results go to standard output; the bar (plain lines without a terminal), warnings and errors go to standard error. With
`--json`, standard output holds only events (`eclat.cli.progress.JsonEvents`), one per line, and errors are also printed
on standard error. `--log-level` says how much is reported.
"""

from __future__ import annotations

import os
import time
import traceback
import warnings
from collections.abc import Callable
from contextlib import ExitStack, suppress
from types import TracebackType
from typing import Any, Self, TextIO

import click

from eclat.cli.build_facts import build_facts
from eclat.cli.command import option, together
from eclat.cli.parameters import Name
from eclat.cli.progress import SHOW_AFTER, JsonEvents, ProgressBar
from eclat.errors import EclatError, EclatWarning, printable

LOG_LEVELS = ("debug", "info", "warning", "error")
"""The values of `--log-level`: each shows what the following ones show, and more."""
_LEVEL = "eclat.log_level"


def _keep_level(context: click.Context, parameter: click.Parameter, level: str) -> None:
    context.meta[_LEVEL] = level


reporting_options = together(
    option(
        "--quiet",
        "-q",
        is_flag=True,
        section="Reporting",
        help="Show no progress and no summary; warnings and errors are still shown.",
    ),
    option(
        "--json",
        "as_json",
        is_flag=True,
        section="Reporting",
        help="Write progress, warnings and results to standard output as JSON, one object per line.",
    ),
    option(
        "--log-level",
        type=Name("LEVEL", *LOG_LEVELS),
        default="info",
        section="Reporting",
        expose_value=False,
        callback=_keep_level,
        help="How much to report: error for errors only, warning as --quiet, info for progress and summary too, debug for "
        "versions, the time of each phase, processor time and memory, and the traceback of errors [info].",
    ),
)
"""Adds the options `--quiet`, `--json` and `--log-level`."""


class Reporter:
    """Prints the progress, warnings, results and errors of a command.

    All that a command does is enclosed in `with Reporter(quiet, as_json) as reporter:`. The progress is shown after
    `show_after` seconds.
    """

    def __init__(self, quiet: bool = False, as_json: bool = False, show_after: float = SHOW_AFTER) -> None:
        context = click.get_current_context(silent=True)
        self.level = "info" if context is None else context.meta.get(_LEVEL, "info")
        self.quiet = quiet or self.level in ("warning", "error")
        self.events = JsonEvents() if as_json else None
        self._bar = None if self.quiet or as_json else ProgressBar(show_after=show_after)
        self._begun, self._phase = time.monotonic(), ""
        self._said: set[str] = set()
        self._stack = ExitStack()

    @property
    def progress(self) -> Callable[[str, float, dict[str, float]], None] | None:
        """The function to pass as the argument `progress` of long calls; None if progress is not shown."""
        shown = None if self.quiet else self.events or self._bar
        if self.level != "debug":
            return shown

        def report(phase: str, fraction: float, statistics: dict[str, float]) -> None:
            if phase != self._phase:
                self._phase = phase
                self.debug(f"phase: {phase}")
            if shown is not None:
                shown(phase, fraction, statistics)

        return report

    def end_progress(self) -> None:
        """Remove the bar from the screen, before something else is written there."""
        if self._bar is not None:
            self._bar.close()

    def result(self, text: str, **fields: Any) -> None:
        """Print the result: `text` for people, or `fields` for programs."""
        self.end_progress()
        if self.events is not None:
            self.events.emit("result", **fields)
        elif not self.quiet:
            click.echo(printable(text, lines=True))

    def note(self, text: str) -> None:
        """Print a remark on standard error, which does not mix with results on standard output."""
        self.end_progress()
        if not self.quiet and self.events is None:
            click.echo(f"eclat: {printable(text)}", err=True)

    def debug(self, text: str) -> None:
        """Print a remark for whoever looks for a fault, with the time since the start; only with `--log-level debug`."""
        if self.level != "debug":
            return
        self.end_progress()
        if self.events is not None:
            self.events.emit("debug", message=text)
        else:
            click.echo(f"eclat: debug: {time.monotonic() - self._begun:.2f} s: {printable(text)}", err=True)

    def warn(self, message: str) -> None:
        """Print a warning, unless it was printed before; not with `--log-level error`."""
        if message in self._said or self.level == "error":
            return
        self._said.add(message)
        if self.events is not None:
            self.events.emit("warning", message=message)
        else:
            click.echo(f"eclat: warning: {printable(message)}", err=True)

    def __enter__(self) -> Self:
        self._stack.enter_context(warnings.catch_warnings())
        warnings.simplefilter("always", EclatWarning)
        show = warnings.showwarning

        def show_ours(
            message: Warning | str,
            category: type[Warning],
            filename: str,
            lineno: int,
            file: TextIO | None = None,
            line: str | None = None,
        ) -> None:
            if issubclass(category, EclatWarning):
                self.warn(str(message))
            else:
                show(message, category, filename, lineno, file, line)

        warnings.showwarning = show_ours
        if self.level == "debug":
            self.debug(", ".join(f"{name} {value}" for name, value in build_facts().items()))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end_progress()
        if self.level == "debug":
            self._debug_end(error)
        self._stack.close()
        if self.events is None:
            return
        if isinstance(error, EclatError | click.ClickException):
            self.events.emit("error", message=message_of(error))
        elif isinstance(error, KeyboardInterrupt):
            self.events.emit("error", message="interrupted")

    def _debug_end(self, error: BaseException | None) -> None:
        if error is not None:
            for line in "".join(traceback.format_exception(error)).rstrip().splitlines():
                self.debug(line)
        used = os.times()
        facts = f"processor time {used.user + used.system:.2f} s"
        with suppress(ImportError):  # Windows has no such module.
            import resource

            # Linux counts in KiB, macOS in bytes.
            unit = 1 if os.uname().sysname == "Darwin" else 1024
            facts += f", memory at its peak {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 2**20:.0f} MiB"
        self.debug(facts)


def message_of(error: EclatError | click.ClickException) -> str:
    """Return the message of an error of Éclat or of click, in the form in which all errors are printed."""
    if isinstance(error, click.BadParameter) and not isinstance(error, click.MissingParameter) and error.param:
        return f"{error.param.opts[-1]}: {error.message}"
    if isinstance(error, click.ClickException):
        message = error.format_message().rstrip(".")
        return message[:1].lower() + message[1:]
    return str(error)


def say_error(message: str) -> None:
    """Print `eclat: message` on standard error; do nothing if standard error cannot be written."""
    with suppress(OSError):
        click.echo(f"eclat: {printable(message, lines=True)}", err=True)
