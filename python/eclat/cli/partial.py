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
    """On Ctrl-C, pass the interrupt's `partial` result to `keep` if that is wanted, then raise the interrupt again."""
    try:
        yield
    except KeyboardInterrupt as stop:
        partial = getattr(stop, "partial", None)
        if wanted and partial is not None:
            keep(partial)
        elif wanted:
            reporter.note("there is nothing to keep yet")
        raise
