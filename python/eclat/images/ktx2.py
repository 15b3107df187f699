# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Write KTX2 files [KTX2]: images in half precision as graphics cards take them, without compression.

A file is a header, an index of the levels of its mip map, a data format descriptor that says what each texel holds, pairs of
keys and values, and the levels from the smallest to the largest, each with its rows from top to bottom. All numbers are
little-endian.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

_IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
_R16G16B16A16_SFLOAT = 97
"""Number of the format among those of Vulkan."""

_TEXEL_BYTES = 8
LARGEST_HALF = 65504.0
"""Largest finite number of half precision."""

_HEADER = struct.Struct("<9I4I2Q")
"""The fields of the header and of the index without its levels."""

_LEVEL = struct.Struct("<3Q")
"""The entry of a level in the index: where it begins, and its size in bytes with and without compression."""


def ktx2_scale(values: NDArray[np.float32]) -> float:
    """Return the power of two by which `values` must be divided so that half precision holds them: 1 if it does, as it is."""
    largest = float(values.max(initial=0))
    return 1.0 if largest <= LARGEST_HALF else 2.0 ** math.ceil(math.log2(largest / LARGEST_HALF))


def encode_ktx2(levels: Sequence[NDArray[np.float32]]) -> bytes:
    """Encode an image of linear values as a KTX2 file with four channels of half precision, of which alpha is 1.

    Values above `LARGEST_HALF` become that value.

    Parameters
    ----------
    levels : the image (H, W, 3), and the smaller levels of its mip map, if there are any: level n has the shape
        (max(1, H // 2ⁿ), max(1, W // 2ⁿ), 3). Graphics cards do not require that they go on to a single texel.

    Raises
    ------
    ValueError : a level has another shape.
    """
    height, width = levels[0].shape[:2]
    data = []
    for number, pixels in enumerate(levels):
        expected = (max(1, height >> number), max(1, width >> number), 3)
        if pixels.shape != expected:
            raise ValueError(f"level {number}: expected the shape {expected}, got {pixels.shape}")
        texels = np.ones((*expected[:2], 4), "<f2")
        texels[..., :3] = np.minimum(pixels, LARGEST_HALF)
        data.append(texels.tobytes())
    descriptor, notes = _descriptor(), _key_values({"KTXorientation": b"rd\0", "KTXwriter": b"eclat\0"})
    first = len(_IDENTIFIER) + _HEADER.size + _LEVEL.size * len(data)
    data_at = -(-(first + len(descriptor) + len(notes)) // _TEXEL_BYTES) * _TEXEL_BYTES
    header = _HEADER.pack(
        *(_R16G16B16A16_SFLOAT, 2, width, height, 0, 0, 1, len(data), 0),  # type size 2; no depth, no layers; 1 face
        *(first, len(descriptor), first + len(descriptor), len(notes)),
        *(0, 0),  # There are no data that are common to all levels.
    )
    for number, level in enumerate(data):
        header += _LEVEL.pack(data_at + sum(map(len, data[number + 1 :])), len(level), len(level))
    body = _IDENTIFIER + header + descriptor + notes
    return body + b"\0" * (data_at - len(body)) + b"".join(reversed(data))


def _descriptor() -> bytes:
    """Return the data format descriptor: a basic block with one sample for each of four channels."""
    version, size = 2, 24 + 16 * 4
    model_rgb, primaries_bt709, transfer_linear = 1, 1, 1
    block = struct.pack(
        "<IHH8B8B", 0, version, size, model_rgb, primaries_bt709, transfer_linear, 0, 0, 0, 0, 0, _TEXEL_BYTES, *[0] * 7
    )
    signed_float = 0x80 | 0x40
    for channel, number in enumerate((0, 1, 2, 15)):  # red, green, blue, alpha
        minus_one, one = struct.unpack("<2I", struct.pack("<2f", -1, 1))
        block += struct.pack("<HBB4B2I", 16 * channel, 15, number | signed_float, 0, 0, 0, 0, minus_one, one)
    return struct.pack("<I", 4 + len(block)) + block


def _key_values(pairs: dict[str, bytes]) -> bytes:
    """Encode pairs, sorted by their keys, each padded to four bytes."""
    out = b""
    for key in sorted(pairs):
        entry = key.encode() + b"\0" + pairs[key]
        out += struct.pack("<I", len(entry)) + entry + b"\0" * (-len(entry) % 4)
    return out
