# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`eclat scenes`: the built-in scenes."""

from __future__ import annotations

from typing import Any

import click

from eclat.cli.command import Command
from eclat.cli.reporting import Reporter, reporting_options

EXAMPLES = {
    "eclat scenes": "List them:",
    "eclat render atrium": "Use one wherever a scene file is asked for:",
}


@click.command(
    "scenes",
    cls=Command,
    short_help="List the built-in scenes.",
    examples=EXAMPLES,
    help="List the built-in scenes, which need no file and are made by code.",
)
@reporting_options
def command(**flags: Any) -> None:
    """One line each."""
    from eclat.scenes import NAMES

    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        width = max(len(name) for name in NAMES)
        text = "\n".join(f"{name:<{width}}  {meaning}" for name, meaning in NAMES.items())
        reporter.result(text, scenes=dict(NAMES))
