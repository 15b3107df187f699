# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mitsuba's compressed meshes (.serialized), versions 3 and 4: several shapes in a file, each a zlib stream.

Each shape is a header of two 16-bit numbers (0x041C and the version) and a stream of: 32 flags; in version 4 a name
that ends with a zero byte; 64-bit counts of vertices and triangles; positions, then normals, uvs and colours as the
flags say, in single or double precision; indices, of 64 bits where there are more vertices than 32 bits can count.
At the file's end stand the shapes' offsets (32 bits in version 3, 64 in version 4) and their 32-bit number.
All is little-endian. Texture coordinates have our orientation, v downwards.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.loaders import triangles as geometry
from eclat.loaders.files import read_bytes
from eclat.loaders.text_files import decoded
from eclat.scene import Material, Mesh

_MAGIC = 0x041C
_HAS_NORMALS, _HAS_UVS, _HAS_COLORS, _FACE_NORMALS = 0x1, 0x2, 0x8, 0x10
_SINGLE, _DOUBLE = 0x1000, 0x2000

_DEFLATE_LIMIT = 1032
"""No deflate stream grows by more than this (258 bytes for 2 bits), so a shape that promises more is lying."""
_PIECE, _CHUNK = 1 << 16, 1 << 20
"""Bytes decompressed from and to in one step."""
_LONGEST_NAME = 4096


def load_serialized(path: Path, shape_index: int = 0, *, face_normals: bool = False) -> Mesh:
    """Shape number `shape_index` (from 0) of the file, with the default material.

    Parameters
    ----------
    face_normals : flat shading, which the file may ask for as well; else its normals, or where it has none smooth
        ones, weighted by angle.

    Raises
    ------
    EclatError : no such shape, truncated or corrupted files, indices out of range, coordinates that are not finite.
    """
    data = read_bytes(path, where=path.name)
    where = f"{path.name}, shape {shape_index}"
    version, stream = _Inflated.of_shape(data, shape_index, path.name)
    (flags,) = struct.unpack("<I", stream.read(4))
    name = decoded(stream.read_name()) if version >= 4 else ""
    vertices, count = struct.unpack("<QQ", stream.read(16))
    if bool(flags & _SINGLE) == bool(flags & _DOUBLE):
        raise EclatError(f"{where}: expected flags that say single or double precision, got {flags:#x}")
    real = "<f8" if flags & _DOUBLE else "<f4"
    index = "<u8" if vertices > 0xFFFFFFFF else "<u4"
    columns = 3 + 3 * bool(flags & _HAS_NORMALS) + 2 * bool(flags & _HAS_UVS) + 3 * bool(flags & _HAS_COLORS)
    stream.promise(vertices * columns * int(real[2]) + 3 * count * int(index[2]))
    positions = stream.table(vertices, 3, real)
    normals = stream.table(vertices, 3, real) if flags & _HAS_NORMALS else None
    uvs = stream.table(vertices, 2, real) if flags & _HAS_UVS else None
    colors = stream.table(vertices, 3, real) if flags & _HAS_COLORS else None
    triangles = _checked(stream.table(count, 3, index), vertices, where)
    stream.finish()
    geometry.check_positions(positions, where)
    triangles = triangles[geometry.drop_slivers(positions, triangles, where)]
    flat = face_normals or bool(flags & _FACE_NORMALS)
    return Mesh(
        positions=positions,
        triangles=triangles.astype(np.int32),
        material=Material(vertex_colors=colors is not None),
        normals=None if flat else geometry.vertex_normals(positions, triangles, normals, where),
        uvs=None if uvs is None else geometry.finite_rows(uvs, "texture coordinates", where),
        colors=None if colors is None else _opaque(geometry.finite_rows(colors, "vertex colours", where), where),
        name=name or f"{path.stem}[{shape_index}]",
    )


def _opaque(colors: NDArray[np.float32], where: str) -> NDArray[np.float32]:
    colors = colors / np.float32(geometry.white_of(colors, "vertex colours", where, linear=True))
    return np.column_stack([np.clip(colors, 0, 1), np.ones(len(colors), dtype=np.float32)])


def _checked(triangles: NDArray[Any], vertices: int, where: str) -> NDArray[np.int64]:
    wrong = (triangles >= vertices).any(axis=1)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise EclatError(
            f"{where}, triangle {row}: expected vertex indices in 0..{vertices - 1}, got {triangles[row].max()}"
        )
    return triangles.astype(np.int64)


