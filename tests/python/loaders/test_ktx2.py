# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""KTX2 images of Basis Universal against the PNG files that they were made from."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat.loaders.files import read_texture
from eclat.loaders.images import decode_image, image_budget
from support.compressed_files import COMPRESSED, picture

# Root mean squares of the errors of 8-bit texels; the encoder's own statistics of these files are 4.13, 1.00 and 1.70.
# ETC1S has 5 bits of colour and one of four intensities a texel; UASTC is nearly that of BC7.
ERRORS = {"etc1s.ktx2": 4.2, "uastc.ktx2": 1.1, "uastc_alpha.ktx2": 1.8}


@pytest.mark.parametrize("name", ERRORS)
def test_texels_are_those_of_the_source_within_the_error_of_the_codec(name: str) -> None:
    expected = picture(alpha="alpha" in name).astype(np.float64)
    got = decode_image((COMPRESSED / name).read_bytes())
    assert got.dtype == np.uint8 and got.shape == expected.shape
    assert float(np.mean((got - expected) ** 2)) ** 0.5 < ERRORS[name]
    # The image is neither flipped nor are its channels exchanged: these errors would be ten times as large.
    assert np.abs(got.mean(axis=(0, 1)) - expected.mean(axis=(0, 1))).max() < 1.5


def test_ktx2_files_are_textures_of_every_format(tmp_path: Path) -> None:
    path = tmp_path / "a.ktx2"
    path.write_bytes((COMPRESSED / "uastc.ktx2").read_bytes())
    assert read_texture(path, srgb=True, where="test").image.shape == (32, 48, 3)


def patched(name: str, offset: int, *words: int) -> bytes:
    data = bytearray((COMPRESSED / name).read_bytes())
    struct.pack_into(f"<{len(words)}I", data, offset, *words)
    return bytes(data)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (patched("uastc.ktx2", 12, 37), "vkFormat 37 holds no Basis Universal"),
        (patched("uastc.ktx2", 36, 6), "cannot be decoded|expected one image in the KTX2 file, got 6 faces"),
        (
            patched("uastc.ktx2", 32, 3),
            "expected one image in the KTX2 file, got 1 faces and 3 layers|cannot be decoded",
        ),
        ((COMPRESSED / "uastc.ktx2").read_bytes()[:60], "the KTX2 image cannot be decoded: truncated"),
        ((COMPRESSED / "uastc.ktx2").read_bytes()[:400], "the KTX2 image cannot be decoded"),
        ((COMPRESSED / "etc1s.ktx2").read_bytes()[:400], "the KTX2 image cannot be decoded"),
    ],
)
def test_damage_is_named(data: bytes, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        decode_image(data)


def test_a_header_that_claims_more_than_the_file_can_hold_is_refused() -> None:
    with image_budget(), pytest.raises(EclatError, match=r"cannot contain|cannot be decoded|at most \d+ texels"):
        decode_image(patched("uastc.ktx2", 20, 16384, 16384))
