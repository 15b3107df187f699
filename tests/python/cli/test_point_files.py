# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Files of points: what is read, and what is said about the rest."""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eclat.cli.point_files import HEADING, encode_irradiance, read_points
from eclat.errors import EclatError


def read(tmp_path: Path, text: str | bytes) -> tuple[np.ndarray, np.ndarray]:
    (tmp_path / "p").write_bytes(text.encode() if isinstance(text, str) else text)
    return read_points(str(tmp_path / "p"))


@pytest.mark.parametrize(
    "text",
    [
        "1 2 3 0 0 1\n4 5 6 0 1 0",
        "1,2,3,0,0,1\r\n4,5,6,0,1,0\r\n",
        "\ufeff# Radiance\nx;y;z;nx;ny;nz\n1;2;3;0;0;1\n\n4\t5\t6\t0\t1\t0\n",
        "1,2,3,0,0,1\r\n4,5,6,0,1,0\r\n".encode("utf-16"),
        "1 2 3 0 0 1\n4 5 6 0 1 0\n".encode("utf-16-be"),
    ],
)
def test_ways_to_write_the_same(tmp_path: Path, text: str | bytes) -> None:
    points, normals = read(tmp_path, text)
    np.testing.assert_array_equal(points, [[1, 2, 3], [4, 5, 6]])
    np.testing.assert_array_equal(normals, [[0, 0, 1], [0, 1, 0]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0 0 0 0 1e200 0", ", line 1: expected a finite position and a normal that is not zero, got 0 0 0 0 1e+200 0"),
        ("", ": expected points, one per line, got none"),
        ("x y z\n", ": expected points, one per line, got none"),
        ("1 2 3 0 0 1\n1 2 3\n", ", line 2: expected six numbers x y z nx ny nz, got '1 2 3'"),
        ("1 2 3 0 0 z\n", ", line 1: expected six numbers x y z nx ny nz, got '1 2 3 0 0 z'"),
        ("1 2 3 0 0 1\nx y z\n", ", line 2: expected six numbers x y z nx ny nz, got 'x y z'"),
        (
            "# a\n1 2 nan 0 0 1\n",
            ", line 2: expected a finite position and a normal that is not zero, got 1 2 nan 0 0 1",
        ),
        (
            "1 2 3 0 0 1\n0 1e19 0 0 0 1\n",
            ", line 2: expected a position within ±1e+18 m along each axis, got 0 1e+19 0",
        ),
        ("1 2 3 0 0 0\n", ", line 1: expected a finite position and a normal that is not zero, got 1 2 3 0 0 0"),
    ],
)
def test_bad_lines_are_named(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(EclatError) as caught:
        read(tmp_path, text)
    assert str(caught.value) == f"{tmp_path / 'p'}{message}"


def test_numpy_files(tmp_path: Path) -> None:
    file = io.BytesIO()
    np.save(file, np.arange(12).reshape(2, 6))
    points, _ = read(tmp_path, file.getvalue())
    np.testing.assert_array_equal(points, [[0, 1, 2], [6, 7, 8]])
    file = io.BytesIO()
    np.save(file, np.zeros((2, 3)))
    with pytest.raises(
        EclatError, match=r"expected an array with six columns x y z nx ny nz, got float64 of shape \(2, 3\)"
    ):
        read(tmp_path, file.getvalue())
    with pytest.raises(EclatError, match=r"expected a \.npy file of numbers"):
        read(tmp_path, b"\x93NUMPY\x01\x00")


@given(st.binary(max_size=200))
def test_any_bytes_give_points_or_an_error(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    try:
        points, normals = read(tmp_path_factory.getbasetemp(), data)
    except EclatError:
        return
    assert points.shape == normals.shape and np.isfinite(points).all()


def test_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"0 0 0 0 0 1\n")))
    assert read_points("-")[0].shape == (1, 3)
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"0 0\n")))
    with pytest.raises(EclatError, match="standard input, line 1: expected six numbers"):
        read_points("-")


def test_csv_keeps_every_bit_of_float32() -> None:
    table = np.random.default_rng(1).random((20, 4)).astype(np.float32)
    lines = encode_irradiance(table, ".csv").decode().splitlines()
    assert lines[0] == HEADING
    again = np.array([[float(value) for value in line.split(",")] for line in lines[1:]], dtype=np.float32)
    np.testing.assert_array_equal(again, table)


def test_the_pipe_of_a_shell_is_read_like_a_file() -> None:
    reading, writing = os.pipe()
    with os.fdopen(writing, "wb") as pipe:
        pipe.write(b"1 2 3 0 0 1\n")
    try:
        points, normals = read_points(f"/dev/fd/{reading}")
    finally:
        os.close(reading)
    assert points.tolist() == [[1, 2, 3]] and normals.tolist() == [[0, 0, 1]]
