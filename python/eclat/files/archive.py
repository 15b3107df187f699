# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read and write the files of solved light: named arrays and a header in one .npz archive."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from eclat.errors import EclatError
from eclat.files.arrays import arrays_from, read_file
from eclat.files.atomic_file import write_file


def write_archive(path: str | os.PathLike[str], header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> None:
    """Write an archive atomically. The header must be representable as JSON.

    Raises EclatError if the file cannot be written.
    """
    file = io.BytesIO()
    np.savez(file, header=json.dumps(header), **dict(arrays))  # type: ignore[arg-type]
    write_file(path, file.getvalue())


def read_archive(path: str | os.PathLike[str]) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Read the header and the arrays of an archive.

    The array `center`, if there is one, must consist of 3 finite float64 numbers.

    Raises
    ------
    EclatError : the file does not exist, is damaged, or was not written by `write_archive`.
    """
    name = os.fspath(path)
    data = read_file(path, where=name)
    try:
        arrays = arrays_from(data, name)
        header = json.loads(str(arrays.pop("header")))
        if not isinstance(header, dict):
            raise ValueError("the header is not a JSON object")
    except (ValueError, KeyError, RecursionError) as error:
        reason = str(error).removeprefix(f"{name}: ").removeprefix(f"{name}, ")
        raise EclatError(f"{name}: the file was not saved by Éclat, or it is damaged ({reason})") from error
    center = arrays.get("center")
    if center is not None and (center.shape != (3,) or center.dtype != np.float64 or not np.isfinite(center).all()):
        raise EclatError(
            f"{name}: the file is damaged: expected 3 finite float64 numbers in the array 'center', got others"
        )
    return header, arrays
