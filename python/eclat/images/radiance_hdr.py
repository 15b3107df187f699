# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Encode and decode Radiance pictures (.hdr), whose texels have three mantissas of 8 bits and a common exponent.

The format is that of Ward 1991, *Real Pixels* (Graphics Gems II), with the run-length encoding of Radiance's own
programs.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError

_HEADER_LIMIT = 1 << 16
"""The number of bytes in which the header of a Radiance picture must end. Real headers have some hundred bytes."""
_HDR_SIZE = re.compile(rb"([-+])Y +(\d{1,7}) +\+X +(\d{1,7})\s*$")

_BIAS = 128
"""The stored exponent of values in 0.5..1."""
_LONGEST_RUN, _LONGEST_COPY = 127, 128
_LEAST_RUN = 4
"""Shorter runs are copied, because ending a copy and beginning the next one takes two bytes more."""

Bytes = NDArray[np.uint8]


def encode_hdr(pixels: NDArray[np.float32]) -> bytes:
    """Encode radiance (H, W, 3) as a Radiance picture, with run-length encoded rows.

    The largest channel of a texel keeps 8 bits, so that it is off by at most 1/256 of itself; the others are off by as
    much absolutely. Negative channels become 0, and values beyond 2^127 become the greatest that the format has.
    Channels that are NaN become 0.
    """
    height, width, _ = pixels.shape
    header = f"#?RADIANCE\nSOFTWARE=eclat\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    rows = to_rgbe(pixels)
    if not 8 <= width < 1 << 15:  # Rows of other widths have no run-length encoding.
        return header + rows.tobytes()
    begin = bytes((2, 2, width >> 8, width & 255))
    out = bytearray(header)
    for row in rows:
        out += begin
        for channel in range(4):
            out += _run_lengths(np.ascontiguousarray(row[:, channel]))
    return bytes(out)


def to_rgbe(pixels: NDArray[np.float32]) -> Bytes:
    """Convert radiance (H, W, 3) to bytes (H, W, 4): red, green, blue and the common exponent."""
    greatest = math.ldexp(255, 127 - 8)
    safe = np.clip(np.nan_to_num(pixels.astype(np.float64), nan=0.0, posinf=greatest, neginf=0.0), 0.0, greatest)
    _, exponent = np.frexp(safe.max(axis=-1))
    mantissas = np.rint(np.ldexp(safe, (8 - exponent)[..., None]))
    # Rounding up to 256 needs the next exponent.
    exponent = exponent + (mantissas.max(axis=-1) > 255)
    mantissas = np.rint(np.ldexp(safe, (8 - exponent)[..., None]))
    dark = (safe.max(axis=-1) <= 0) | (exponent + _BIAS < 1)
    rgbe = np.concatenate([mantissas, (exponent + _BIAS)[..., None]], axis=-1)
    rgbe[dark] = 0
    return rgbe.astype(np.uint8)


def _run_lengths(values: Bytes) -> bytes:
    """Encode one component of a row: runs as (128 + length, value), other bytes as (length, bytes)."""
    starts = np.flatnonzero(np.concatenate(([True], values[1:] != values[:-1])))
    lengths = np.diff(np.append(starts, len(values)))
    out, copied, data = bytearray(), 0, values.tobytes()

    def copy_up_to(end: int) -> None:
        nonlocal copied
        while copied < end:
            count = min(_LONGEST_COPY, end - copied)
            out.append(count)
            out.extend(data[copied : copied + count])
            copied += count

    for start, length in zip(starts.tolist(), lengths.tolist(), strict=True):
        if length < _LEAST_RUN:
            continue
        copy_up_to(start)
        while copied < start + length:
            count = min(_LONGEST_RUN, start + length - copied)
            out += bytes((128 + count, data[start]))
            copied += count
    copy_up_to(len(data))
    return bytes(out)


def decode_hdr(data: bytes, check: Callable[[int, int], None]) -> NDArray[np.float32]:
    """Decode the pixels (H, W, 3) of a Radiance picture, which may be run-length encoded or uncompressed.

    `check` raises EclatError if a width and a height are too large. It is called before memory is allocated.

    Raises EclatError, whose message does not name the file, if the picture is damaged.
    """
    end = data.find(b"\n\n", 0, _HEADER_LIMIT)
    line_end = data.find(b"\n", end + 2, _HEADER_LIMIT)
    if end < 0 or line_end < 0:
        raise EclatError("expected a Radiance header, got none")
    header, size = data[:end], _HDR_SIZE.match(data[end + 2 : line_end])
    if size is None:
        raise EclatError(f"expected a Radiance size like '-Y 512 +X 1024', got {data[end + 2 : line_end][:40]!r}")
    height, width = int(size[2]), int(size[3])
    check(width, height)
    texels = np.empty((height, width, 4), np.uint8)
    offset = line_end + 1
    for row in texels if size[1] == b"-" else texels[::-1]:
        offset = _read_hdr_row(data, offset, row)
    scale = np.ldexp(np.float32(1), texels[..., 3].astype(np.int32) - 136)  # 128 bias + 8 bits of mantissa
    scale = (scale * (texels[..., 3] > 0))[..., None] / _exposure(header).astype(np.float32)
    colors = texels[..., :3].astype(np.float32) * scale
    return _rec_709(np.asarray(colors, dtype=np.float32), header)


