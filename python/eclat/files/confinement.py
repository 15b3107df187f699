# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Confine the files that a scene may read to one folder.

`read_file`, which reads every file of a scene, calls `check_confined`. The folder belongs to the current thread or
task, like the warnings in `eclat.errors`, so that loads in two threads can have different folders.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from eclat.errors import EclatError, shown

_root: ContextVar[str | None] = ContextVar("root", default=None)
"""The real path of the folder, or None if files may lie anywhere."""


@contextmanager
def confined_to(root: str | os.PathLike[str] | None) -> Iterator[None]:
    """Confine the files that are read in the block to the folder `root`. None adds no restriction.

    Raises
    ------
    EclatError : `root` is not a folder.
    """
    if root is None:
        yield
        return
    try:
        real = os.path.realpath(root, strict=True)
        is_folder = os.path.isdir(real)
    except (OSError, ValueError, TypeError):
        is_folder = False
    if not is_folder:
        raise EclatError(f"root: expected an existing folder, got {shown(root)}")
    token = _root.set(real)
    try:
        yield
    finally:
        _root.reset(token)


def current_root() -> str | None:
    """Return the folder that files are confined to, or None if they may lie anywhere."""
    return _root.get()


def is_outside(path: str | os.PathLike[str]) -> bool:
    """Return whether `path`, with all symbolic links and `..` resolved, lies outside the folder. The file need not
    exist.

    A path that cannot be looked up, such as one with a zero byte, counts as outside.
    """
    root = _root.get()
    if root is None:
        return False
    try:
        return os.path.commonpath([root, os.path.realpath(path)]) != root
    except (OSError, ValueError):
        return True


def check_confined(path: str | os.PathLike[str], where: str, name: str | None = None) -> None:
    """Raise EclatError if `path` lies outside the folder. The message starts with `where` and calls the file `name` or,
    if that is None, by its path.
    """
    if is_outside(path):
        raise EclatError(
            f"{where}: expected a file below the root folder, got {shown(name or os.fspath(path))}, which lies outside "
            "of it"
        )
