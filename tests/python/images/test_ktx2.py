# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""KTX2 files, as ktx-parse, the reader of three.js, reads them."""

from __future__ import annotations

import base64
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from eclat.images.ktx2 import LARGEST_HALF, encode_ktx2, ktx2_scale
from support.browser import WEB, require_node

READER = """
import { readFileSync } from 'node:fs';
import { read } from %r;
const found = read(readFileSync(process.argv[1]));
const of = (key) => found.levels.map((level) => key(level));
console.log(JSON.stringify({
  format: found.vkFormat, typeSize: found.typeSize, width: found.pixelWidth, height: found.pixelHeight,
  layers: found.layerCount, faces: found.faceCount, scheme: found.supercompressionScheme, levels: found.levels.length,
  orientation: found.keyValue.KTXorientation, dfd: found.dataFormatDescriptor[0],
  data: of((level) => Buffer.from(level.levelData).toString('base64')), uncompressed: of((l) => l.uncompressedByteLength),
}));
"""


def read(path: Path) -> dict:
    parser = (WEB / "node_modules/three/examples/jsm/libs/ktx-parse.module.js").as_uri()
    run = subprocess.run(
        [require_node(), "--input-type=module", "-e", READER % parser, str(path)], capture_output=True, timeout=60
    )
    assert run.returncode == 0, run.stderr.decode()
    return json.loads(run.stdout)  # type: ignore[no-any-return]


@pytest.mark.parametrize("size", [(3, 5), (1, 1), (16, 8)])
def test_an_image_comes_back_bit_for_bit(tmp_path: Path, size: tuple[int, int]) -> None:
    rng = np.random.default_rng(4)
    pixels = rng.lognormal(0, 3, (*size, 3)).astype(np.float32)
    pixels[0, 0] = (0, 1e-7, 1e6)  # nothing, less than the smallest normal number, and more than the largest
    (tmp_path / "a.ktx2").write_bytes(encode_ktx2([pixels]))
    found = read(tmp_path / "a.ktx2")
    assert (found["width"], found["height"]) == (size[1], size[0])
    assert (found["format"], found["typeSize"], found["scheme"]) == (97, 2, 0)
    assert (found["layers"], found["faces"], found["levels"]) == (0, 1, 1)
    assert found["orientation"].rstrip("\0") == "rd"
    texels = np.frombuffer(base64.b64decode(found["data"][0]), "<f2").reshape(*size, 4)
    assert found["uncompressed"] == [texels.nbytes]
    np.testing.assert_array_equal(texels[..., :3], np.minimum(pixels, LARGEST_HALF).astype(np.float16))
    np.testing.assert_array_equal(texels[..., 3], 1)


@pytest.mark.parametrize("size", [(5, 9), (1, 6), (16, 8)])
def test_smaller_levels_come_back_in_their_order(tmp_path: Path, size: tuple[int, int]) -> None:
    rng = np.random.default_rng(5)
    levels = [rng.random((max(1, size[0] >> n), max(1, size[1] >> n), 3)).astype(np.float32) for n in range(3)]
    (tmp_path / "a.ktx2").write_bytes(encode_ktx2(levels))
    found = read(tmp_path / "a.ktx2")
    assert (found["width"], found["height"], found["levels"]) == (size[1], size[0], 3)
    for level, data in zip(levels, found["data"], strict=True):
        texels = np.frombuffer(base64.b64decode(data), "<f2").reshape(*level.shape[:2], 4)
        np.testing.assert_array_equal(texels[..., :3], level.astype(np.float16))
    # The specification wants the smallest level first and each at a multiple of the size of a texel.
    places = np.frombuffer((tmp_path / "a.ktx2").read_bytes()[80 : 80 + 3 * 24], "<u8").reshape(3, 3)[:, 0]
    assert (np.diff(places.astype(np.int64)) < 0).all() and (places % 8 == 0).all()


def test_a_level_of_another_size_is_refused() -> None:
    with pytest.raises(ValueError, match="level 1: expected the shape"):
        encode_ktx2([np.ones((4, 4, 3), np.float32), np.ones((4, 2, 3), np.float32)])


def test_the_descriptor_says_what_texels_hold(tmp_path: Path) -> None:
    (tmp_path / "a.ktx2").write_bytes(encode_ktx2([np.ones((2, 2, 3), np.float32)]))
    described = read(tmp_path / "a.ktx2")["dfd"]
    assert described["colorModel"] == described["colorPrimaries"] == described["transferFunction"] == 1
    assert described["bytesPlane"][0] == 8
    samples = described["samples"]
    assert [s["bitOffset"] for s in samples] == [0, 16, 32, 48]
    assert [s["bitLength"] for s in samples] == [15, 15, 15, 15]  # the format counts bits less one
    assert [s["channelType"] for s in samples] == [0xC0, 0xC1, 0xC2, 0xCF]


def test_a_power_of_two_brings_bright_values_into_range() -> None:
    for largest in (0.0, 1.0, LARGEST_HALF, LARGEST_HALF * 1.01, 1e9):
        scale = ktx2_scale(np.full((1, 1, 3), largest, np.float32))
        assert np.log2(scale) % 1 == 0 and largest / scale <= LARGEST_HALF
        assert scale == 1 or largest / scale > LARGEST_HALF / 2
