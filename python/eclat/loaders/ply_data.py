# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read the data of a PLY file as one column for each property.

If all rows of an element have the same size, they are read at once, otherwise row by row.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.loaders.ply_header import Element, Header, Property
from eclat.loaders.text_files import decoded, plain_numbers

Numbers = NDArray[Any]
"""An array of integers or floats, one for each row."""


@dataclass(frozen=True, eq=False)
class Lists:
    """A list property: the items of all rows, one row after the other, and the number of items of each row."""

    items: Numbers
    counts: NDArray[np.int64]


_LONGEST_ALIKE = 1 << 16
"""The largest number of items in a list for which rows are read with a NumPy record type. With longer lists record types
are not faster, and with much longer ones they fail."""

Columns = dict[str, Numbers | Lists]
"""The column of each property by its name."""


def read_elements(data: bytes, header: Header, where: str) -> dict[str, Columns]:
    """Read the columns of all elements, by the name of the element. Numbers are in native byte order.

    The memory is proportional to the size of the file, even if the header claims more rows.

    Raises
    ------
    EclatError : the file ends before the last row, or a word of an ASCII file is no number of the right type.
    """
    result: dict[str, Columns] = {}
    if header.encoding == "ascii":
        words: list[bytes] = plain_numbers(data[header.size :]).split()
        place = 0
        for element in header.elements:
            columns, place = _read_text(words, place, element, where)
            result.setdefault(element.name, columns)
        return result
    place = header.size
    for element in header.elements:
        columns, place = _read_binary(data, place, element, header.encoding, where)
        result.setdefault(element.name, columns)
    return result


def _truncated(element: Element, where: str) -> EclatError:
    return EclatError(
        f"{where}, element {element.name!r}: expected data up to row {element.count}, but the file ends before"
    )


def _read_binary(data: bytes, place: int, element: Element, order: str, where: str) -> tuple[Columns, int]:
    properties = element.properties
    least = sum(np.dtype(p.count_type or p.type).itemsize for p in properties)
    if element.count * least > len(data) - place:
        raise _truncated(element, where)
    if not element.count or not properties:
        return _no_rows(properties), place
    alike = _alike_rows(data, place, element, order)
    if alike is not None:
        return alike
    return _uneven_rows(data, place, element, order, where)


def _no_rows(properties: tuple[Property, ...]) -> Columns:
    none = np.zeros(0, dtype=np.int64)
    return {p.name: Lists(np.zeros(0, p.type), none) if p.count_type else np.zeros(0, p.type) for p in properties}


def _alike_rows(data: bytes, place: int, element: Element, order: str) -> tuple[Columns, int] | None:
    """Read all rows at once if every list has as many items as in the first row, otherwise return None."""
    fields: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
    at = place
    for i, p in enumerate(element.properties):
        if p.count_type is not None:
            count_type = np.dtype(order + p.count_type)
            if at + count_type.itemsize > len(data):
                return None
            length = int(np.frombuffer(data, count_type, 1, at)[0])
            if not 0 <= length <= min(_LONGEST_ALIKE, len(data) - at):
                return None
            fields += [(f"count {i}", order + p.count_type), (f"items {i}", order + p.type, (length,))]
            at += count_type.itemsize + length * np.dtype(p.type).itemsize
        else:
            fields.append((f"items {i}", order + p.type))
            at += np.dtype(p.type).itemsize
    row = np.dtype(fields)
    if element.count * row.itemsize > len(data) - place:
        return None
    table = np.frombuffer(data, row, element.count, place)
    columns: Columns = {}
    for i, p in enumerate(element.properties):
        if p.count_type is not None and (table[f"count {i}"] != table[f"count {i}"][0]).any():
            return None
        values = table[f"items {i}"].astype(p.type)
        if p.count_type is None:
            columns[p.name] = values
        else:
            counts = np.broadcast_to(np.int64(table[f"count {i}"][0]), element.count)
            columns[p.name] = Lists(values.ravel(), counts)
    return columns, place + element.count * row.itemsize


