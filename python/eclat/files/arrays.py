# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read arrays from .npy and .npz files that may be damaged or malicious.

Every fault raises EclatError before memory is allocated. NumPy's own readers trust a header that claims terabytes, return
bytes for members of an archive that are no arrays, and raise exceptions of many types.
"""

from __future__ import annotations

import io
import os
import stat
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.files.confinement import check_confined

_READERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
_MAGIC = b"\x93NUMPY"

MOST_MEMBERS = 1000
"""The largest number of arrays in an archive. Archives of Éclat have a dozen."""

_GROWTH = 64
"""The largest ratio of the size of the arrays to the size of the archive. Records of a real scene have a ratio of 2. A
much larger ratio is that of a decompression bomb."""
_SMALL = 1 << 24
"""The number of bytes that the arrays of an archive may have in any case."""

LARGEST_FILE = 1 << 36
"""The default limit on the size of a file, in bytes (64 GiB)."""


def read_file(path: str | os.PathLike[str], *, where: str, limit: int = LARGEST_FILE) -> bytes:
    """Read a regular file of at most `limit` bytes. `where` is the start of error messages.

    Raises
    ------
    EclatError : the file does not exist, cannot be read, is larger, is no regular file (a folder, a pipe), or lies
        outside the root folder (`eclat.files.confinement`).
    """
    named = "" if where == os.fspath(path) else f": {os.fspath(path)}"
    try:
        check_confined(path, where)
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):
            what = "a folder" if stat.S_ISDIR(status.st_mode) else "a pipe or a device"
            raise EclatError(f"{where}: expected a file, got {what}{named}")
        if status.st_size > limit:
            raise EclatError(
                f"{where}: expected a file of at most {limit} bytes, got {os.fspath(path)} with {status.st_size} bytes"
            )
        return Path(path).read_bytes()
    except FileNotFoundError:
        raise EclatError(f"{where}: file not found{named}") from None
    except EclatError:
        raise
    except (OSError, ValueError, MemoryError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise EclatError(f"{where}: the file cannot be read{named}: {reason}") from None


def array_from(data: bytes, where: str) -> NDArray[Any]:
    """Decode the array in the bytes of a .npy file. Its items may be numbers, truth values or text.

    Raises
    ------
    EclatError : the bytes are no .npy file, its items have another type, or there are fewer than the header claims.
    """
    file = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(file)
        shape, fortran, dtype = _READERS[version](file)
    except Exception as error:  # The header is a Python expression, whose parser raises exceptions of many types.
        raise EclatError(f"{where}: expected a .npy file of numbers: {_short(error)}") from None
    if dtype.kind not in "biufU" or dtype.itemsize == 0:
        raise EclatError(f"{where}: expected a .npy file of numbers, got an array of type {str(dtype)[:60]}")
    count = 1
    for length in shape:
        count *= int(length)
    held = len(data) - file.tell()
    if min(shape, default=0) < 0 or count * dtype.itemsize > held:
        raise EclatError(
            f"{where}: the file is truncated or damaged: its header claims {count} items of {dtype}, got {held} bytes"
        )
    try:
        values = np.frombuffer(data, dtype, count, file.tell())
        # The array is copied, because an array that shares memory with bytes is read-only.
        return np.array(values.reshape(shape, order="F" if fortran else "C"))
    except (ValueError, TypeError, OverflowError, MemoryError) as error:
        raise EclatError(f"{where}: expected a .npy file of numbers: {_short(error)}") from None


def arrays_from(data: bytes, where: str) -> dict[str, NDArray[Any]]:
    """Decode the arrays in the bytes of an .npz archive, by name.

    Raises
    ------
    EclatError : the bytes are no archive or a damaged one, an array is invalid, or the arrays are too large for the
        size of the archive.
    """
    arrays: dict[str, NDArray[Any]] = {}
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            size = sum(member.file_size for member in members)
            if len(members) > MOST_MEMBERS or size > max(_SMALL, _GROWTH * len(data)):
                raise EclatError(
                    f"{where}: expected at most {MOST_MEMBERS} arrays and {max(_SMALL, _GROWTH * len(data))} bytes in an "
                    f"archive of this size, got {len(members)} arrays and {size} bytes"
                )
            for member in members:
                name = member.filename.removesuffix(".npy")
                arrays[name] = array_from(archive.read(member), f"{where}, array {name[:60]!r}")
    except EclatError:
        raise
    except Exception as error:  # Damaged archives raise exceptions of many types.
        raise EclatError(f"{where}: the file is not an .npz archive, or it is damaged ({_short(error)})") from None
    return arrays


def is_array_file(data: bytes) -> bool:
    """Return whether `data` starts like a .npy file."""
    return data.startswith(_MAGIC)


def _short(error: Exception) -> str:
    """Return the message of an exception on one line, shortened to 120 characters."""
    text = " ".join(str(error).split()) or type(error).__name__
    return text if len(text) <= 120 else text[:117] + "..."
