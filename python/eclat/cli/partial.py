# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`--keep-partial`: what an interrupted command leaves behind."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from eclat.cli.command import F, option
from eclat.cli.reporting import Reporter


def keep_partial_option(help: str) -> Callable[[F], F]:
    """`--keep-partial`."""
    return option("--keep-partial", is_flag=True, section="Output", help=help)


@contextmanager
def keeping_partial(wanted: bool, keep: Callable[[Any], None], reporter: Reporter) -> Iterator[None]:
    """On Ctrl-C give what the interrupt carries as its `partial` to `keep`, if that is wanted, and let it go on."""
    try:
        yield
    except KeyboardInterrupt as stop:
        partial = getattr(stop, "partial", None)
        if wanted and partial is not None:
            keep(partial)
        elif wanted:
            reporter.note("there is nothing to keep yet")
        raise
