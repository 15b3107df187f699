# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat completion`, which prints the script that lets a shell complete Éclat's commands and options.

The script asks `eclat` itself at each Tab, which answers from the tables that `--help` is made of.
"""

from __future__ import annotations

from typing import Any

import click
from click.shell_completion import get_completion_class

from eclat.cli.command import COMPLETION_VARIABLE, Command
from eclat.cli.parameters import Name

SHELLS = ("bash", "zsh", "fish")

EXAMPLES = {
    'eval "$(eclat completion bash)"': "Complete in this bash; as a line of ~/.bashrc, in every one:",
    'eval "$(eclat completion zsh)"': "Complete in zsh; as a line of ~/.zshrc, after compinit:",
    "eclat completion fish > ~/.config/fish/completions/eclat.fish": "Complete in fish:",
}


@click.command(
    "completion",
    cls=Command,
    short_help="Print a script that completes commands and options in bash, zsh or fish.",
    examples=EXAMPLES,
    help="Print the script that lets SHELL, one of bash, zsh and fish, complete commands, options, names of scenes and "
    "methods, and files. bash 4.4 or newer is needed.",
)
@click.argument("shell", metavar="SHELL", type=Name("SHELL", *SHELLS))
@click.pass_context
def command(context: click.Context, /, **flags: Any) -> None:
    """Print the script."""
    completion = get_completion_class(flags["shell"])
    assert completion is not None
    # The template alone: `source` would run bash to find its version.
    made = completion(context.find_root().command, {}, "eclat", COMPLETION_VARIABLE)
    # click's script for fish splits what it gets at every comma, and so cuts descriptions at their first one.
    template = made.source_template.replace('string split ","', 'string split --max 1 ","')
    click.echo(template % made.source_vars())
