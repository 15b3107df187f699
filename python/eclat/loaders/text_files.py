# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Reads text files: their encodings, their lines, and the words for infinity and NaN."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator

from eclat.errors import EclatError

_CONTINUED = re.compile(rb"\\[ \t]*(?:\r\n|\r|\n)")
_BOMS = (
    # UTF-32 before UTF-16, whose mark is the beginning of the other's.
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_LOOKED_AT = 64
"""Bytes in which UTF-16 without a mark shows: every second one of them is zero where the text is English."""

_WINDOWS_NUMBER = re.compile(
    rb"(?<![^\s/])([-+]?)(?:1\.#(IND|Q?S?NAN|INF)[0-9]*|(nan)\([^)\s]{0,40}\))(?![^\s/])", re.I
)


def utf8(data: bytes, where: str) -> bytes:
    """The bytes of a text as UTF-8 without a byte order mark; what is UTF-16 or UTF-32 is converted, the rest kept.

    Raises
    ------
    EclatError : the text is marked as UTF-16 or UTF-32 but cannot be decoded.
    """
    head = data[:_LOOKED_AT]
    encoding = next((name for mark, name in _BOMS if head.startswith(mark)), None)
    if encoding is None and len(head) >= 8 and not len(head) % 2:
        if not any(head[1::2]) and all(head[::2]):
            encoding = "utf-16-le"
        elif not any(head[::2]) and all(head[1::2]):
            encoding = "utf-16-be"
    if encoding is None:
        return data.removeprefix(codecs.BOM_UTF8)
    try:
        return data.decode(encoding).encode("utf-8")
    except UnicodeError as error:
        raise EclatError(f"{where}: expected text in {encoding.upper()}, as its beginning says; {error}") from None


def plain_numbers(data: bytes) -> bytes:
    """`-1.#IND`, `1.#QNAN`, `1.#INF` (old) and `-nan(ind)` (new), as Windows writes numbers, become nan and inf."""
    if b".#" not in data and b"(" not in data:
        return data
    return _WINDOWS_NUMBER.sub(
        lambda word: word[1] + (b"inf" if word[2] and word[2].upper() == b"INF" else b"nan"), data
    )


def decoded(text: bytes) -> str:
    """The text decoded as UTF-8, or as Latin-1 if that fails."""
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("latin-1")


def logical_lines(data: bytes, where: str) -> Iterator[tuple[int, bytes]]:
    """Numbered lines (from 1), those that end with a backslash joined to the next; any line ending.

    The bytes may be as in `utf8`, whose EclatError passes; words for NaN and infinity are made Python's.
    """
    data = plain_numbers(utf8(data, where))
    if not _CONTINUED.search(data):
        yield from enumerate(data.splitlines(), 1)
        return
    number, parts = 0, []
    for number, line in enumerate(data.splitlines(), 1):
        bare = line.rstrip(b" \t")
        if bare.endswith(b"\\"):
            parts.append(bare[:-1])
        else:
            yield number - len(parts), b" ".join([*parts, line])
            parts = []
    if parts:
        yield number - len(parts) + 1, b" ".join(parts)
