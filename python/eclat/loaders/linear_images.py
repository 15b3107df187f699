# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decode image formats that are linear by definition: OpenEXR, Radiance HDR and PFM. All failures raise EclatError."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.images import radiance_hdr

_ALLOWANCE = 1 << 29
"""The number of bytes that one image may take whatever the size of its file (512 MiB)."""
_GROWTH = 256
"""The number of further bytes that it may take for each byte of its file."""

MAX_PIXELS = 1 << 27
"""The largest number of texels in an image: 16384 × 8192."""

_GAMUT = 1e-3
"""The absolute value of a negative channel, relative to the texel's largest channel, up to which it counts as rounding
(of 16-bit floats or of primaries)."""
_PFM_HEADER = re.compile(rb"(PF|Pf)\s+(\d{1,7})\s+(\d{1,7})\s+([-+0-9.eE]{1,20})\s")


def decode_exr(path: Path, data: bytes) -> NDArray[np.float32]:
    """Decode the pixels (H, W, C) of an OpenEXR file: RGB, RGBA or one channel.

    The channels are those of the unnamed layer or, if it has no colours, of the first layer. Colours have Rec. 709
    primaries, and the image covers the display window (see `read_planes`). If colours were converted from other
    primaries and lie outside the gamut of Rec. 709, their negative channels become 0, with a warning, because
    reflectances and radiances cannot be negative.
    """
    from eclat.images.exr_planes import read_planes

    def check(width: int, height: int) -> None:
        # Even a constant image takes a byte for some thousand texels in the best lossless compression.
        check_size(width, height, len(data), texels_per_byte=1 << 14)
        check_growth(12 * width * height, len(data))

    try:
        found = read_planes(data, path.name, check)
        image = np.stack(_color_channels(found.channels), axis=-1)
    except EclatError:
        raise
    except (RuntimeError, ValueError, TypeError, LookupError, OSError, ArithmeticError, MemoryError) as error:
        raise EclatError(f"the image cannot be decoded: {error}") from None
    with np.errstate(all="ignore"):  # Texels may be infinite or NaN. The caller replaces them.
        outside = (image[..., :3] < -_GAMUT * np.abs(image[..., :3]).max(axis=-1, keepdims=True)).any(axis=-1)
    if found.converted:
        if outside.any():
            warn(
                f"{path.name}: {int(outside.sum())} texels lie outside the gamut of Rec. 709; their negative channels "
                "are set to 0"
            )
        np.maximum(image, 0, out=image)
    return np.asarray(image, dtype=np.float32)


def decode_hdr(path: Path, data: bytes) -> NDArray[np.float32]:
    """Decode the pixels (H, W, 3) of a Radiance picture, which may be run-length encoded or uncompressed."""

    def check(width: int, height: int) -> None:
        # A run of two bytes encodes at most 127 values, and each texel has four values.
        check_size(width, height, len(data), texels_per_byte=64)
        check_growth(12 * width * height, len(data))

    return radiance_hdr.decode_hdr(data, check)


def decode_pfm(path: Path, data: bytes) -> NDArray[np.float32]:
    """Decode the pixels (H, W, 1 or 3) of a portable float map (PFM). The file stores the bottom row first."""
    header = _PFM_HEADER.match(data)
    if header is None:
        raise EclatError("expected a PFM header, got none")
    width, height, channels = int(header[2]), int(header[3]), 3 if header[1] == b"PF" else 1
    try:
        little = float(header[4]) < 0
    except ValueError:
        raise EclatError(f"expected a number as the PFM's scale, got {header[4]!r}") from None
    check_size(width, height, len(data), texels_per_byte=1)
    count = width * height * channels
    if len(data) - header.end() < 4 * count:
        raise EclatError(f"expected {4 * count} bytes of texels, got {len(data) - header.end()}")
    values = np.frombuffer(data, "<f4" if little else ">f4", count, header.end())
    return np.ascontiguousarray(values.reshape(height, width, channels)[::-1], dtype=np.float32)


DECODERS: dict[str, Callable[[Path, bytes], NDArray[np.float32]]] = {
    ".exr": decode_exr,
    ".hdr": decode_hdr,
    ".rgbe": decode_hdr,
    ".pic": decode_hdr,
    ".pfm": decode_pfm,
}
"""The decoder of each file suffix in lower case. It takes the path and the bytes of a file and returns (H, W, C)."""


def check_growth(taken: int, file_size: int) -> None:
    """Raise EclatError if an image would take many more bytes than its file has: a few kilobytes must not fill gigabytes."""
    if taken > _ALLOWANCE + _GROWTH * file_size:
        raise EclatError(
            f"the image would take {taken >> 20} MiB, more than {_ALLOWANCE >> 20} MiB plus {_GROWTH} times the "
            f"{file_size} bytes of its file"
        )


def check_size(width: int, height: int, file_size: int, texels_per_byte: int) -> None:
    """Raise EclatError if an image has no texels, more than `MAX_PIXELS`, or more than its file can contain.

    A file of `file_size` bytes can contain at most `texels_per_byte` texels for each byte.
    """
    if width < 1 or height < 1:
        raise EclatError(f"expected an image with at least one texel, got {width} × {height}")
    if width * height > MAX_PIXELS:
        raise EclatError(f"expected at most {MAX_PIXELS} texels, got {width} × {height}")
    if width * height > texels_per_byte * file_size:
        raise EclatError(
            f"the header of the image claims {width} × {height} texels, which a file of {file_size} bytes cannot contain"
        )


def _color_channels(channels: dict[str, Any]) -> list[Any]:
    prefixes = sorted({name.rpartition(".")[0] for name in channels})
    for prefix in prefixes:
        start = f"{prefix}." if prefix else ""
        if all(f"{start}{c}" in channels for c in "RGB"):
            names = "RGBA" if f"{start}A" in channels else "RGB"
            return [channels[f"{start}{c}"] for c in names]
    for name in ("Y", *sorted(channels)):
        if name in channels:
            return [channels[name]]
    raise EclatError("the image has no channels")