def _uneven_rows(data: bytes, place: int, element: Element, order: str, where: str) -> tuple[Columns, int]:
    pieces: list[list[bytes]] = [[] for _ in element.properties]
    counts: list[list[int]] = [[] for _ in element.properties]
    sign = {"u": False, "i": True}
    endian: Literal["little", "big"] = "little" if order == "<" else "big"
    # For each property: the bytes of the list's count (0 for a number), whether it is signed, the bytes of an item.
    plan = [
        (
            np.dtype(p.count_type).itemsize if p.count_type else 0,
            sign[(p.count_type or "u")[0]],
            np.dtype(p.type).itemsize,
        )
        for p in element.properties
    ]
    for row in range(element.count):
        for i, (count_size, signed, size) in enumerate(plan):
            length = 1
            if count_size:
                length = int.from_bytes(data[place : place + count_size], endian, signed=signed)
                place += count_size
                if length < 0:
                    name = element.properties[i].name
                    raise EclatError(
                        f"{where}, {element.name} {row}: expected a non-negative length of the list {name!r}, got {length}"
                    )
                counts[i].append(length)
            end = place + length * size
            if end > len(data):
                raise _truncated(element, where)
            pieces[i].append(data[place:end])
            place = end
    columns: Columns = {}
    for i, p in enumerate(element.properties):
        values = np.frombuffer(b"".join(pieces[i]), order + p.type).astype(p.type)
        columns[p.name] = Lists(values, np.array(counts[i], dtype=np.int64)) if p.count_type else values
    return columns, place


def _read_text(words: list[bytes], place: int, element: Element, where: str) -> tuple[Columns, int]:
    properties = element.properties
    if element.count * len(properties) > len(words) - place:
        raise _truncated(element, where)
    if not element.count or not properties:
        return _no_rows(properties), place
    if all(p.count_type is None for p in properties):
        width = len(properties)
        end = place + element.count * width
        columns: Columns = {}
        for i, p in enumerate(properties):
            columns[p.name] = _numbers(words[place + i : end : width], p.type, element, p.name, where)
        return columns, end
    return _text_lists(words, place, element, where)


def _text_lists(words: list[bytes], place: int, element: Element, where: str) -> tuple[Columns, int]:
    pieces: list[list[bytes]] = [[] for _ in element.properties]
    counts: list[list[int]] = [[] for _ in element.properties]
    total = len(words)
    for row in range(element.count):
        for i, p in enumerate(element.properties):
            length = 1
            if p.count_type:
                if place >= total:
                    raise _truncated(element, where)
                expected = f"{where}, {element.name} {row}: expected a non-negative length of the list {p.name!r}"
                length = _length(words[place], expected)
                place += 1
                counts[i].append(length)
            if place + length > total:
                raise _truncated(element, where)
            pieces[i] += words[place : place + length]
            place += length
    columns: Columns = {}
    for i, p in enumerate(element.properties):
        values = _numbers(pieces[i], p.type, element, p.name, where)
        columns[p.name] = Lists(values, np.array(counts[i], dtype=np.int64)) if p.count_type else values
    return columns, place


def _length(word: bytes, expected: str) -> int:
    try:
        length = int(word)
    except ValueError:
        length = -1
    if length < 0:
        raise EclatError(f"{expected}, got {decoded(word)[:40]!r}")
    return length


def _numbers(words: list[bytes], kind: str, element: Element, name: str, where: str) -> Numbers:
    """Convert the words of an ASCII file to an array of the type `kind`. Integers may be written like 3.0."""
    read: Callable[[bytes], int | float] = float if kind[0] == "f" else int
    try:
        return np.array(list(map(read, words)), dtype=kind)
    except (ValueError, OverflowError):
        pass
    limits = None if kind[0] == "f" else np.iinfo(kind)
    values = []
    for i, word in enumerate(words):
        try:
            value = float(word)
            if limits is not None and not (value.is_integer() and limits.min <= value <= limits.max):
                raise ValueError
        except ValueError:
            got = decoded(word)[:40]
            raise EclatError(
                f"{where}, element {element.name!r}, property {name!r}, number {i + 1}: expected a number of type {kind}, "
                f"got {got!r}"
            ) from None
        values.append(value)
    return np.array(values).astype(kind)
