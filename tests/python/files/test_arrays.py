# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Damaged and hostile .npy and .npz files: an EclatError of one line, and no memory for what is only claimed."""

from __future__ import annotations

import io
import os
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eclat.errors import EclatError
from eclat.files.arrays import array_from, arrays_from, is_array_file, read_file
from support.mutations import mutated


def npy(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def npz(**arrays: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


def with_header(text: str) -> bytes:
    header = text.encode().ljust(118) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + bytes(64)


def zipped(header: str) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("x.npy", with_header(header))
    return file.getvalue()


ARRAYS = [
    np.arange(12, dtype=np.float32).reshape(3, 4),
    np.asfortranarray(np.arange(6).reshape(2, 3)),
    np.zeros((0, 3)),
    np.array("text"),
    np.array([True, False]),
]


@pytest.mark.parametrize("array", ARRAYS)
def test_arrays_come_as_they_were_saved(array: np.ndarray) -> None:
    for found in (array_from(npy(array), "a"), arrays_from(npz(x=array), "a")["x"]):
        assert found.dtype == array.dtype
        np.testing.assert_array_equal(found, array)
    assert is_array_file(npy(array)) and not is_array_file(npz(x=array))


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("{'descr': '<f4', 'fortran_order': False, 'shape': (85899345920,), }", "claims 85899345920 items of float32"),
        ("{'descr': '<f4', 'fortran_order': False, 'shape': (1" + "0" * 40 + ",), }", "claims 1"),
        ("{'descr': '<f4', 'fortran_order': False, 'shape': (-1,), }", "claims -1 items"),
        ("{'descr': '|O', 'fortran_order': False, 'shape': (1,), }", "got an array of type object"),
        ("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (1,), }", "got an array of type"),
        ("{'descr': '<U0', 'fortran_order': False, 'shape': (99999999999,), }", "got an array of type"),
        ("{'descr': '<f4', 'fortran_order': False, 'shape': (1,)", "expected a .npy file of numbers"),
        ("{'descr': '<f4', 'shape': (1,), }", "expected a .npy file of numbers"),
        ("'(((", "expected a .npy file of numbers"),
        ("[" * 90, "expected a .npy file of numbers"),
    ],
)
def test_headers_that_contradict_the_data_are_refused(header: str, message: str) -> None:
    tracemalloc.start()
    try:
        for read in (lambda: array_from(with_header(header), "a.npy"), lambda: arrays_from(zipped(header), "a.npz")):
            with pytest.raises(EclatError) as caught:
                read()
            assert message in str(caught.value) and "\n" not in str(caught.value)
        assert tracemalloc.get_traced_memory()[1] < 4 << 20
    finally:
        tracemalloc.stop()


def test_invalid_archives_and_archives_that_unpack_to_too_much() -> None:
    for data in (b"", b"PK\x05\x06", npz(x=np.ones(9))[:-30], npy(np.ones(3))):
        with pytest.raises(EclatError, match=r"a\.npz: the file is not an \.npz archive, or it is damaged"):
            arrays_from(data, "a.npz")
    file = io.BytesIO()
    np.savez_compressed(file, x=np.zeros(1 << 22))
    with pytest.raises(EclatError, match="expected at most 1000 arrays and 16777216 bytes in an archive of this size"):
        arrays_from(file.getvalue(), "a.npz")
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("header.npy", b"{}")
    with pytest.raises(EclatError, match=r"array 'header': expected a \.npy file of numbers"):
        arrays_from(file.getvalue(), "a.npz")


@given(mutated(npz(header=np.array("{}"), near=np.ones((4, 3), np.float32))))
@settings(derandomize=True, max_examples=400, deadline=None)
def test_mutated_archives_give_arrays_or_one_line(data: bytes) -> None:
    try:
        assert all(isinstance(array, np.ndarray) for array in arrays_from(data, "a").values())
    except EclatError as error:
        assert "\n" not in str(error)


@given(st.binary(max_size=200))
@settings(derandomize=True, max_examples=200, deadline=None)
def test_any_bytes_after_the_magic(data: bytes) -> None:
    try:
        array_from(b"\x93NUMPY\x01\x00" + data, "a")
    except EclatError as error:
        assert "\n" not in str(error)


def test_files_are_regular_or_refused(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"12345")
    assert read_file(tmp_path / "a", where="cache") == b"12345"
    os.mkfifo(tmp_path / "pipe")
    for name, limit, message in (
        ("pipe", 99, "cache: expected a file, got a pipe or a device"),
        (".", 99, "cache: expected a file, got a folder"),
        ("none", 99, "cache: file not found"),
        ("a", 4, "expected a file of at most 4 bytes, got .* with 5 bytes"),
        ("n" * 300, 99, "cache: the file cannot be read: .*: File name too long"),
        ("nul\0", 99, "cache: the file cannot be read"),
    ):
        with pytest.raises(EclatError, match=message):
            read_file(tmp_path / name, where="cache", limit=limit)
