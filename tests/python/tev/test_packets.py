# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The bytes of tev's messages, word by word."""

from __future__ import annotations

import struct

import numpy as np

from eclat.tev import packets


def test_a_picture_is_created_with_its_size_and_its_channels() -> None:
    wanted = b"\x04\x01room\0" + struct.pack("<3i", 7, 5, 2) + b"R\0depth.Z\0"
    assert packets.create_image("room", (7, 5), ["R", "depth.Z"]) == struct.pack("<I", len(wanted) + 4) + wanted


def test_an_update_has_a_rectangle_and_its_channels_one_after_the_other() -> None:
    red = np.array([[1, 2, 3], [4, 5, 6]], np.float32)
    got = packets.update_image("é", (8, 9), {"R": red, "G": -red})
    head = b"\x06\x00" + "é".encode() + b"\0" + struct.pack("<i", 2) + b"R\0G\0" + struct.pack("<4i", 8, 9, 3, 2)
    wanted = head + struct.pack("<4q", 0, 6, 1, 1) + struct.pack("<12f", *range(1, 7), *range(-1, -7, -1))
    assert got == struct.pack("<I", len(wanted) + 4) + wanted


def test_squares_are_one_path_that_is_filled_with_one_color() -> None:
    got = packets.squares("room", np.array([[3.5, 4.5], [10, 20]]), 2.0, (1, 0.5, 0.25, 1))
    head = b"\x08\x00room\0\x00" + struct.pack("<i", 5) + struct.pack("<b4f", 2, 1, 0.5, 0.25, 1) + b"\x06"
    wanted = head + struct.pack("<b4f", 18, 2.5, 3.5, 2, 2) + struct.pack("<b4f", 18, 9, 19, 2, 2) + b"\x03"
    assert got == struct.pack("<I", len(wanted) + 4) + wanted


def test_names_end_with_their_zero() -> None:
    assert packets.create_image("a\0b\udc80", (1, 1), [])[6:].startswith(b"a?b?\0")


def test_nothing_is_drawn_where_there_are_no_records() -> None:
    assert packets.squares("room", np.empty((0, 2)), 2.0, (1, 0, 0, 1))[12:16] == struct.pack("<i", 3)
