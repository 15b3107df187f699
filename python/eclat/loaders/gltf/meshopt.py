# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decompress buffer views that meshoptimizer compressed [EXT_meshopt_compression; KHR_meshopt_compression].

The decoder is that of the package `meshopt` (the extra `files`).
"""

from __future__ import annotations

from eclat.errors import EclatError
from eclat.loaders.budget import spend
from eclat.loaders.gltf.element import Element
from eclat.loaders.optional import optional_module

EXTENSIONS = ("EXT_meshopt_compression", "KHR_meshopt_compression", "MESHOPT_compression")
"""The names under which files declare this compression."""

_MODES = ("ATTRIBUTES", "TRIANGLES", "INDICES")
_FILTERS = ("NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR")


def meshopt_of(owner: Element) -> Element | None:
    """Return the extension object that compresses a buffer view or marks a buffer as a fallback, or None without one."""
    for name in EXTENSIONS:
        found = owner.extension(name)
        if found is not None:
            return found
    return None


def decompress(packed: Element, data: memoryview, length: int) -> memoryview:
    """Decompress a buffer view.

    Parameters
    ----------
    packed : the extension object of the view.
    data : the compressed bytes.
    length : the number of bytes of the view when it is decompressed.

    Raises
    ------
    EclatError : the object or the data are invalid, or the decoder is not installed.
    """
    count, stride = packed.integer("count"), packed.integer("byteStride")
    mode, filtered = packed.text("mode"), packed.text("filter", "NONE")
    if mode not in _MODES or filtered not in _FILTERS:
        raise EclatError(
            f"{packed.where}: expected a mode of {', '.join(_MODES)} and a filter of {', '.join(_FILTERS)}, "
            f"got {mode[:20]!r} and {filtered[:20]!r}"
        )
    if count * stride != length or count == 0:
        raise EclatError(
            f"{packed.where}: expected {length} bytes, as the buffer view has, got {count} elements of {stride} bytes"
        )
    decoder = optional_module("meshopt", "files", f"{packed.where}: data compressed by meshoptimizer")
    spend(length, packed.where)
    try:
        decoded = decoder.decode_gltf_buffer(bytes(data), count, stride, mode, filtered)
    except (ValueError, RuntimeError, OverflowError, MemoryError) as error:
        raise EclatError(f"{packed.where}: the data cannot be decompressed: {error}") from None
    return memoryview(decoded.tobytes())
