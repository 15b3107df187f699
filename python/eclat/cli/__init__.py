# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command line: the table of commands, and what becomes of errors.

Exit codes: 0 done, 1 standard output was closed early, 2 the user's mistake (said on standard error), 130 Ctrl-C.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import Any

import click

import eclat
from eclat.cli.command import Group
from eclat.cli.reporting import message_of, say_error
from eclat.errors import EclatError

COMMANDS: dict[str, str] = {
    "render": "eclat.cli.render",
    "solve": "eclat.cli.solve",
    "irradiance": "eclat.cli.irradiance",
    "bake": "eclat.cli.bake",
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
    try:
        with group.make_context("eclat", arguments or ["--help"]) as context:
            group.invoke(context)
    except click.exceptions.Exit as stop:
        return stop.exit_code
    except (KeyboardInterrupt, click.Abort):
        say_error("interrupted")
        return INTERRUPTED
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else "eclat"
        say_error(f"{message_of(error)}\n       try: {command} --help")
        return MISTAKE
    except (EclatError, click.ClickException) as error:
        say_error(message_of(error))
        return MISTAKE
    except MemoryError:
        say_error("not enough memory")
        return MISTAKE
    except BrokenPipeError:
        # Python would complain once more when it flushes standard output at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    return DONE
