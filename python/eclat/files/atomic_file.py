# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Files that are written whole or not at all: each is written under another name beside its place, then renamed."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from eclat.errors import EclatError


def write_file(path: str | os.PathLike[str], data: bytes) -> None:
    """Write `data` to `path` such that a failure or an interrupt leaves what was there before.

    The folder must exist. A link keeps pointing where it points; an existing file keeps its permissions.

    Raises
    ------
    EclatError : the file cannot be written; the message names it and says why (disk full, no permission, …).
    """
    write_files({path: data})


def write_files(contents: Mapping[str | os.PathLike[str], bytes]) -> None:
    """Write files that belong together, all or none, as `write_file` writes one. The last one appears last.

    Only a crash between two renames, microseconds apart, leaves some new and some old.
    """
    for name in contents:
        check_writable(name)
    written: list[_Written] = []
    path: str | os.PathLike[str] = ""
    try:
        for path, data in contents.items():
            target = Path(os.path.realpath(path))
            written.append(_Written(path, target, _written_beside(target, data)))
        for file in written:
            path = file.path
            if len(written) > 1:
                file.keep_what_was_there()
            os.replace(file.temporary, file.target)
            file.replaced = True
    except BaseException as error:
        for file in written:
            file.undo()
        if isinstance(error, OSError):
            raise EclatError(f"{os.fspath(path)}: cannot be written: {error.strerror or error}") from None
        raise
    for file in written:
        _remove(file.backup)


@dataclass
class _Written:
    """A file being written: first complete under another name, then moved to its place."""

    path: str | os.PathLike[str]
    target: Path
    temporary: str
    backup: str = ""
    """Another name of what was there."""
    was_there: bool = True
    replaced: bool = False

    def keep_what_was_there(self) -> None:
        self.was_there = self.target.exists()
        backup = f"{self.target.parent}/.eclat-{secrets.token_hex(8)}.partial"
        # Some file systems have no links: what was there is then not restored.
        with contextlib.suppress(OSError):
            os.link(self.target, backup)
            self.backup = backup

    def undo(self) -> None:
        _remove(self.temporary)
        if self.replaced and self.backup:
            with contextlib.suppress(OSError):
                os.replace(self.backup, self.target)
        elif self.replaced and not self.was_there:
            _remove(str(self.target))
        _remove(self.backup)


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise the EclatError that `write_file` would meet for a bad place, before hours of work are spent."""
    name, target = os.fspath(path), Path(os.path.realpath(path))
    try:
        if not target.parent.is_dir():
            raise EclatError(f"{name}: cannot be written: the folder {target.parent} does not exist")
        if target.exists() and not target.is_file():
            raise EclatError(f"{name}: cannot be written: expected a file name, but this is a folder or a device")
    except OSError as error:  # the name is too long, most of all
        raise EclatError(f"{_shortened(name)}: cannot be written: {error.strerror or error}") from None
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise EclatError(f"{name}: cannot be written: no permission to create files in {target.parent}")


def _shortened(name: str) -> str:
    return name if len(name) <= 100 else name[:60] + "…" + name[-39:]


def _written_beside(target: Path, data: bytes) -> str:
    """The name of a new file in the target's folder that holds `data`."""
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
    except BaseException:
        _remove(temporary)
        raise
    return temporary


def _remove(name: str) -> None:
    """Where there is such a file."""
    with contextlib.suppress(OSError):
        os.unlink(name)


def _mode(target: Path) -> int:
    """Permissions for the new file: those of the old one, else what `open` would give."""
    try:
        return stat.S_IMODE(target.stat().st_mode)
    except OSError:
        umask = os.umask(0)
        os.umask(umask)
        return 0o666 & ~umask
