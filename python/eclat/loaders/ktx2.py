# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decode KTX2 images that are compressed by Basis Universal, as KHR_texture_basisu allows: ETC1S and UASTC.

The transcoder is that of the package `opengl-basisu` (the extra `files`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.loaders.linear_images import check_growth, check_size
from eclat.loaders.optional import optional_module

MAGIC = b"\xabKTX 20\xbb\r\n\x1a\n"
"""The first bytes of every KTX2 file."""

_TEXELS_PER_BYTE = 1 << 15
"""The largest number of texels for each byte of a file. A texel of UASTC takes a byte before zstd compresses it, and a block
of zstd, of which 4 bytes may stand for one repeated byte, has at most 2¹⁷ bytes. One colour in 4096 × 4096 texels was
measured to give 10,400 texels for each byte, by ETC1S as well."""


def decode_ktx2(data: bytes, spend: Callable[[int], None]) -> NDArray[np.uint8]:
    """Decode the largest level of a KTX2 image.

    Parameters
    ----------
    data : the bytes of the file.
    spend : is called with the number of bytes that the image takes, before it is decoded.

    Returns
    -------
    (H, W, C) with C = 3, or 4 if the image has alpha. The top row of a file that obeys KHR_texture_basisu is first.

    Raises
    ------
    EclatError : the image is invalid, too large or compressed in another way, it is a cube map or an array, or the
        package that decodes it is not installed.
    """
    package = optional_module("opengl_basisu", "files", "KTX2 images")
    try:
        texture = package.open(data)
        if texture.faces != 1 or texture.layers != 1:
            raise EclatError(
                f"expected one image in the KTX2 file, got {texture.faces} faces and {texture.layers} layers"
            )
        width, height, channels = texture.width, texture.height, 4 if texture.has_alpha else 3
        check_size(width, height, len(data), texels_per_byte=_TEXELS_PER_BYTE)
        check_growth(4 * width * height, len(data))
        spend(channels * width * height)
        texels: NDArray[np.uint8] = texture.transcode("rgba8").data
    except (package.BasisuError, ValueError, RuntimeError, LookupError, MemoryError) as error:
        raise EclatError(f"the KTX2 image cannot be decoded: {error}") from None
    return np.ascontiguousarray(texels[..., :channels])
