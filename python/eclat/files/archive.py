# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What was solved, in a file: named arrays and a header, in one .npz archive."""

from __future__ import annotations

import io
import json
import os
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np

from eclat.errors import EclatError
from eclat.files.atomic_file import write_file


def write_archive(path: str | os.PathLike[str], header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> None:
    """Whole or not at all. Raises EclatError where it cannot be written."""
    file = io.BytesIO()
    np.savez(file, header=json.dumps(header), **dict(arrays))  # type: ignore[arg-type]
    write_file(path, file.getvalue())


def read_archive(path: str | os.PathLike[str]) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Header and arrays; `center`, where there is one, is checked.

    Raises EclatError where there is no such file, or none that `write_archive` wrote.
    """
    name = os.fspath(path)
    try:
        with open(path, "rb") as file:
            if not zipfile.is_zipfile(file):
                raise zipfile.BadZipFile("it is no .npz archive")
            file.seek(0)
            with np.load(file, allow_pickle=False) as data:
                header = json.loads(str(data["header"]))
                arrays = {n: data[n] for n in data.files if n != "header"}
    except FileNotFoundError:
        raise EclatError(f"{name}: no such file") from None
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError, NotImplementedError) as error:
        raise EclatError(f"{name}: nothing that Éclat saved, or damaged ({error})") from error
    center = arrays.get("center")
    if center is not None and (center.shape != (3,) or center.dtype != np.float64 or not np.isfinite(center).all()):
        raise EclatError(f"{name}: the array 'center' is damaged")
    return header if isinstance(header, dict) else {}, arrays
