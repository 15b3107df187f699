# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command line: the table of commands, and the handling of errors.

`EXIT_CODES` lists the exit codes. Ctrl-C and the signals that it names stop a command in the same way, without leaving a
half-written file.
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
from click.shell_completion import shell_complete

from eclat.cli.build_facts import build_facts, isa_option
from eclat.cli.command import COMPLETION_VARIABLE, Group
from eclat.cli.reporting import message_of, say_error
from eclat.errors import EclatError, printable

COMMANDS: dict[str, str] = {
    "render": "eclat.cli.render",
    "animate": "eclat.cli.animate",
    "solve": "eclat.cli.solve",
    "irradiance": "eclat.cli.irradiance",
    "bake": "eclat.cli.bake",
    "view": "eclat.cli.view",
    "probes": "eclat.cli.probes",
    "denoise": "eclat.cli.denoise",
    "mix": "eclat.cli.mix",
    "merge": "eclat.cli.merge",
    "compare": "eclat.cli.compare",
    "info": "eclat.cli.info",
    "scenes": "eclat.cli.scenes",
    "convert": "eclat.cli.convert",
    "completion": "eclat.cli.completion",
}
"""Maps the name of each command to the module that defines it as `command`."""

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 110}

DONE, BROKEN_PIPE, MISTAKE, INTERRUPTED = 0, 1, 2, 130

EXIT_CODES: dict[int, str] = {
    DONE: "the work is done",
    BROKEN_PIPE: "standard output was closed early, by `| head` for example; or a fault of Éclat, with a traceback",
    MISTAKE: "a mistake in the command, a file or an option, which the message names; or not enough memory",
    INTERRUPTED: "stopped by Ctrl-C (SIGINT)",
    143: "stopped by SIGTERM",
    129: "stopped by SIGHUP, when the terminal was closed",
    152: "stopped by SIGXCPU, at the soft limit of processor time",
}
"""Maps the exit codes of all commands to their meanings, for the help."""


def _version(context: click.Context, parameter: click.Parameter, wanted: bool) -> Any:
    if wanted and not context.resilient_parsing:
        for name, value in build_facts().items():
            click.echo(f"{name} {value}" if name == "eclat" else f"  {name:<16}{value}")
        context.exit()


@click.group(cls=Group, table=COMMANDS, context_settings=CONTEXT, exit_codes=EXIT_CODES)
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_version, help="Show the versions."
)
@isa_option
def group() -> None:
    """Render global illumination by irradiance caching, path tracing and other methods.

    \b
    eclat scenes                    lists the built-in scenes
    eclat render cornell-box        renders a built-in scene to cornell-box.png
    eclat render room.glb --time 30 renders your own scene in half a minute
    eclat view cornell-box          shows a scene in the browser, to walk through
    eclat compare cornell-box       compares all methods and their errors on one page

    Every command has its own help, with examples: eclat render --help
    """


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code; errors that a user can cause are reported, not raised."""
    instruction = os.environ.get(COMPLETION_VARIABLE)
    if arguments is None and instruction:
        # The shell asks for completions; it cannot show errors.
        return shell_complete(group, {}, "eclat", COMPLETION_VARIABLE, instruction)
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
    """Let SIGTERM, SIGHUP and SIGXCPU stop the command as Ctrl-C does; yield the list of the signals received so far.

    Signals that the calling process ignores (as nohup does) or handles itself are left as they are.
    """
    received: list[int] = []

    def interrupt(number: int, frame: FrameType | None) -> None:
        received.append(number)
        raise KeyboardInterrupt

    mine = []
    if threading.current_thread() is threading.main_thread():
        # Windows has SIGTERM only.
        stopping = [getattr(signal, name, None) for name in ("SIGTERM", "SIGHUP", "SIGXCPU")]
        mine = [number for number in stopping if number and signal.getsignal(number) is signal.SIG_DFL]
    for number in mine:
        signal.signal(number, interrupt)
    try:
        yield received
    finally:
        for number in mine:
            signal.signal(number, signal.SIG_DFL)


def _exit_code(error: BaseException, signals: Sequence[int]) -> int:
    """Report the error that ended a command and return the exit code; errors that no user can cause are raised
    again."""
    try:
        raise error
    except click.exceptions.Exit as stop:
        return stop.exit_code
    except (KeyboardInterrupt, click.Abort):
        say_error("terminated" if signals else "interrupted")
        return 128 + signals[0] if signals else INTERRUPTED
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else "eclat"
        say_error(f"{printable(message_of(error))}\n       for help, run: {command} --help")
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
        # Files that cannot be read or written have raised an EclatError, so this error comes from standard output.
        reason = error.strerror or str(error)
        say_error(f"{error.filename}: {reason}" if error.filename else f"standard output: cannot be written: {reason}")
        _give_up_standard_output()
        return MISTAKE


def _give_up_standard_output() -> None:
    """Replace standard output by the null device, because Python would report the error again when it flushes at
    exit."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
