# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read Mitsuba's compressed meshes (.serialized), versions 3 and 4. A file holds several shapes.

Each shape has a header of two 16-bit numbers (0x041C and the version), which is followed by a zlib stream with:

- 32 bits of flags;
- in version 4, a name that ends with a zero byte;
- the number of vertices and the number of triangles, 64 bits each;
- positions, and then the normals, texture coordinates and colours that the flags announce, in single or double
  precision;
- vertex indices, of 64 bits if there are more vertices than 32 bits can count, otherwise of 32 bits.

The file ends with the offsets of the shapes (32 bits each in version 3, 64 bits in version 4) and the 32-bit number of
shapes. All numbers are little-endian. Texture coordinates have v downwards, as in Éclat.
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
"""The largest ratio of decompressed to compressed bytes that deflate can reach: 258 bytes for 2 bits. A shape that
claims more data is invalid."""
_PIECE, _CHUNK = 1 << 16, 1 << 20
"""The largest numbers of compressed and of decompressed bytes in one step."""
_LONGEST_NAME = 4096
"""The largest number of bytes in the name of a shape."""


def load_serialized(path: Path, shape_index: int = 0, *, face_normals: bool = False) -> Mesh:
    """Load one shape of a .serialized file as a mesh with the default material.

    Parameters
    ----------
    path : the file.
    shape_index : the number of the shape, from 0.
    face_normals : use flat shading. The file can demand flat shading too. Otherwise the mesh has the file's vertex
        normals or, if there are none, smooth normals weighted by angle.

    Raises
    ------
    EclatError : there is no such shape, the file is truncated or corrupted, an index is out of range, or a coordinate
        is not finite.
    """
    data = read_bytes(path, where=path.name)
    where = f"{path.name}, shape {shape_index}"
    version, stream = _Inflated.of_shape(data, shape_index, path.name)
    (flags,) = struct.unpack("<I", stream.read(4))
    name = decoded(stream.read_name()) if version >= 4 else ""
    vertices, count = struct.unpack("<QQ", stream.read(16))
    if bool(flags & _SINGLE) == bool(flags & _DOUBLE):
        raise EclatError(f"{where}: expected flags for either single or double precision, got {flags:#x}")
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
    triangles = triangles[geometry.triangles_with_area(positions, triangles, where)]
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
    colors = colors / np.float32(geometry.white_level(colors, "vertex colours", where, linear=True))
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
    """Return the offsets of the first byte of the shape `index` and of the first byte after it."""
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
        raise EclatError(
            f"{where}: expected a table of shapes at the end of the file, got {count} shapes; the file may be truncated"
        )
    if not 0 <= index < count:
        raise EclatError(f"{where}: expected a shape index in 0..{count - 1}, got {index}")
    (begin,) = struct.unpack_from(f"<{code}", data, table + width * index)
    end = table
    if index + 1 < count:
        (end,) = struct.unpack_from(f"<{code}", data, table + width * (index + 1))
    if not begin + 4 < end <= table:
        raise EclatError(
            f"{where}: expected shape {index} within the first {table} bytes of the file, got bytes {begin} to {end}"
        )
    return begin, end


class _Inflated:
    """The zlib stream of a shape. It is decompressed as it is read, so that invalid sizes do not allocate memory."""

    def __init__(self, compressed: bytes, where: str) -> None:
        self._decompressor = zlib.decompressobj()
        self._input = compressed
        self._place = 0
        self._ready = b""
        self._where = where

    @classmethod
    def of_shape(cls, data: bytes, index: int, where: str) -> tuple[int, _Inflated]:
        """Return the version in the header of the shape `index`, and the stream of the shape."""
        begin, end = _shape_range(data, index, where)
        magic, version = struct.unpack_from("<HH", data, begin)
        if magic != _MAGIC or version not in (3, 4):
            raise EclatError(
                f"{where}, shape {index}: expected {_MAGIC:#06x}, version 3 or 4, got {magic:#06x}, version {version}"
            )
        return version, cls(data[begin + 4 : end], f"{where}, shape {index}")

    def promise(self, size: int) -> None:
        """Raise EclatError if the stream cannot contain `size` decompressed bytes."""
        if size > len(self._input) * _DEFLATE_LIMIT:
            raise EclatError(
                f"{self._where}: the header claims {size} bytes of mesh data, which is more than "
                f"{len(self._input)} compressed bytes can contain"
            )

    def read(self, size: int) -> bytes:
        """Read exactly `size` bytes. Raises EclatError if the stream ends before."""
        parts = [self._ready]
        missing = size - len(self._ready)
        while missing > 0:
            part = self._more()
            if not part:
                raise EclatError(f"{self._where}: expected {missing} more bytes of mesh data; the data are truncated")
            parts.append(part)
            missing -= len(part)
        joined = b"".join(parts)
        self._ready = joined[size:]
        return joined[:size]

    def read_name(self) -> bytes:
        """Read the bytes before the next zero byte, and skip the zero byte."""
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
        """Read the stream up to its checksum. Raises EclatError if the checksum does not match."""
        self._more()

    def _more(self) -> bytes:
        """Decompress at most `_CHUNK` bytes. The result is empty only at the end of the stream."""
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