def _exposure(header: bytes) -> NDArray[np.float64]:
    """Multiply the factors (3,) by which programs have multiplied the colours of a Radiance picture: all of its lines
    `EXPOSURE` and `COLORCORR`.
    """
    factors = np.ones(3)
    for name, text in re.findall(rb"^(EXPOSURE|COLORCORR)=([^\n]*)$", header, re.M):
        count = 1 if name == b"EXPOSURE" else 3
        try:
            values = [float(word) for word in text.split()]
        except ValueError:
            values = []
        factors = factors * values if len(values) == count else factors * math.nan
        if not (np.isfinite(factors).all() and (factors > 0).all()):
            wanted = "a number" if count == 1 else "3 numbers"
            raise EclatError(f"{name.decode()}: expected {wanted} above 0, got {text[:40].decode(errors='replace')!r}")
    return factors


def _rec_709(colors: NDArray[np.float32], header: bytes) -> NDArray[np.float32]:
    """Convert the colours of a Radiance picture to Rec. 709 if its header states XYZ or other primaries.

    Negative channels of converted colours become 0. Colours with Radiance's own primaries and equal-energy white are
    not converted. These primaries differ from those of Rec. 709 by less than 0.02 in x and y, and nearly all programs
    write Rec. 709 colours with that header or without a header line for primaries.
    """
    from eclat.images.exr_planes import REC_709, rgb_to_xyz

    line = re.search(rb"^PRIMARIES=((?:\s*[-+0-9.eE]{1,20}){8})\s*$", header, re.M)
    to_xyz, standard = None, rgb_to_xyz(REC_709)
    assert standard is not None
    if b"xyze" in header:
        to_xyz = np.eye(3)
    elif line is not None:
        try:
            given = tuple(map(float, line[1].split()))
        except ValueError:
            return colors
        if np.abs(np.subtract(given, REC_709))[:6].max() > 0.02:
            to_xyz = rgb_to_xyz(given)
    if to_xyz is None:
        return colors
    matrix = (np.linalg.inv(standard) @ to_xyz).astype(np.float32)
    return np.asarray(np.maximum(colors @ matrix.T, 0), dtype=np.float32)


def _read_hdr_row(data: bytes, offset: int, row: NDArray[np.uint8]) -> int:
    """Decode one row of a Radiance picture from `offset` into `row` (W, 4), and return the offset of the next row."""
    width = len(row)
    start = data[offset : offset + 4]
    if len(start) < 4:
        raise EclatError("the image is truncated")
    if not 8 <= width < 1 << 15 or start[:2] != b"\x02\x02" or (start[2] << 8 | start[3]) != width:
        flat = np.frombuffer(data[offset : offset + 4 * width], np.uint8)
        if len(flat) < 4 * width:
            raise EclatError("the image is truncated")
        row[:] = flat.reshape(width, 4)
        return offset + 4 * width
    offset += 4
    for component in range(4):
        column, offset = _read_run_lengths(data, offset, width)
        row[:, component] = np.frombuffer(column, np.uint8)
    return offset


def _read_run_lengths(data: bytes, offset: int, width: int) -> tuple[bytes, int]:
    """Decode one run-length encoded component of a row, and return its `width` bytes and the offset after it.

    A code above 128 is followed by one byte, which is repeated (code − 128) times. Any other code is followed by that
    number of bytes, which are copied.
    """
    column = bytearray()
    while len(column) < width:
        head = data[offset : offset + 2]
        if len(head) < 2 or head[0] == 0:
            raise EclatError("the run-length encoding of the image is truncated or invalid")
        count = head[0]
        if count > 128:
            column += head[1:] * (count - 128)
            offset += 2
        else:
            column += data[offset + 1 : offset + 1 + count]
            offset += 1 + count
            if offset > len(data):
                raise EclatError("the image is truncated")
    if len(column) != width:
        raise EclatError("the run-length encoding of the image is invalid: a run exceeds the width of the image")
    return bytes(column), offset
