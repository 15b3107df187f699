# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The format of the viewer's messages."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from eclat.viewer.messages import ALIGNMENT, MAGIC, VERSION, decode_message, encode_message

ARRAYS = {
    "a": np.arange(6, dtype=np.float32).reshape(2, 3),
    "half": np.array([0.5, 2], np.float16),
    "long name of an array": np.array([[1], [2], [3]], np.uint32),
    "bytes": np.arange(5, dtype=np.uint8),
    "empty": np.zeros((0, 52), np.float32),
}


def test_a_message_is_read_as_it_was_written() -> None:
    header, arrays = decode_message(encode_message("records", {"first": 3, "name": "Éclat"}, ARRAYS))
    assert header == {"kind": "records", "first": 3, "name": "Éclat"}
    assert list(arrays) == list(ARRAYS)
    for name, array in ARRAYS.items():
        assert arrays[name].dtype == array.dtype and arrays[name].shape == array.shape
        np.testing.assert_array_equal(arrays[name], array)


@pytest.mark.parametrize("count", [1, 9, 10, 11, 100, 1000])
def test_all_arrays_are_aligned_and_the_bytes_are_as_documented(count: int) -> None:
    arrays = {f"array {i}": np.full(i % 7, i, np.float32) for i in range(count)}
    data = encode_message("scene", {}, arrays)
    assert data[:4] == MAGIC == b"ECLV"
    version, length = struct.unpack_from("<II", data, 4)
    assert version == VERSION and (12 + length) % ALIGNMENT == 0
    header, decoded = decode_message(data)
    assert header == {"kind": "scene"}
    for i in range(count):
        assert (decoded[f"array {i}"] == i).all() and len(decoded[f"array {i}"]) == i % 7


def test_big_endian_arrays_are_sent_as_little_endian() -> None:
    _, arrays = decode_message(encode_message("light", {}, {"a": np.array([1.5], ">f4")}))
    assert arrays["a"][0] == 1.5


@pytest.mark.parametrize("data", [b"", b"ECLV", b"PK\3\4 and so on, long enough"])
def test_other_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(ValueError, match="expected a message of the viewer"):
        decode_message(data)


def test_another_version_is_refused() -> None:
    data = bytearray(encode_message("light", {}, {}))
    data[4] = VERSION + 1
    with pytest.raises(ValueError, match=f"expected version {VERSION}"):
        decode_message(bytes(data))


def test_an_array_of_another_type_is_refused() -> None:
    with pytest.raises(KeyError):
        encode_message("light", {}, {"a": np.zeros(3)})
