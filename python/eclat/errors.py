# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The errors for mistakes of the user, and warnings that can be collected."""

from __future__ import annotations

import difflib
import re
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar


class EclatError(ValueError):
    """The exception for a mistake of the user, such as a bad file or option. The message states what was expected and
    what was found; the command line exits with code 2.
    """


class EclatWarning(UserWarning):
    """A warning that something was replaced, ignored or guessed, while the result is still usable. The command line
    prints it, and loaded scenes keep it."""


_heard: ContextVar[tuple[list[str], ...]] = ContextVar("heard", default=())
"""Lists that collect the warnings of this thread or task. `warnings.catch_warnings` would mix the warnings of all
threads."""

_UNPRINTABLE = re.compile("[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Characters that must not be printed: control characters, which a terminal interprets, characters that change the
direction of text, and surrogates, which represent undecodable bytes."""


def warn(message: str) -> None:
    """Issue an `EclatWarning` whose location is the caller of the function that calls `warn`."""
    for heard in _heard.get():
        heard.append(message)
    warnings.warn(message, EclatWarning, stacklevel=3)


@contextmanager
def heard_warnings() -> Iterator[list[str]]:
    """Collect the texts of all `EclatWarning`s of this thread until the block ends; the warnings are still issued."""
    heard: list[str] = []
    token = _heard.set((*_heard.get(), heard))
    try:
        yield heard
    finally:
        _heard.reset(token)


def printable(text: str, *, lines: bool = False) -> str:
    """Escape the control characters of `text` (as in `\\x1b`), so that a name from a file cannot control a terminal.

    With `lines`, ends of lines are not escaped.
    """
    return _UNPRINTABLE.sub(lambda c: c[0] if lines and c[0] == "\n" else ascii(c[0])[1:-1], text)


def shown(value: object) -> str:
    """Return `repr(value)` for use in a message, on one line and shortened to 80 characters."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 80 else text[:77] + "..."


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return `"; did you mean 'x'?"` with the known word most similar to `word`, or "" if none is similar."""
    matches = difflib.get_close_matches(word, list(known), n=1, cutoff=0.6)
    return f"; did you mean {matches[0]!r}?" if matches else ""
