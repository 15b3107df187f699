# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command line: the table of commands, and what becomes of errors.

Exit codes: 0 done, 1 standard output was closed early, 2 the user's mistake (reported on standard error), 130 Ctrl-C,
143 SIGTERM, 129 SIGHUP: all three stop a command in the same way, which leaves no half-written file.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

import click

import eclat
from eclat.cli.command import Group
from eclat.cli.reporting import message_of, say_error
from eclat.errors import EclatError, printable

COMMANDS: dict[str, str] = {
    "render": "eclat.cli.render",
    "solve": "eclat.cli.solve",
    "irradiance": "eclat.cli.irradiance",
    "bake": "eclat.cli.bake",
    "denoise": "eclat.cli.denoise",
    "compare": "eclat.cli.compare",
    "info": "eclat.cli.info",
    "scenes": "eclat.cli.scenes",
}
"""Name → module, whose `command` it is."""

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 110}

DONE, BROKEN_PIPE, MISTAKE, INTERRUPTED = 0, 1, 2, 130


def _version(context: click.Context, parameter: click.Parameter, wanted: bool) -> Any:
    if wanted:
        click.echo(f"eclat {eclat.__version__}")
        context.exit()


@click.group(cls=Group, table=COMMANDS, context_settings=CONTEXT)
@click.option("--version", is_flag=True, is_eager=True, expose_value=False, callback=_version, help="Show the version.")
def group() -> None:
    """Render global illumination by irradiance caching, path tracing and other methods.

    \b
    eclat scenes                    lists the scenes that need no file
    eclat render cornell-box        makes cornell-box.png
    eclat render room.glb -o room.exr --max-error 0.02
    eclat compare cornell-box       all methods on one page, with their errors

    Every command has its own help with examples: eclat render --help
    """


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code and never raises for what a user can cause."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    with _stopped_by_signals() as received:
        try:
            with group.make_context("eclat", arguments or ["--help"]) as context:
                group.invoke(context)
            if sys.stdout is not None:
                sys.stdout.flush()
        except BaseException as error:
            return _exit_code(error, received)
    return DONE


@contextmanager
def _stopped_by_signals() -> Iterator[list[int]]:
    """Makes SIGTERM and SIGHUP interrupt as Ctrl-C does; gives the list of those that came.

    Signals that someone ignores (nohup) or handles stay theirs.
    """
    received: list[int] = []

    def interrupt(number: int, frame: FrameType | None) -> None:
        received.append(number)
        raise KeyboardInterrupt

    mine = []
    if threading.current_thread() is threading.main_thread():
        mine = [s for s in (signal.SIGTERM, signal.SIGHUP) if signal.getsignal(s) is signal.SIG_DFL]
    for number in mine:
        signal.signal(number, interrupt)
    try:
        yield received
    finally:
        for number in mine:
            signal.signal(number, signal.SIG_DFL)


def _exit_code(error: BaseException, signals: Sequence[int]) -> int:
    """The message for an error that ended a command, and the exit code. Errors that no user can cause are raised again."""
    try:
        raise error
    except click.exceptions.Exit as stop:
        return stop.exit_code
    except (KeyboardInterrupt, click.Abort):
        say_error("terminated" if signals else "interrupted")
        return 128 + signals[0] if signals else INTERRUPTED
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else "eclat"
        say_error(f"{printable(message_of(error))}\n       try: {command} --help")
        return MISTAKE
    except (EclatError, click.ClickException) as error:
        say_error(printable(message_of(error)))
        return MISTAKE
    except MemoryError:
        say_error("not enough memory")
        return MISTAKE
    except BrokenPipeError:
        _give_up_standard_output()
        return BROKEN_PIPE
    except OSError as error:
        # Files that cannot be read or written are EclatErrors by now: what is left is standard output.
        reason = error.strerror or str(error)
        say_error(f"{error.filename}: {reason}" if error.filename else f"standard output: cannot be written: {reason}")
        _give_up_standard_output()
        return MISTAKE


def _give_up_standard_output() -> None:
    """Python would complain once more when it flushes it at exit."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
