# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Encode and decode image files. `FORMATS` lists the formats."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage
from PIL import PngImagePlugin

from eclat.errors import EclatError, did_you_mean
from eclat.files.arrays import array_from, read_file
from eclat.images.exr import decode_exr, encode_exr
from eclat.images.radiance_hdr import decode_hdr, encode_hdr
from eclat.images.tone import to_display

CheckSize = Callable[[int, int, str], None]


@dataclass(frozen=True, eq=False)
class Content:
    """The content of an image file: the pixels (H, W, 3), layers by name, and metadata."""

    pixels: NDArray[np.float32]
    layers: dict[str, NDArray[np.float32]] = field(default_factory=dict)
    metadata: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Format:
    """A file format: the functions that encode and decode it.

    `decode` is None if the format does not contain radiance. `not_finite` says how pixels that are not finite are
    written, as the end of a warning.
    """

    encode: Callable[[Content, Mapping[str, str], float, str], bytes]
    decode: Callable[[bytes, str, CheckSize], Content] | None
    not_finite: str = "they are written as they are"


def format_of(path: str | os.PathLike[str]) -> Format:
    """Return the format of the file `path`, by its suffix. Raises EclatError if the suffix is not in `FORMATS`."""
    suffix = Path(path).suffix
    if suffix.lower() not in FORMATS:
        got = f"{suffix!r}{did_you_mean(suffix.lower(), FORMATS)}" if suffix else "a name without a suffix"
        raise EclatError(
            f"{os.fspath(path)}: expected an image file with one of the suffixes {', '.join(FORMATS)}, got {got}"
        )
    return FORMATS[suffix.lower()]


def read(path: str | os.PathLike[str], check_size: CheckSize) -> Content:
    """Read the content of an image file with radiance.

    `check_size` raises EclatError if a width and a height are too large. It is called before memory is allocated.

    Raises
    ------
    EclatError : the file does not exist, is invalid or too large, or its format contains no radiance.
    """
    name = os.fspath(path)
    decode = format_of(path).decode
    if decode is None:
        raise EclatError(
            f"{name}: expected a file with radiance (.exr, .hdr, .pfm or .npy), got a format that only contains display values"
        )
    data = read_file(path, where=name)
    return decode(data, name, check_size)


def metadata_text(metadata: Mapping[str, Any]) -> str:
    """Encode metadata as JSON. Raises EclatError if JSON cannot represent them."""
    try:
        return json.dumps(dict(metadata), ensure_ascii=False)
    except (TypeError, ValueError) as error:
        raise EclatError(f"image metadata: expected values that JSON can represent, got an error: {error}") from None


def encode_png(content: Content, layers: Mapping[str, str], exposure: float, tone_mapping: str) -> bytes:
    """Encode an image as 8-bit PNG in sRGB, with the metadata as international text with the keyword `eclat`.

    `exposure` is in stops, and `tone_mapping` is a key of `TONE_MAPPINGS`. Layers are not written.
    """
    information = PngImagePlugin.PngInfo()
    # This chunk states that the values are sRGB. Its rendering intent is 0, "perceptual", which is meant for images.
    information.add(b"sRGB", b"\x00")
    if content.metadata:
        information.add_itxt("eclat", metadata_text(content.metadata), zip=True)
    file = io.BytesIO()
    picture = PillowImage.fromarray(to_display(content.pixels, exposure, tone_mapping))
    picture.save(file, format="PNG", pnginfo=information)
    return file.getvalue()


def read_png_metadata(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Read the metadata that `encode_png` has written. Raises EclatError if the file contains none."""
    try:
        with PillowImage.open(io.BytesIO(read_file(path, where=os.fspath(path))), formats=("PNG",)) as picture:
            metadata = json.loads(str(picture.info["eclat"]))
            if isinstance(metadata, dict):
                return metadata
    except EclatError:
        raise
    except Exception:  # Pillow raises exceptions of many types if a file is invalid.
        pass
    raise EclatError(f"{os.fspath(path)}: expected a PNG file with the text field 'eclat', which Éclat writes")


def _encode_exr(content: Content, layers: Mapping[str, str], exposure: float, tone_mapping: str) -> bytes:
    metadata_text(content.metadata)
    return encode_exr(content.pixels, content.layers, content.metadata, layers)


def _decode_exr(data: bytes, name: str, check_size: CheckSize) -> Content:
    return Content(*decode_exr(data, name, check_size))


def _encode_hdr(content: Content, layers: Mapping[str, str], exposure: float, tone_mapping: str) -> bytes:
    return encode_hdr(content.pixels)


def _decode_hdr(data: bytes, name: str, check_size: CheckSize) -> Content:
    try:
        return Content(decode_hdr(data, lambda width, height: check_size(width, height, name)))
    except EclatError as error:
        raise EclatError(f"{name}: {str(error).removeprefix(name + ': ')}") from None


def _encode_pfm(content: Content, layers: Mapping[str, str], exposure: float, tone_mapping: str) -> bytes:
    """Encode a portable float map. Its rows are from bottom to top, and a negative scale means little-endian."""
    height, width, _ = content.pixels.shape
    return f"PF\n{width} {height}\n-1.0\n".encode() + content.pixels[::-1].astype("<f4").tobytes()


def _decode_pfm(data: bytes, name: str, check_size: CheckSize) -> Content:
    header, fields = data.split(maxsplit=4)[:4], 4
    try:
        kind, width, height, scale = header[0], int(header[1]), int(header[2]), float(header[3])
    except (IndexError, ValueError):
        kind, width, height, scale = b"", 0, 0, 0.0
    if kind not in (b"PF", b"Pf") or not np.isfinite(scale) or scale == 0:
        raise EclatError(f"{name}: expected a PFM header (PF, width, height, scale), got {data[:20]!r}")
    check_size(width, height, name)
    channels = 3 if kind == b"PF" else 1
    # A single white-space character ends the header. The first bytes of the pixels may look like white space too.
    start = 0
    for token in header[:fields]:
        start = data.index(token, start) + len(token)
    body, size = data[start + 1 :], width * height * channels * 4
    if len(body) != size:
        raise EclatError(f"{name}: expected {size:,} bytes of pixels after the header, got {len(body):,}")
    values = np.frombuffer(body, dtype="<f4" if scale < 0 else ">f4").reshape(height, width, channels)[::-1]
    return Content(np.broadcast_to(values.astype(np.float32), (height, width, 3)))


def _encode_npy(content: Content, layers: Mapping[str, str], exposure: float, tone_mapping: str) -> bytes:
    file = io.BytesIO()
    np.save(file, content.pixels, allow_pickle=False)
    return file.getvalue()


def _decode_npy(data: bytes, name: str, check_size: CheckSize) -> Content:
    pixels = array_from(data, name)
    if pixels.dtype.kind not in "fiu" or pixels.ndim != 3 or pixels.shape[2] != 3:
        raise EclatError(
            f"{name}: expected numbers of the shape (height, width, 3), got {pixels.dtype} of the shape {pixels.shape}"
        )
    check_size(pixels.shape[1], pixels.shape[0], name)
    return Content(pixels.astype(np.float32))


FORMATS: dict[str, Format] = {
    ".exr": Format(_encode_exr, _decode_exr),
    ".png": Format(encode_png, None, "they are shown in magenta"),
    ".hdr": Format(_encode_hdr, _decode_hdr, "NaN is written as 0, and infinity as the largest value of the format"),
    ".pfm": Format(_encode_pfm, _decode_pfm),
    ".npy": Format(_encode_npy, _decode_npy),
}
"""The formats of image files by suffix, in lower case."""
