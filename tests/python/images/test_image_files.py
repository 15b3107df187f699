# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The table of picture formats: headers, damage, metadata."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from eclat.errors import EclatError
from eclat.images.image import Image
from eclat.images.image_files import FORMATS, read_png_metadata


def message_of(path: Path) -> str:
    with pytest.raises(EclatError) as caught:
        Image.load(path)
    return str(caught.value).removeprefix(f"{path}: ")


def test_pfm_by_the_book(tmp_path: Path) -> None:
    """Rows run from the bottom up; a negative scale says little-endian."""
    pixels = np.arange(12, dtype=np.float32).reshape(2, 2, 3)
    Image(pixels).save(tmp_path / "a.pfm")
    data = (tmp_path / "a.pfm").read_bytes()
    assert data[:12] == b"PF\n2 2\n-1.0\n"
    np.testing.assert_array_equal(np.frombuffer(data[12:], "<f4"), [6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 4, 5])


def test_big_endian_grey_pfm_whose_pixels_look_like_white_space(tmp_path: Path) -> None:
    values = np.frombuffer(b"\x20\x20\x20\x20\x0a\x0a\x0a\x0a", ">f4")
    (tmp_path / "a.pfm").write_bytes(b"Pf 2 1 1.0\n" + values.tobytes())
    loaded = Image.load(tmp_path / "a.pfm").pixels
    np.testing.assert_array_equal(loaded, np.repeat(values.astype(np.float32)[None, :, None], 3, axis=2))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "expected a PFM header (PF, width, height, scale), got b''"),
        (b"P6 2 2 255\n", "expected a PFM header (PF, width, height, scale), got b'P6 2 2 255\\n'"),
        (b"PF 2 x -1\n", "expected a PFM header (PF, width, height, scale), got b'PF 2 x -1\\n'"),
        (b"PF 1 1 nan\n", "expected a PFM header (PF, width, height, scale), got b'PF 1 1 nan\\n'"),
        (b"PF 0 1 -1\n", "expected a width and a height between 1 and 65,536 pixels, got 0x1"),
        (b"PF 1000000 1000000 -1\n", "expected a width and a height between 1 and 65,536 pixels, got 1000000x1000000"),
        (b"PF 1 1 -1\n12345678", "expected 12 bytes of pixels after the header, got 8"),
    ],
)
def test_damaged_pfm(tmp_path: Path, data: bytes, message: str) -> None:
    (tmp_path / "a.pfm").write_bytes(data)
    assert message_of(tmp_path / "a.pfm") == message


def test_damaged_npy(tmp_path: Path) -> None:
    path = tmp_path / "a.npy"
    path.write_bytes(b"not numpy")
    assert message_of(path).startswith("expected a .npy file of numbers")
    np.save(path, np.zeros((2, 3)))
    assert message_of(path) == "expected numbers of the shape (height, width, 3), got float64 of the shape (2, 3)"
    np.save(path, np.array([[["a", "b", "c"]]]))
    assert message_of(path) == "expected numbers of the shape (height, width, 3), got <U1 of the shape (1, 1, 3)"
    np.save(path, np.array([object()]), allow_pickle=True)
    assert message_of(path).startswith("expected a .npy file of numbers")


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    assert message_of(tmp_path / "none.exr") == "file not found"
    (tmp_path / "folder.exr").mkdir()
    assert message_of(tmp_path / "folder.exr") == "expected a file, got a folder"
    assert message_of(tmp_path / "a.png") == (
        "expected a file with radiance (.exr, .hdr, .pfm or .npy), got a format that only contains display values"
    )


def test_png_carries_metadata(tmp_path: Path) -> None:
    metadata = {"scene": "Ümlaut", "settings": {"seed": 7}}
    Image(np.zeros((1, 1, 3), dtype=np.float32), metadata=metadata).save(tmp_path / "a.png")
    assert read_png_metadata(tmp_path / "a.png") == metadata


def test_png_of_others_has_none(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    PIL.Image.new("RGB", (1, 1)).save(path)
    with pytest.raises(EclatError) as caught:
        read_png_metadata(path)
    assert str(caught.value) == f"{path}: expected a PNG file with the text field 'eclat', which Éclat writes"


def test_every_format_is_either_readable_or_says_why_not() -> None:
    assert [suffix for suffix, row in FORMATS.items() if row.decode is None] == [".png"]
