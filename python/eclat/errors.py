# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Errors for the user's mistakes and warnings that can be collected; each message tells the reader what to do."""

from __future__ import annotations

import difflib
import re
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar


class EclatError(ValueError):
    """A user's mistake, such as a bad file or option. The message states what was expected; the CLI exits with 2."""


class EclatWarning(UserWarning):
    """Something was replaced, ignored or guessed; the result is still usable. The CLI prints it, scenes keep it."""


_heard: ContextVar[tuple[list[str], ...]] = ContextVar("heard", default=())
"""Lists that keep what is said in this thread or task: `warnings.catch_warnings` would mix those of all threads."""

_UNPRINTABLE = re.compile("[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters, which a terminal obeys, those that turn the direction of text, and bytes that are no text."""


def warn(message: str) -> None:
    """Issue an `EclatWarning` that points at the caller's caller."""
    for heard in _heard.get():
        heard.append(message)
    warnings.warn(message, EclatWarning, stacklevel=3)


@contextmanager
def heard_warnings() -> Iterator[list[str]]:
    """The text of every `EclatWarning` of this thread until the block ends; they are issued all the same."""
    heard: list[str] = []
    token = _heard.set((*_heard.get(), heard))
    try:
        yield heard
    finally:
        _heard.reset(token)


def printable(text: str, *, lines: bool = False) -> str:
    """`text` with its control characters spelled out (`\\x1b`), so that a name from a file cannot steer a terminal.

    With `lines`, line ends stay.
    """
    return _UNPRINTABLE.sub(lambda c: c[0] if lines and c[0] == "\n" else ascii(c[0])[1:-1], text)


def shown(value: object) -> str:
    """`repr(value)` for a message: on one line, whatever the value is, and at most 80 characters."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 80 else text[:77] + "..."


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """`"; did you mean 'x'?"` for the nearest known word, or an empty string when none is near."""
    matches = difflib.get_close_matches(word, list(known), n=1, cutoff=0.6)
    return f"; did you mean {matches[0]!r}?" if matches else ""
