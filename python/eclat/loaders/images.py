# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decode images to arrays. Every failure of a decoder becomes an EclatError."""

from __future__ import annotations

import io
import struct
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError
from PIL.PngImagePlugin import PngImageFile

from eclat.errors import EclatError
from eclat.loaders import ktx2
from eclat.loaders.linear_images import DECODERS, MAX_PIXELS, check_size

# Pillow would otherwise also try formats for which it starts other programs, such as EPS.
FORMATS = ("PNG", "JPEG", "BMP", "TGA", "TIFF", "GIF", "WEBP", "AVIF", "PPM", "DDS", "PCX")

_ALLOWANCE = 1 << 29
"""The number of bytes that the decoded images of a scene may take in any case (512 MiB). Decoders need as much again."""
_GROWTH = 256
"""The number of further bytes that the decoded images may take for each byte of their files. A decoded photograph is 10
to 50 times as large as its JPEG file."""

_STRIP = 1 << 20
"""The number of texels that are converted at a time."""

_spent: ContextVar[list[int] | None] = ContextVar("spent", default=None)
"""The bytes that the images of the current load take, and `_GROWTH` times the bytes of their files."""

_DEFLATE_LIMIT = 1032
"""The largest ratio of decompressed to compressed bytes that deflate can reach: 258 bytes for 2 bits. A PNG whose
header claims more is invalid."""

# Pillow's plugins raise nearly every type of exception on broken files.
_DECODER_ERRORS = (
    *(OSError, ValueError, TypeError, ArithmeticError, LookupError, EOFError, SyntaxError, AttributeError),
    *(RuntimeError, MemoryError, struct.error, zlib.error, Image.DecompressionBombError),
)


def decode_image(data: bytes) -> NDArray[Any]:
    """Decode an encoded image.

    Returns
    -------
    (H, W, C) with C = 1, 3 or 4. The type is uint8, or float32 in 0..1 for images of 16 bits per channel.

    Raises
    ------
    EclatError : the image cannot be decoded, is too large, or has texels that are not finite.
    """
    if data.startswith(ktx2.MAGIC):
        return ktx2.decode_ktx2(data, lambda taken: _spend(taken, len(data)))
    try:
        # The filter stays in place, because `catch_warnings` would also undo the filters that other threads set
        # meanwhile. The warning is not needed: `_check_size` has a limit too.
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)
        with Image.open(io.BytesIO(data), formats=FORMATS) as image:
            _check_size(image, len(data))
            pixels = _pixels(image, data)
    except EclatError:
        raise
    except UnidentifiedImageError:
        raise EclatError(f"the image cannot be decoded: expected one of {', '.join(FORMATS)}, KTX2") from None
    except _DECODER_ERRORS as error:
        raise EclatError(f"the image cannot be decoded: {error or type(error).__name__}") from None
    if pixels.dtype != np.uint8 and not np.isfinite(pixels).all():
        raise EclatError("the image has texels that are not finite")
    return pixels


@contextmanager
def image_budget() -> Iterator[None]:
    """Limit the memory of the images that are decoded in the body of this context.

    All images together may take `_ALLOWANCE` bytes plus `_GROWTH` bytes for each byte of their files. An image that
    would exceed this sum raises EclatError.
    """
    token = _spent.set([0, 0])
    try:
        yield
    finally:
        _spent.reset(token)


def _spend(taken: int, size: int) -> None:
    spent = _spent.get()
    if spent is None:
        return
    if spent[0] + taken > _ALLOWANCE + spent[1] + _GROWTH * size:
        raise EclatError(
            f"the image would take {taken >> 20} MiB, and all images of the scene together would take more than "
            f"{_ALLOWANCE >> 20} MiB plus {_GROWTH} times the size of their files"
        )
    spent[0] += taken
    spent[1] += _GROWTH * size


def read_image_file(path: Path, data: bytes) -> tuple[NDArray[Any], bool]:
    """Decode `data`, the bytes of the image file `path`.

    Returns
    -------
    The image, (H, W, C), and whether its format is linear by definition. Texels of linear formats may be infinite or
    NaN.

    Raises
    ------
    EclatError : the image cannot be decoded or is too large.
    """
    decode = DECODERS.get(path.suffix.lower())
    return (decode_image(data), False) if decode is None else (decode(path, data), True)


def _check_size(image: Image.Image, size: int) -> None:
    # A texel of a PNG takes at least one bit before compression. For other formats no such bound is known.
    check_size(*image.size, size, texels_per_byte=8 * _DEFLATE_LIMIT if image.format == "PNG" else MAX_PIXELS)
    _spend(image.width * image.height * _bytes_of_texel(image), size)


def _raw_mode(image: Image.Image) -> str | None:
    """Return how a PNG file stores its texels, which the mode of the image does not tell for 16-bit colours."""
    return str(image.tile[0][3]) if isinstance(image, PngImageFile) and image.tile else None


def _bytes_of_texel(image: Image.Image) -> int:
    """Return the number of bytes that a texel takes in what `_pixels` returns."""
    channels = {"RGB;16B": 3, "RGBA;16B": 4}.get(_raw_mode(image) or "")
    if channels is not None:
        return 4 * channels
    return 1 if image.mode in ("1", "L") else 4


def _pixels(image: Image.Image, data: bytes) -> NDArray[Any]:
    mode = image.mode
    raw = _raw_mode(image)
    if raw in ("RGB;16B", "RGBA;16B"):
        # Pillow keeps only the high bytes of 16-bit colours. If it reads them as little-endian, it keeps the low bytes.
        high = np.asarray(image, dtype=np.float32)
        with PngImageFile(io.BytesIO(data)) as again:
            codec, extents, offset, _ = again.tile[0]
            # This is a plain tuple, because Pillow has a named tuple for it only since version 11.
            again.tile = [(codec, extents, offset, raw.replace("16B", "16L"))]  # type: ignore[list-item]
            low = np.asarray(again, dtype=np.float32)
        return (high * np.float32(256) + low) / np.float32(65535)
    if mode.startswith("I"):
        grey = np.asarray(image, dtype=np.float32)[..., None] / np.float32(65535)
        if grey.min() < 0 or grey.max() > 1:
            raise EclatError("the image has integers of more than 16 bits, which are not supported")
        return grey
    if mode == "F":
        return np.array(image, dtype=np.float32)[..., None]
    if mode in ("1", "L"):
        return np.array(image.convert("L"))[..., None]
    alpha = mode in ("RGBA", "LA", "PA", "La", "RGBa") or "transparency" in image.info
    return _converted(image, "RGBA" if alpha else "RGB")


def _converted(image: Image.Image, mode: Literal["RGB", "RGBA"]) -> NDArray[np.uint8]:
    """Convert an image to 8-bit colours (H, W, 3 or 4), a strip at a time.

    Pillow's converted image and the bytes that NumPy asks it for would otherwise take several times the memory of the
    result.
    """
    pixels = np.empty((image.height, image.width, len(mode)), np.uint8)
    rows = max(1, _STRIP // image.width)
    image.load()
    for top in range(0, image.height, rows):
        strip = image.crop((0, top, image.width, min(top + rows, image.height)))
        pixels[top : top + rows] = np.asarray(strip.convert(mode))
    return pixels
