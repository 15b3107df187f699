# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Arrays from .npy and .npz files that may be damaged or hostile: every fault is an EclatError, before memory is spent.

NumPy's own readers believe a header that claims terabytes, hand out bytes where a member is no array, and raise nearly
every type there is.
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

_READERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
_MAGIC = b"\x93NUMPY"

MOST_MEMBERS = 1000
"""Our own archives hold a dozen."""

_GROWTH = 64
"""How much larger than its file the content of an archive may be. Records of a real scene pack to half; more is a bomb."""
_SMALL = 1 << 24
"""Bytes that an archive may hold whatever its size."""

LARGEST_FILE = 1 << 36


def read_file(path: str | os.PathLike[str], *, where: str, limit: int = LARGEST_FILE) -> bytes:
    """The bytes of a regular file of at most `limit` bytes; EclatError for anything else (missing, folder, pipe)."""
    named = "" if where == os.fspath(path) else f": {os.fspath(path)}"
    try:
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):
            what = "a folder" if stat.S_ISDIR(status.st_mode) else "a pipe or a device"
            raise EclatError(f"{where}: expected a file, got {what}{named}")
        if status.st_size > limit:
            raise EclatError(f"{where}: {os.fspath(path)} has {status.st_size} bytes, more than the limit of {limit}")
        return Path(path).read_bytes()
    except FileNotFoundError:
        raise EclatError(f"{where}: file not found{named}") from None
    except EclatError:
        raise
    except (OSError, ValueError, MemoryError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise EclatError(f"{where}: cannot be read{named}: {reason}") from None


def array_from(data: bytes, where: str) -> NDArray[Any]:
    """The array in the bytes of a .npy file: numbers, truth values or text.

    Raises
    ------
    EclatError : anything else, or a header that claims more than the bytes hold.
    """
    file = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(file)
        shape, fortran, dtype = _READERS[version](file)
    except Exception as error:  # The header is Python's source, and its reader raises what Python's parser does.
        raise EclatError(f"{where}: expected a .npy file of numbers: {_short(error)}") from None
    if dtype.kind not in "biufU" or dtype.itemsize == 0:
        raise EclatError(f"{where}: expected a .npy file of numbers: got an array of type {str(dtype)[:60]}")
    count = 1
    for length in shape:
        count *= int(length)
    held = len(data) - file.tell()
    if min(shape, default=0) < 0 or count * dtype.itemsize > held:
        raise EclatError(
            f"{where}: the file is cut off or damaged: its header claims {count} items of {dtype}, got {held} bytes"
        )
    try:
        values = np.frombuffer(data, dtype, count, file.tell())
        # A copy, since what is read from bytes cannot be written to.
        return np.array(values.reshape(shape, order="F" if fortran else "C"))
    except (ValueError, TypeError, OverflowError, MemoryError) as error:
        raise EclatError(f"{where}: expected a .npy file of numbers: {_short(error)}") from None


def arrays_from(data: bytes, where: str) -> dict[str, NDArray[Any]]:
    """Name → array of the bytes of an .npz archive.

    Raises
    ------
    EclatError : no archive, damaged, packed in a way that `numpy.savez` does not use, or one that unpacks to a multiple
        of its size.
    """
    arrays: dict[str, NDArray[Any]] = {}
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            size = sum(member.file_size for member in members)
            if len(members) > MOST_MEMBERS or size > max(_SMALL, _GROWTH * len(data)):
                raise EclatError(
                    f"{where}: the archive claims {len(members)} arrays of {size} bytes, more than it can hold"
                )
            for member in members:
                name = member.filename.removesuffix(".npy")
                arrays[name] = array_from(archive.read(member), f"{where}, array {name[:60]!r}")
    except EclatError:
        raise
    except Exception as error:  # Damaged archives raise nearly every type there is, and NotImplementedError.
        raise EclatError(f"{where}: the file is not an .npz archive, or is damaged ({_short(error)})") from None
    return arrays


def is_array_file(data: bytes) -> bool:
    """Whether bytes begin as a .npy file does."""
    return data.startswith(_MAGIC)


def _short(error: Exception) -> str:
    """The message of an exception, shortened to one line."""
    text = " ".join(str(error).split()) or type(error).__name__
    return text if len(text) <= 120 else text[:117] + "..."