def _shape_range(data: bytes, index: int, where: str) -> tuple[int, int]:
    """The offsets at which a shape's bytes begin and end."""
    if len(data) < 8:
        raise EclatError(f"{where}: expected a .serialized file, got {len(data)} bytes")
    magic, version = struct.unpack_from("<HH", data)
    if magic != _MAGIC or version not in (3, 4):
        raise EclatError(
            f"{where}: expected Mitsuba's .serialized format, version 3 or 4 ({_MAGIC:#06x}), "
            f"got {magic:#06x}, version {version}"
        )
    width, code = (8, "Q") if version == 4 else (4, "I")
    (count,) = struct.unpack_from("<I", data, len(data) - 4)
    table = len(data) - 4 - width * count
    if count < 1 or table < 4:
        raise EclatError(f"{where}: expected a table of shapes at the file's end, got {count} shapes: is it truncated?")
    if not 0 <= index < count:
        raise EclatError(f"{where}: expected a shape index in 0..{count - 1}, got {index}")
    (begin,) = struct.unpack_from(f"<{code}", data, table + width * index)
    end = table
    if index + 1 < count:
        (end,) = struct.unpack_from(f"<{code}", data, table + width * (index + 1))
    if not begin + 4 < end <= table:
        raise EclatError(f"{where}: expected shape {index} inside the file's {table} bytes, got bytes {begin} to {end}")
    return begin, end


class _Inflated:
    """A shape's stream, decompressed only as far as it is read, so that memory grows with the real data."""

    def __init__(self, compressed: bytes, where: str) -> None:
        self._decompressor = zlib.decompressobj()
        self._input = compressed
        self._place = 0
        self._ready = b""
        self._where = where

    @classmethod
    def of_shape(cls, data: bytes, index: int, where: str) -> tuple[int, _Inflated]:
        """The version that a shape states, and its stream."""
        begin, end = _shape_range(data, index, where)
        magic, version = struct.unpack_from("<HH", data, begin)
        if magic != _MAGIC or version not in (3, 4):
            raise EclatError(
                f"{where}, shape {index}: expected {_MAGIC:#06x}, version 3 or 4, got {magic:#06x}, version {version}"
            )
        return version, cls(data[begin + 4 : end], f"{where}, shape {index}")

    def promise(self, size: int) -> None:
        """Raise EclatError if this stream cannot contain the given number of bytes."""
        if size > len(self._input) * _DEFLATE_LIMIT:
            raise EclatError(f"{self._where}: expected {size} bytes of mesh, more than the compressed data can hold")

    def read(self, size: int) -> bytes:
        """Read exactly `size` bytes."""
        parts = [self._ready]
        missing = size - len(self._ready)
        while missing > 0:
            part = self._more()
            if not part:
                raise EclatError(f"{self._where}: expected {missing} more bytes of mesh: the data are truncated")
            parts.append(part)
            missing -= len(part)
        joined = b"".join(parts)
        self._ready = joined[size:]
        return joined[:size]

    def read_name(self) -> bytes:
        """Read the bytes before the next zero, and skip the zero."""
        name = bytearray()
        while (byte := self.read(1)) != b"\0":
            name += byte
            if len(name) > _LONGEST_NAME:
                raise EclatError(f"{self._where}: expected a name of at most {_LONGEST_NAME} bytes, got a longer one")
        return bytes(name)

    def table(self, rows: int, columns: int, kind: str) -> NDArray[Any]:
        """Read an array (rows, columns) of numbers in native byte order."""
        size = rows * columns * int(kind[2])
        table: NDArray[Any] = np.frombuffer(self.read(size), kind).reshape(rows, columns)
        return table.astype(kind[1:], copy=False)

    def finish(self) -> None:
        """Reach the stream's checksum, which raises EclatError if it does not fit."""
        self._more()

    def _more(self) -> bytes:
        """Read at most one chunk; the result is empty only at the end of the stream."""
        while not self._decompressor.eof:
            piece = self._decompressor.unconsumed_tail
            if not piece:
                piece = self._input[self._place : self._place + _PIECE]
                self._place += len(piece)
            try:
                part = self._decompressor.decompress(piece, _CHUNK)
            except zlib.error as error:
                raise EclatError(f"{self._where}: the compressed data are corrupted: {error}") from None
            if part or not piece:
                return part
        return b""
