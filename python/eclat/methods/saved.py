# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read saved solutions of any method."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from eclat.errors import EclatError
from eclat.files.archive import read_archive


@dataclass(frozen=True)
class Common:
    """The fields that all solutions have, as read from a file."""

    options: Any
    fingerprint: str
    max_depth: int
    complete: bool
    statistics: dict[str, float]


class DamagedArrayError(ValueError):
    """An array of a file is missing or malformed; the argument is the name of the array."""


def read_saved(path: str | os.PathLike[str], methods: Mapping[str, Any]) -> Any:
    """Read a saved solution.

    Parameters
    ----------
    path : an `.npz` file that `Solved.save` wrote.
    methods : the classes of methods by name. The attribute `solved` of each is the class of its solutions, which has
        the methods and fields of `Solved`, or None.

    Returns
    -------
    The solution.

    Raises
    ------
    EclatError : the file cannot be read, is damaged, or is not a solution of this version of Éclat.
    """
    name = os.fspath(path)
    header, arrays = read_archive(path)
    known = methods.get(str(header.get("method")))
    cls = known.solved if known is not None else None
    if known is None or cls is None:
        raise EclatError(
            f"{name}: expected a solution of this version of Éclat, got another file: solve the scene again"
        )
    if header.get("format") != cls.format:
        raise EclatError(
            f"{name}: expected a {cls.called} of this version of Éclat, got one of another version: solve the scene again"
        )
    try:
        return cls.from_parts(_common(known(**header["options"]), header), header, arrays)
    except DamagedArrayError as error:
        raise EclatError(f"{name}: the array {str(error)!r} is damaged: solve the scene again") from error
    except (KeyError, TypeError, ValueError, OverflowError, AttributeError) as error:
        raise EclatError(f"{name}: the header is damaged ({error}): solve the scene again") from error


def _common(options: Any, header: Mapping[str, Any]) -> Common:
    """Read the fields that all solutions have. Raises KeyError or ValueError if one is missing or has a wrong type."""
    for name, kind in (("fingerprint", str), ("max_depth", int), ("complete", bool), ("statistics", dict)):
        if type(header[name]) is not kind:
            raise ValueError(f"{name} is {header[name]!r:.60}")
    statistics = {str(name): float(value) for name, value in header["statistics"].items()}
    return Common(options, header["fingerprint"], header["max_depth"], header["complete"], statistics)
