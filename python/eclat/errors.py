# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What goes wrong, said so that the reader knows what to do: errors for the user's mistakes, warnings as values."""

from __future__ import annotations

import difflib
import warnings
from collections.abc import Iterable


class EclatError(ValueError):
    """A user's mistake: bad file, bad option. The message says what, expected, got and where; the CLI exits with 2."""


class EclatWarning(UserWarning):
    """Something was replaced, ignored or guessed; the result still means something. The CLI says it, scenes keep it."""


def warn(message: str) -> None:
    """Issue an `EclatWarning` that points at the caller's caller."""
    warnings.warn(message, EclatWarning, stacklevel=3)


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """`"; did you mean 'x'?"` for the nearest known word, or an empty string when none is near."""
    matches = difflib.get_close_matches(word, list(known), n=1, cutoff=0.6)
    return f"; did you mean {matches[0]!r}?" if matches else ""
