# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Reading points with normals from text or NumPy files, and writing their irradiance as CSV or NumPy files."""

from __future__ import annotations

import io
import os
import stat
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eclat.bridge.reach import FARTHEST
from eclat.errors import EclatError
from eclat.files.arrays import array_from, is_array_file
from eclat.loaders.text_files import utf8

SIX_NUMBERS = "six numbers x y z nx ny nz"
"""The content of a line with a point, as error messages describe it."""

HEADING = "irradiance_r,irradiance_g,irradiance_b,lux"
"""The heading of the CSV file of results."""

Float64 = NDArray[np.float64]


def read_points(name: str) -> tuple[Float64, Float64]:
    """Read points and normals, (N, 3) each, from the file `name`, or from standard input if it is `-`.

    Raises
    ------
    EclatError : the file cannot be read or holds no points, a line does not hold six finite numbers, a normal is zero,
        or a position is too far away.
    """
    data = _read(name)
    label = "standard input" if name == "-" else name
    if is_array_file(data):
        table, places = _from_npy(data, label), "row"
        lines = list(range(len(table)))
    else:
        lines, table = _from_text(data, label)
        places = "line"
    if len(table) == 0:
        raise EclatError(f"{label}: expected points, one per line, got none")
    with np.errstate(all="ignore"):
        lengths = np.linalg.norm(table[:, 3:], axis=1)
    bad = ~np.isfinite(table).all(axis=1) | ~(lengths > 0) | ~np.isfinite(lengths)
    if bad.any():
        row = int(np.argmax(bad))
        got = " ".join(f"{value:g}" for value in table[row])
        raise EclatError(
            f"{label}, {places} {lines[row]}: expected a finite position and a normal that is not zero, got {got}"
        )
    far = np.abs(table[:, :3]).max(axis=1) > FARTHEST
    if far.any():
        row = int(np.argmax(far))
        got = " ".join(f"{value:g}" for value in table[row, :3])
        raise EclatError(
            f"{label}, {places} {lines[row]}: expected a position within ±{FARTHEST:g} m along each axis, got {got}"
        )
    return table[:, :3], table[:, 3:]


def encode_irradiance(table: NDArray[np.float32], suffix: str) -> bytes:
    """Encode a table (N, 4) of RGB irradiance and lux as a .npy file, or as CSV with all digits of float32."""
    file = io.BytesIO()
    if suffix == ".npy":
        np.save(file, table, allow_pickle=False)
    else:
        np.savetxt(file, table, fmt="%.9g", delimiter=",", header=HEADING, comments="")
    return file.getvalue()


def _read(name: str) -> bytes:
    if name == "-" and sys.stdin is None:
        raise EclatError("standard input: expected points, but standard input is closed")
    try:
        if name != "-" and _is_endless(name):
            raise EclatError(f"{name}: expected a file of points, or - for standard input, got a pipe or a device")
        return sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes()
    except EclatError:
        raise
    except FileNotFoundError:
        raise EclatError(f"{name}: file not found") from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise EclatError(f"{name}: cannot be read: {reason}") from None


def _is_endless(name: str) -> bool:
    """Return whether `name` is a named pipe, whose reading can wait for ever, or a device, which may never end.

    The pipe of a shell's `<(command)` has no name of its own in the file system, and it is read like a file.
    """
    mode = os.stat(name).st_mode
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)) and os.path.exists(os.path.realpath(name))


def _from_npy(data: bytes, label: str) -> Float64:
    table = array_from(data, label)
    if table.dtype.kind not in "fiu" or table.ndim != 2 or table.shape[1] != 6:
        raise EclatError(
            f"{label}: expected an array with six columns x y z nx ny nz, got {table.dtype} of shape {table.shape}"
        )
    return np.asarray(table, dtype=np.float64)


def _from_text(data: bytes, label: str) -> tuple[list[int], Float64]:
    """Read the line numbers (from 1) and the rows of six numbers of a text."""
    lines: list[int] = []
    rows: list[list[float]] = []
    for number, line in enumerate(utf8(data, label).decode("utf-8", errors="replace").splitlines(), 1):
        fields = line.replace(",", " ").replace(";", " ").split()
        if not fields or fields[0].startswith("#"):
            continue
        try:
            row = [float(field) for field in fields]
        except ValueError:
            row = []
            # A line without any number is a heading if it comes before all points.
            if not rows and not any(_is_number(field) for field in fields):
                continue
        if len(row) != 6:
            raise EclatError(f"{label}, line {number}: expected {SIX_NUMBERS}, got {line.strip()[:80]!r}")
        lines.append(number)
        rows.append(row)
    return lines, np.array(rows, dtype=np.float64).reshape(-1, 6)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
