# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Radiance pictures that Éclat writes, read by Éclat and, byte by byte, as the format is described."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.images.image import Image
from eclat.images.radiance_hdr import _run_lengths, encode_hdr, to_rgbe


def random_pixels(height: int, width: int) -> np.ndarray:
    rng = np.random.default_rng(3)
    return np.exp2(rng.uniform(-40, 40, (height, width, 1))).astype(np.float32) * rng.uniform(0, 1, (height, width, 3))


@pytest.mark.parametrize("width", [1, 7, 8, 9, 300])
def test_each_channel_is_right_to_half_a_step_of_the_largest(width: int, tmp_path: Path) -> None:
    pixels = random_pixels(5, width).astype(np.float32)
    Image(pixels).save(tmp_path / "a.hdr")
    read = eclat.Image.load(tmp_path / "a.hdr").pixels
    largest = pixels.max(axis=-1, keepdims=True)
    assert (np.abs(read - pixels) <= largest / 256 * 1.0001).all()
    assert np.abs(read - pixels).max() > 0


@pytest.mark.parametrize(
    ("color", "rgbe"),
    [
        ((1, 0.5, 0.25), (128, 64, 32, 129)),
        ((0, 0, 0), (0, 0, 0, 0)),
        ((-1, 0.5, 0), (0, 128, 0, 128)),
        ((0.9999, 0, 0), (128, 0, 0, 129)),  # 0.9999 · 256 rounds to 256, which needs the next exponent
        ((1e-39, 0, 0), (0, 0, 0, 0)),  # below the least exponent
        ((np.inf, 1, np.nan), (255, 0, 0, 255)),
        ((3e38, 0, 0), (255, 0, 0, 255)),
    ],
)
def test_bytes_of_colors(color: tuple[float, ...], rgbe: tuple[int, ...]) -> None:
    with np.errstate(all="ignore"):
        assert tuple(to_rgbe(np.array([[color]], np.float32))[0, 0]) == rgbe


def decoded_runs(data: bytes) -> bytes:
    out, i = bytearray(), 0
    while i < len(data):
        count = data[i]
        if count > 128:
            out += data[i + 1 : i + 2] * (count - 128)
            i += 2
        else:
            assert count > 0
            out += data[i + 1 : i + 1 + count]
            i += 1 + count
    return bytes(out)


@pytest.mark.parametrize("levels", [1, 2, 200])
def test_runs_give_the_row_back_and_shorten_constant_ones(levels: int) -> None:
    row = np.repeat(np.random.default_rng(1).integers(0, levels, 900), 3)[:1000].astype(np.uint8)
    packed = _run_lengths(row)
    assert decoded_runs(packed) == row.tobytes()
    assert len(packed) < 20 if levels == 1 else len(packed) <= 1000 + 8


def test_the_header_is_that_of_the_format() -> None:
    data = encode_hdr(np.ones((2, 9, 3), np.float32))
    assert data.startswith(b"#?RADIANCE\n")
    assert b"\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 9\n" in data
    assert data.split(b"+X 9\n")[1][:4] == b"\x02\x02\x00\x09"


def test_environments_are_read_from_what_was_written(tmp_path: Path) -> None:
    from eclat.loaders.images import read_image_file

    pixels = random_pixels(8, 16).astype(np.float32)
    Image(pixels).save(tmp_path / "sky.hdr")
    read, linear = read_image_file(Path("sky.hdr"), (tmp_path / "sky.hdr").read_bytes())
    assert linear
    assert np.array_equal(read, eclat.Image.load(tmp_path / "sky.hdr").pixels)


def test_damaged_files_are_named(tmp_path: Path) -> None:
    path = tmp_path / "a.hdr"
    path.write_bytes(encode_hdr(np.ones((4, 9, 3), np.float32))[:-3])
    with pytest.raises(EclatError, match=f"^{path}: the run-length encoding of the image is truncated or invalid"):
        eclat.Image.load(path)
    path.write_bytes(b"#?RADIANCE\n\n-Y 99999 +X 99999\n")
    with pytest.raises(EclatError, match=f"^{path}: .*99999"):
        eclat.Image.load(path)


def test_pixels_that_are_not_finite_are_a_warning(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="NaN is written as 0, and infinity as the largest value of the format"):
        Image(np.full((1, 1, 3), np.nan, np.float32)).save(tmp_path / "a.hdr")
