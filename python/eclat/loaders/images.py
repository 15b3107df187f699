# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decodes images to arrays and turns every failure of a decoder into an EclatError."""

from __future__ import annotations

import io
import struct
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError
from PIL.PngImagePlugin import PngImageFile

from eclat.errors import EclatError
from eclat.loaders.linear_images import DECODERS, MAX_PIXELS, check_size

# The formats are named, because Pillow would otherwise also try formats that start other programs (EPS).
FORMATS = ("PNG", "JPEG", "BMP", "TGA", "TIFF", "GIF", "WEBP", "AVIF", "PPM", "DDS", "PCX")

_ALLOWANCE = 1 << 30
"""Bytes that the images of one scene may take whatever the size of their files."""
_GROWTH = 256
"""Beyond these, how much larger than its file an image may be on average: JPEGs of photographs grow 10 to 50 times."""

_spent: ContextVar[list[int] | None] = ContextVar("spent", default=None)
"""Bytes of images and `_GROWTH` times bytes of files in this load."""

_DEFLATE_LIMIT = 1032
"""No deflate stream grows by more than this (258 bytes for 2 bits), so a PNG that claims more is lying."""

# Pillow's plugins raise nearly every type of exception on broken files.
_DECODER_ERRORS = (
    *(OSError, ValueError, TypeError, ArithmeticError, LookupError, EOFError, SyntaxError, AttributeError),
    *(RuntimeError, MemoryError, struct.error, zlib.error, Image.DecompressionBombError),
)


def decode_image(data: bytes) -> NDArray[Any]:
    """(H, W, C) with C = 1, 3 or 4: uint8, or float32 in 0..1 for images of 16 bits. Raises EclatError."""
    try:
        # For good, since `catch_warnings` would undo what other threads do meanwhile; our own limit is the same.
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)
        with Image.open(io.BytesIO(data), formats=FORMATS) as image:
            _check_size(image, len(data))
            pixels = _pixels(image, data)
    except EclatError:
        raise
    except UnidentifiedImageError:
        raise EclatError(f"the image cannot be decoded: expected one of {', '.join(FORMATS)}") from None
    except _DECODER_ERRORS as error:
        raise EclatError(f"the image cannot be decoded: {error or type(error).__name__}") from None
    if not np.isfinite(pixels).all():
        raise EclatError("the image has texels that are not finite")
    return pixels


@contextmanager
def image_budget() -> Iterator[None]:
    """Images decoded in the block may together take `_ALLOWANCE` and `_GROWTH` times their files; others are refused."""
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
            f"the image would take {taken >> 20} MB, which with others is too much for files of their size"
        )
    spent[0] += taken
    spent[1] += _GROWTH * size


def read_image_file(path: Path, data: bytes) -> tuple[NDArray[Any], bool]:
    """The image `data` of the file `path`, and whether its format is linear by definition. Raises EclatError.

    Texels of linear formats may be infinite or NaN.
    """
    decode = DECODERS.get(path.suffix.lower())
    return (decode_image(data), False) if decode is None else (decode(path, data), True)


def _check_size(image: Image.Image, size: int) -> None:
    # A texel of a PNG takes a bit at least; other formats have no such bound.
    check_size(*image.size, size, texels_per_byte=8 * _DEFLATE_LIMIT if image.format == "PNG" else MAX_PIXELS)
    _spend(image.width * image.height * (1 if image.mode in ("1", "L") else 4), size)


def _pixels(image: Image.Image, data: bytes) -> NDArray[Any]:
    mode = image.mode
    raw = image.tile[0][3] if isinstance(image, PngImageFile) and image.tile else None
    if raw in ("RGB;16B", "RGBA;16B"):
        # Pillow keeps the high bytes of 16-bit colours only; read as little-endian it keeps the low ones.
        high = np.asarray(image, dtype=np.float32)
        with PngImageFile(io.BytesIO(data)) as again:
            codec, extents, offset, _ = again.tile[0]
            # A plain tuple, since the named one is new in Pillow 11.
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
    return np.array(image.convert("RGBA" if alpha else "RGB"))
