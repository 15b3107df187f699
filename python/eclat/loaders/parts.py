# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Load the valid parts of a scene, and leave out each invalid part with a warning."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from eclat.errors import EclatError, warn

MOST_NAMED = 20
"""The largest number of invalid parts that get a warning each. One more warning states how many others there are."""


class LimitError(EclatError):
    """The error that a scene is too large. It ends the loading, because leaving out one part would not help."""


class Parts:
    """The errors of a scene's parts, which are collected while the parts are read one by one.

    Examples
    --------
    >>> parts, numbers = Parts(), []
    >>> for text in ("1", "2"):
    ...     with parts.one():
    ...         numbers.append(int(text))
    >>> parts.finish()
    >>> numbers
    [1, 2]
    """

    def __init__(self) -> None:
        self._good = 0
        self._errors: list[EclatError] = []

    @contextmanager
    def one(self) -> Iterator[None]:
        """Read one part in the body of this context.

        If the body raises EclatError, the part counts as left out. LimitError and all other exceptions propagate.
        """
        try:
            yield
        except LimitError:
            raise
        except EclatError as error:
            # The traceback would keep the arrays of the part alive.
            error.__cause__ = error.__context__ = None
            self._errors.append(error.with_traceback(None))
        else:
            self._good += 1

    def finish(self) -> None:
        """Warn about each part that was left out. If no part was valid, raise the first EclatError instead."""
        if self._errors and not self._good:
            raise self._errors[0]
        for error in self._errors[:MOST_NAMED]:
            warn(f"{error}; this part of the scene is left out")
        if len(self._errors) > MOST_NAMED:
            warn(f"{len(self._errors) - MOST_NAMED} more parts of the scene are left out, because they are invalid too")
