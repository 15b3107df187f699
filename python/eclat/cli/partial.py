# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The option `--keep-partial`, with which an interrupted command writes what it has finished."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from eclat.cli.command import F, option
from eclat.cli.reporting import Reporter


def keep_partial_option(help: str) -> Callable[[F], F]:
    """Make the option `--keep-partial`."""
    return option("--keep-partial", is_flag=True, section="Output", help=help)


@contextmanager
def keeping_partial(wanted: bool, keep: Callable[[Any], None], reporter: Reporter) -> Iterator[None]:
    """On a KeyboardInterrupt, pass its `partial` result to `keep` if `wanted`, and raise the interrupt again."""
    try:
        yield
    except KeyboardInterrupt as stop:
        partial = getattr(stop, "partial", None)
        if wanted and partial is not None:
            keep(partial)
        elif wanted:
            reporter.note("--keep-partial: nothing was written, because nothing was finished yet")
        raise
