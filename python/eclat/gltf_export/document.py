# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Build a binary glTF file from JSON lists and one buffer [glTF 2.0, 3.6 and 4.4]."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

from eclat.errors import EclatError

Json = dict[str, Any]

VERTICES, INDICES = 34962, 34963
"""The targets of buffer views, which tell a viewer the kind of GPU buffer to use (values from the specification)."""

_COMPONENTS = {"f4": 5126, "u4": 5125, "u2": 5123}
_SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_MAX_BYTES = 2**32 - 1
"""The largest size of a binary glTF file, because its header has 32 bits for the length."""


class Document:
    """A glTF file under construction: the top-level lists of elements, and the buffer that they refer to."""

    def __init__(self, generator: str) -> None:
        self.root: Json = {"asset": {"version": "2.0", "generator": generator}}
        self._bytes = bytearray()
        self._extensions: set[str] = set()

    def add(self, kind: str, value: Json) -> int:
        """Append `value` to the top-level list `kind`, such as "meshes" or "nodes", and return its index."""
        values = self.root.setdefault(kind, [])
        values.append(value)
        return len(values) - 1

    def use(self, extension: str) -> str:
        """Declare an extension as used but not required, and return its name."""
        self._extensions.add(extension)
        return extension

    def view(self, data: bytes, target: int | None = None) -> int:
        """Append `data` to the buffer, and return the index of its buffer view.

        `target` is `VERTICES`, `INDICES`, or None for images.
        """
        self._bytes += b"\0" * (-len(self._bytes) % 4)
        view: Json = {"buffer": 0, "byteOffset": len(self._bytes), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self._bytes += data
        return self.add("bufferViews", view)

    def accessor(self, values: np.ndarray, kind: str, target: int, *, bounds: bool = False) -> int:
        """Append an array to the buffer, and return the index of its accessor.

        Parameters
        ----------
        values : (N,) or (N, width) numbers.
        kind : the NumPy type to store: "f4", "u2" or "u4".
        target : `VERTICES` or `INDICES`.
        bounds : whether to write the minimum and the maximum of each component.
        """
        array = np.ascontiguousarray(values, np.dtype(kind).newbyteorder("<"))
        columns = array.reshape(len(array), -1)
        accessor: Json = {
            "bufferView": self.view(array.tobytes(), target),
            "componentType": _COMPONENTS[kind],
            "count": len(array),
            "type": _SHAPES[columns.shape[1]],
        }
        if bounds:
            accessor |= {"min": columns.min(axis=0).tolist(), "max": columns.max(axis=0).tolist()}
        return self.add("accessors", accessor)

    def encode(self) -> bytes:
        """Encode the file. Raises EclatError if it exceeds 4 GiB, the limit of the format."""
        root = dict(self.root)
        if self._extensions:
            root["extensionsUsed"] = sorted(self._extensions)
        body = bytes(self._bytes) + b"\0" * (-len(self._bytes) % 4)
        if body:
            root["buffers"] = [{"byteLength": len(self._bytes)}]
        text = json.dumps(root, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        if body:
            chunks += struct.pack("<I4s", len(body), b"BIN\0") + body
        size = 12 + len(chunks)
        if size > _MAX_BYTES:
            raise EclatError(
                f"expected a scene that fits into a binary glTF file of at most 4 GiB, got {size / 2**30:.1f} GiB"
            )
        return struct.pack("<4sII", b"glTF", 2, size) + chunks


def eclat_extras(**values: Any) -> Mapping[str, Json]:
    """Return the member `extras` of an element, with `values` that only Éclat reads, under the key "eclat"."""
    return {"extras": {"eclat": values}}
