# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Write KTX2 files [KTX2]: images in half precision as graphics cards take them, without compression and without smaller levels.

A file is a header, an index, a data format descriptor that says what each texel holds, pairs of keys and values, and the rows of
the image from top to bottom. All numbers are little-endian.
"""

from __future__ import annotations

import math
import struct

import numpy as np
from numpy.typing import NDArray

_IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
_R16G16B16A16_SFLOAT = 97
"""Number of the format among those of Vulkan."""

_TEXEL_BYTES = 8
LARGEST_HALF = 65504.0
"""Largest finite number of half precision."""

_HEADER = struct.Struct("<9I4I2Q3Q")
"""The fields of the header, the index, and the one level."""


def ktx2_scale(values: NDArray[np.float32]) -> float:
    """Return the power of two by which `values` must be divided so that half precision holds them: 1 if it does, as it is."""
    largest = float(values.max(initial=0))
    return 1.0 if largest <= LARGEST_HALF else 2.0 ** math.ceil(math.log2(largest / LARGEST_HALF))


def encode_ktx2(pixels: NDArray[np.float32]) -> bytes:
    """Encode an image (H, W, 3) of linear values as a KTX2 file with four channels of half precision, of which alpha is 1.

    Values above `LARGEST_HALF` become that value.
    """
    height, width = pixels.shape[:2]
    texels = np.ones((height, width, 4), "<f2")
    texels[..., :3] = np.minimum(pixels, LARGEST_HALF)
    descriptor, notes = _descriptor(), _key_values({"KTXorientation": b"rd\0", "KTXwriter": b"eclat\0"})
    first = len(_IDENTIFIER) + _HEADER.size
    data_at = -(-(first + len(descriptor) + len(notes)) // _TEXEL_BYTES) * _TEXEL_BYTES
    data = texels.tobytes()
    header = _HEADER.pack(
        *(_R16G16B16A16_SFLOAT, 2, width, height, 0, 0, 1, 1, 0),  # type size 2; no depth, no layers; 1 face, 1 level
        *(first, len(descriptor), first + len(descriptor), len(notes)),
        *(0, 0),  # There are no data that are common to all levels.
        *(data_at, len(data), len(data)),
    )
    body = _IDENTIFIER + header + descriptor + notes
    return body + b"\0" * (data_at - len(body)) + data


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
