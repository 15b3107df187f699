# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The output of a command: a progress bar and text for people, or lines of JSON for programs.

Results go to standard output; the bar (plain lines without a terminal), warnings and errors go to standard error. With
`--json`, standard output holds only events (`eclat.cli.progress.JsonEvents`), one per line, and errors are also printed
on standard error.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from contextlib import ExitStack, suppress
from types import TracebackType
from typing import Any, Self, TextIO

import click

from eclat.cli.command import option, together
from eclat.cli.progress import JsonEvents, ProgressBar
from eclat.errors import EclatError, EclatWarning, printable

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
)
"""Adds the options `--quiet` and `--json`."""


class Reporter:
    """Prints the progress, warnings, results and errors of a command.

    All that a command does is enclosed in `with Reporter(quiet, as_json) as reporter:`.
    """

    def __init__(self, quiet: bool = False, as_json: bool = False) -> None:
        self.quiet = quiet
        self.events = JsonEvents() if as_json else None
        self._bar = None if quiet or as_json else ProgressBar()
        self._said: set[str] = set()
        self._stack = ExitStack()

    @property
    def progress(self) -> Callable[[str, float, dict[str, float]], None] | None:
        """The function to pass as the argument `progress` of long calls; None if progress is not shown."""
        if self.events is not None:
            return None if self.quiet else self.events
        return self._bar

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

    def warn(self, message: str) -> None:
        """Print a warning, unless it was printed before."""
        if message in self._said:
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
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end_progress()
        self._stack.close()
        if self.events is None:
            return
        if isinstance(error, EclatError | click.ClickException):
            self.events.emit("error", message=message_of(error))
        elif isinstance(error, KeyboardInterrupt):
            self.events.emit("error", message="interrupted")


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
