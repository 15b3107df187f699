# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read text files: decode them, split them into lines, and normalise their spellings of infinity and NaN."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator

from eclat.errors import EclatError

_CONTINUED = re.compile(rb"\\[ \t]*(?:\r\n|\r|\n)")
_BOMS = (
    # UTF-32 comes first, because its byte order mark starts with that of UTF-16.
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_LOOKED_AT = 64
"""The number of bytes that are searched for UTF-16 without a byte order mark. In ASCII text that is encoded as UTF-16,
every second byte is zero."""

_WINDOWS_NUMBER = re.compile(
    rb"(?<![^\s/])([-+]?)(?:1\.#(IND|Q?S?NAN|INF|[JRT]|[IQS]O|[QS]NB)[0-9]*|(nan)\([^)\s]{0,40}\))(?![^\s/])", re.I
)


def utf8(data: bytes, where: str) -> bytes:
    """Convert a text in UTF-16 or UTF-32 to UTF-8, and remove its byte order mark. Other bytes are returned unchanged.

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
        raise EclatError(
            f"{where}: expected text in {encoding.upper()}, because of the first bytes of the file, but it cannot be "
            f"decoded: {error}"
        ) from None


def plain_numbers(data: bytes) -> bytes:
    """Replace the spellings of NaN and infinity that old and new versions of Windows write by nan and inf.

    The old spellings are `-1.#IND`, `1.#QNAN` and `1.#INF`, and the new one is `-nan(ind)`. With fewer than four
    decimals, the old spellings are rounded as if their letters were digits, for example to `-1.#J` or `1.#QO`. Infinity
    and NaN then look the same, and both become NaN.
    """
    if b".#" not in data and b"(" not in data:
        return data
    return _WINDOWS_NUMBER.sub(
        lambda word: word[1] + (b"inf" if word[2] and word[2].upper() == b"INF" else b"nan"), data
    )


def decoded(text: bytes) -> str:
    """Decode `text` as UTF-8, or as Latin-1 if it is not valid UTF-8."""
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("latin-1")


def logical_lines(data: bytes, where: str) -> Iterator[tuple[int, bytes]]:
    """Yield the lines of a text with their numbers, from 1. All line endings are recognised.

    A line that ends with a backslash is joined to the next one. The text may have any encoding that `utf8` accepts.
    NaN and infinity are replaced as in `plain_numbers`.

    Raises
    ------
    EclatError : the text cannot be decoded (see `utf8`).
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
