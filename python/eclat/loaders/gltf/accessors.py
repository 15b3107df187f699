# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read accessors: typed arrays in buffers, which may be strided, normalised or sparse [glTF 2.0, 3.6.2]."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.loaders.budget import spend
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import Element

Numbers = NDArray[Any]

COMPONENT_TYPES: dict[int, np.dtype] = {
    5120: np.dtype("i1"),
    5121: np.dtype("u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    5126: np.dtype("<f4"),
}
"""The NumPy type of each componentType."""
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
"""The number of components of each type of element."""

MAX_ZEROS = 1 << 20
"""The largest number of elements in an accessor without a buffer view, which consists of zeros. The zeros take no memory,
but what is computed from them does."""


class Accessors:
    """The accessors of a document. Each is read once. The arrays are shared with each other and with the buffers, so they
    must not be modified."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self._arrays: dict[int, Numbers] = {}
        self.overlays: dict[str, dict[int, Numbers]] = {}
        """What was decompressed for each primitive: arrays by the indices of accessors."""

    def overlaid(self, arrays: dict[int, Numbers]) -> Accessors:
        """Return the same accessors, of which some have the given arrays (count, width), by their indices."""
        result = copy.copy(self)
        result._arrays = self._arrays | arrays
        return result

    def count(self, owner: Element, member: str) -> int:
        """Return the number of elements of the accessor whose index is the member `member` of `owner`, or 0 without
        one.
        """
        accessor = self.document.element(owner, member, "accessors")
        return 0 if accessor is None else accessor.integer("count")

    def has_data(self, owner: Element, member: str) -> bool:
        """Return whether the accessor whose index is the member `member` of `owner` exists and has data other than
        zeros.
        """
        accessor = self.document.element(owner, member, "accessors")
        return accessor is not None and ("bufferView" in accessor.data or "sparse" in accessor.data)

    def floats(self, owner: Element, member: str, types: tuple[str, ...]) -> NDArray[np.float32] | None:
        """Read an accessor as floats, shape (N, width). Normalised integers are decoded to 0..1 or −1..1.

        The index of the accessor is the member `member` of `owner`. If it is absent, the result is None. Raises
        EclatError if the accessor is invalid or its type is not one of `types`.
        """
        found = self._read(owner, member, types)
        if found is None:
            return None
        accessor, values = found
        if values.dtype.kind == "f":
            return values
        decoded = values.astype(np.float32)
        if not accessor.flag("normalized"):
            return decoded
        # The decoding is symmetric, so that both the smallest integer and the one above it become −1.
        scaled: NDArray[np.float32] = decoded / np.float32(np.iinfo(values.dtype).max)
        return np.maximum(scaled, np.float32(-1))

    def integers(self, owner: Element, member: str) -> NDArray[np.unsignedinteger] | None:
        """Read an accessor as unsigned integers, shape (N,).

        The index of the accessor is the member `member` of `owner`. If it is absent, the result is None. Raises
        EclatError if the accessor is invalid.
        """
        found = self._read(owner, member, ("SCALAR",))
        if found is None:
            return None
        accessor, values = found
        if values.dtype.kind != "u":
            raise EclatError(f"{accessor.where}: expected unsigned integers for {owner.at(member)}, got {values.dtype}")
        return values[:, 0]

    def _read(self, owner: Element, member: str, types: tuple[str, ...]) -> tuple[Element, Numbers] | None:
        accessors = self.document.elements("accessors")
        index = owner.index(member, len(accessors), "accessors")
        if index is None:
            return None
        accessor = accessors[index]
        kind = accessor.text("type")
        if kind not in types:
            raise EclatError(
                f"{accessor.where}: expected {' or '.join(types)} for {owner.at(member)}, got {kind[:20]!r}"
            )
        if index not in self._arrays:
            self._arrays[index] = _read_accessor(self.document, accessor)
        return accessor, self._arrays[index]


def _read_accessor(document: Document, accessor: Element) -> Numbers:
    """Read an accessor, shape (count, width), with the component type of the file."""
    dtype = component_type(accessor)
    width = WIDTHS[accessor.text("type")]
    count = accessor.integer("count")
    view = document.buffer_view(accessor)
    if view is not None:
        values = _elements(view, accessor, dtype, width, count)
    elif count > MAX_ZEROS:
        raise EclatError(
            f"{accessor.where}: expected a bufferView, or at most {MAX_ZEROS} elements without one, got {count} elements"
        )
    else:
        values = np.broadcast_to(np.zeros(1, dtype), (count, width))
    sparse = accessor.child("sparse")
    return values if sparse is None else _substitute(document, sparse, values)


def component_type(owner: Element) -> np.dtype:
    """Return the NumPy type of the components of an accessor. Raises EclatError if its code is unknown."""
    code = owner.integer("componentType")
    if code not in COMPONENT_TYPES:
        raise EclatError(f"{owner.at('componentType')}: expected one of {list(COMPONENT_TYPES)}, got {code}")
    return COMPONENT_TYPES[code]


def _elements(view: tuple[memoryview, int | None], owner: Element, dtype: np.dtype, width: int, count: int) -> Numbers:
    """Return `count` elements of a buffer view as an array (count, width) that shares the memory of the buffer."""
    data, stride = view
    size = dtype.itemsize * width
    stride = stride or size
    start = owner.integer("byteOffset", 0)
    if stride < size:
        raise EclatError(f"{owner.where}: expected a byteStride of at least {size} bytes, got {stride}")
    if count == 0:
        return np.zeros((0, width), dtype)
    end = start + stride * (count - 1) + size
    if end > len(data):
        raise EclatError(
            f"{owner.where}: expected a bufferView of at least {end} bytes for {count} elements, got {len(data)} bytes"
        )
    return np.ndarray((count, width), dtype, data, start, (stride, dtype.itemsize))


def _substitute(document: Document, sparse: Element, values: Numbers) -> Numbers:
    """Copy `values`, and replace the elements that the object `sparse` of an accessor lists."""
    count = sparse.integer("count")
    where, new = sparse.child("indices"), sparse.child("values")
    if where is None or new is None:
        raise EclatError(f"{sparse.where}: expected 'indices' and 'values', got only {sorted(sparse.data)[:5]}")
    index_view, value_view = document.buffer_view(where), document.buffer_view(new)
    if index_view is None or value_view is None:
        raise EclatError(f"{sparse.where}: expected a bufferView for 'indices' and for 'values', got none")
    indices = _elements(index_view, where, component_type(where), 1, count)[:, 0]
    if indices.dtype.kind != "u" or (count and int(indices.max()) >= len(values)):
        raise EclatError(
            f"{where.where}: expected unsigned integers below {len(values)}, the count of the accessor, got others"
        )
    spend(values.nbytes, sparse.where)
    result = values.copy()
    result[indices] = _elements(value_view, new, values.dtype, values.shape[1], count)
    return result
