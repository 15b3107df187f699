# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A bad part of a scene is left out with a warning, and the rest is loaded."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from eclat.errors import EclatError, warn

MOST_NAMED = 20
"""Parts whose errors are said one by one; the others are counted."""


class LimitError(EclatError):
    """A scene is too large: leaving one part out would not help, so this ends the load."""


class Parts:
    """Reads the parts of a scene one by one and collects their errors.

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
        """The context of one part, which is left out if it raises EclatError. All other exceptions and LimitError
        propagate."""
        try:
            yield
        except LimitError:
            raise
        except EclatError as error:
            self._errors.append(error)
        else:
            self._good += 1

    def finish(self) -> None:
        """Warn of the parts that were left out. Raises the first EclatError if no part was good."""
        if self._errors and not self._good:
            raise self._errors[0]
        for error in self._errors[:MOST_NAMED]:
            warn(f"{error}; it is left out")
        if len(self._errors) > MOST_NAMED:
            warn(f"{len(self._errors) - MOST_NAMED} more parts of the scene are left out for errors like these")
