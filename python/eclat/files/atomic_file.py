# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Files that are either whole or not there: written beside their place under another name, then moved."""

from __future__ import annotations

import contextlib
import os
import stat
import tempfile
from pathlib import Path

from eclat.errors import EclatError


def write_file(path: str | os.PathLike[str], data: bytes) -> None:
    """Write `data` to `path` such that a failure or an interrupt leaves what was there before.

    The folder must exist. A link keeps pointing where it points; an existing file keeps its permissions.

    Raises
    ------
    EclatError : the file cannot be written; the message names it and says why (disk full, no permission, …).
    """
    target = Path(os.path.realpath(path))
    check_writable(path)
    try:
        _replace(target, data)
    except OSError as error:
        raise EclatError(f"{os.fspath(path)}: cannot be written: {error.strerror or error}") from None


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise the EclatError that `write_file` would meet for a bad place, before hours of work are spent."""
    name, target = os.fspath(path), Path(os.path.realpath(path))
    if not target.parent.is_dir():
        raise EclatError(f"{name}: cannot be written: the folder {target.parent} does not exist")
    if target.exists() and not target.is_file():
        raise EclatError(f"{name}: cannot be written: expected a file name, but this is a folder or a device")
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise EclatError(f"{name}: cannot be written: no permission to create files in {target.parent}")


def _replace(target: Path, data: bytes) -> None:
    # Read before anything is created: the file may be replaced by something else meanwhile.
    mode = _mode(target)
    # A short fixed prefix, since the target's own name may already be as long as the file system allows.
    handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=".eclat-", suffix=".partial")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            # Some file systems (quotas, networks) report a full disk only here.
            os.fsync(file.fileno())
        os.chmod(temporary, mode)
        os.replace(temporary, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise


def _mode(target: Path) -> int:
    """Permissions for the new file: those of the old one, else what `open` would give."""
    try:
        return stat.S_IMODE(target.stat().st_mode)
    except OSError:
        umask = os.umask(0)
        os.umask(umask)
        return 0o666 & ~umask
