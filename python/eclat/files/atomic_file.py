# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Write files atomically: each file is written under a temporary name in the same folder and then renamed."""

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
    """Write `data` to the file `path` atomically. After a failure or an interrupt, the previous file is unchanged.

    The folder must exist. If `path` is a symbolic link, the file that it refers to is written. An existing file keeps its
    permissions.

    Raises
    ------
    EclatError : the file cannot be written. The message names the file and the reason, such as a full disk.
    """
    write_files({path: data})


def write_files(contents: Mapping[str | os.PathLike[str], bytes]) -> None:
    """Write several files so that either all of them or none of them change. They appear in the order of `contents`.

    Only a crash of the process within the few microseconds between two renames can leave some files new and some old.

    Raises
    ------
    EclatError : a file cannot be written (see `write_file`).
    """
    for name in contents:
        check_writable(name)
    written: list[_Written] = []
    path: str | os.PathLike[str] = ""
    try:
        for path, data in contents.items():
            target = Path(os.path.realpath(path))
            written.append(_Written(path, target, _write_temporary(target, data)))
        for file in written:
            path = file.path
            if len(written) > 1:
                file.back_up()
            os.replace(file.temporary, file.target)
            file.replaced = True
    except BaseException as error:
        for file in written:
            file.undo()
        if isinstance(error, OSError):
            raise EclatError(f"{os.fspath(path)}: the file cannot be written: {error.strerror or error}") from None
        raise
    for file in written:
        _remove(file.backup)


@dataclass
class _Written:
    """A file that is being written: its final path `target`, and the temporary file with its new content."""

    path: str | os.PathLike[str]
    target: Path
    temporary: str
    backup: str = ""
    """A second name (hard link) of the previous file, or an empty string if there is none."""
    existed: bool = True
    """Whether there was a previous file."""
    replaced: bool = False
    """Whether the new file is in its place."""

    def back_up(self) -> None:
        """Keep the previous file under a second name, so that `undo` can restore it."""
        self.existed = self.target.exists()
        backup = f"{self.target.parent}/.eclat-{secrets.token_hex(8)}.partial"
        # On a file system without hard links, the previous file cannot be restored.
        with contextlib.suppress(OSError):
            os.link(self.target, backup)
            self.backup = backup

    def undo(self) -> None:
        """Remove the temporary file, and restore the previous file or its absence."""
        _remove(self.temporary)
        if self.replaced and self.backup:
            with contextlib.suppress(OSError):
                os.replace(self.backup, self.target)
        elif self.replaced and not self.existed:
            _remove(str(self.target))
        _remove(self.backup)


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise EclatError if `write_file` could not write to `path`. Call it before a long computation."""
    name, target = os.fspath(path), Path(os.path.realpath(path))
    try:
        if not target.parent.is_dir():
            raise EclatError(f"{name}: the file cannot be written, because the folder {target.parent} does not exist")
        if target.exists() and not target.is_file():
            raise EclatError(f"{name}: the file cannot be written, because this is the name of a folder or a device")
    except OSError as error:  # for example if the name is too long
        raise EclatError(f"{_shortened(name)}: the file cannot be written: {error.strerror or error}") from None
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise EclatError(
            f"{name}: the file cannot be written, because there is no permission to create files in {target.parent}"
        )


def _shortened(name: str) -> str:
    return name if len(name) <= 100 else name[:60] + "…" + name[-39:]


def _write_temporary(target: Path, data: bytes) -> str:
    """Write `data` to a new temporary file in the folder of `target`, and return its name."""
    # The permissions are read first, because another process may replace the file meanwhile.
    mode = _mode(target)
    # The prefix is short and fixed, because the name of the target may already have the maximum length.
    handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=".eclat-", suffix=".partial")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            # Some file systems, such as network drives and those with quotas, only report a full disk here.
            os.fsync(file.fileno())
        os.chmod(temporary, mode)
    except BaseException:
        _remove(temporary)
        raise
    return temporary


def _remove(name: str) -> None:
    """Remove the file `name` if it exists."""
    with contextlib.suppress(OSError):
        os.unlink(name)


def _mode(target: Path) -> int:
    """Return the permissions of the new file: those of the previous file or, if there is none, those that `open` would
    set.
    """
    try:
        return stat.S_IMODE(target.stat().st_mode)
    except OSError:
        umask = os.umask(0)
        os.umask(umask)
        return 0o666 & ~umask
