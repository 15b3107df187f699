# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Text of other programs: encodings and words for numbers that are none."""

from __future__ import annotations

import codecs

import pytest

from eclat.errors import EclatError
from eclat.loaders.text_files import decoded, logical_lines, plain_numbers, utf8

TEXT = "v 0 0 0\nusemtl Fläche\n"


@pytest.mark.parametrize(
    "data",
    [
        TEXT.encode(),
        codecs.BOM_UTF8 + TEXT.encode(),
        codecs.BOM_UTF16_LE + TEXT.encode("utf-16-le"),
        codecs.BOM_UTF16_BE + TEXT.encode("utf-16-be"),
        codecs.BOM_UTF32_LE + TEXT.encode("utf-32-le"),
        codecs.BOM_UTF32_BE + TEXT.encode("utf-32-be"),
        TEXT.encode("utf-16-le"),
        TEXT.encode("utf-16-be"),
    ],
)
def test_encodings_come_as_utf8(data: bytes) -> None:
    assert utf8(data, "a.obj").decode() == TEXT


def test_invalid_utf16_is_kept_or_reported() -> None:
    for data in (b"", b"v", b"ply\nformat", bytes(64), b"v 0 0 0\n\xff\xfe", "Fläche".encode("latin-1")):
        assert utf8(data, "a.obj") == data
    assert decoded("Fläche".encode("latin-1")) == "Fläche"
    with pytest.raises(EclatError, match=r"a\.obj: expected text in UTF-16, because of the first bytes of the file"):
        utf8(codecs.BOM_UTF16_LE + b"v\0 \0\x00\xd8", "a.obj")


def test_numbers_are_read_as_windows_writes_them() -> None:
    words = {b"-nan(ind)": "nan", b"nan(snan)": "nan", b"-1.#IND": "nan", b"1.#QNAN0": "nan", b"1.#INF00": "inf"}
    words |= dict.fromkeys([b"-1.#J", b"1.#R", b"1.#IO", b"1.#QO", b"1.#QNB"], "nan")
    for word, expected in words.items():
        assert str(abs(float(plain_numbers(word)))) == expected
    assert float(plain_numbers(b"-1.#INF")) == float("-inf")
    kept = b"v 1 2 3 # 1.#INFO (ind)\nmap_Kd my(nan).png nan(1).png 2.#IND"
    assert plain_numbers(kept) == kept


def test_lines_keep_their_numbers() -> None:
    lines = list(logical_lines(codecs.BOM_UTF16_LE + "a \\\n b\r\nvn -1.#IND 0 1\n".encode("utf-16-le"), "a.obj"))
    assert lines == [(1, b"a   b"), (3, b"vn -nan 0 1")]
