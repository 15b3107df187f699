# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read the containers of glTF: `.gltf` and `.glb` files, buffers and data URIs [glTF 2.0, 3.6 and 4]."""

from __future__ import annotations

import base64
import binascii
import copy
import json
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

from eclat.errors import EclatError, warn
from eclat.loaders.files import read_bytes, resolve
from eclat.loaders.gltf.element import Element
from eclat.loaders.gltf.meshopt import decompress, meshopt_of
from eclat.loaders.text_files import utf8

_MAGIC = b"glTF"
_JSON_CHUNK = 0x4E4F534A
_BIN_CHUNK = 0x004E4942


class Document:
    """A glTF file: its JSON, and its buffers, which are read when they are first used."""

    def __init__(self, path: Path) -> None:
        """Read the file `path`. Its content determines whether it is a .gltf or a .glb file. Raises EclatError."""
        self.folder = path.parent
        self.name = path.name
        data = read_bytes(path, where=self.name)
        if not data:
            raise EclatError(f"{self.name}: expected a glTF file, got an empty file")
        self._bin: memoryview | None = None
        text: bytes | memoryview = data
        if data.startswith(_MAGIC):
            text, self._bin = _glb_chunks(data, self.name)
        self.root = Element(_parse(bytes(text), self.name), self.name)
        self._elements: dict[str, list[Element]] = {}
        self._buffers: dict[int, memoryview] = {}
        self._decompressed: dict[str, memoryview] = {}
        _check_version(self.root)
        asset = self.root.child("asset")
        self.eclat_extras = asset.eclat_extras() if asset is not None else None
        # In a file that `eclat bake` wrote, TEXCOORD_1 belongs to the light map.
        self.second_uv_set = 1 if self.eclat_extras is None or self.eclat_extras.data.get("lightmap") is None else 2

    def changed(self, root: dict[str, Any]) -> Document:
        """Return the same file with another JSON object, which refers to the same buffers."""
        document = copy.copy(self)
        document.root = Element(root, self.name)
        document._elements = {}
        return document

    def elements(self, kind: str) -> list[Element]:
        """Return the elements of the top-level list `kind`, such as "nodes" or "meshes"."""
        if kind not in self._elements:
            self._elements[kind] = self.root.children(kind)
        return self._elements[kind]

    def element(self, owner: Element, member: str, kind: str) -> Element | None:
        """Return the element of the top-level list `kind` whose index is the member `member` of `owner`.

        The result is None if `owner` has no such member. Raises EclatError if the index is invalid.
        """
        index = owner.index(member, len(self.elements(kind)), kind)
        return None if index is None else self.elements(kind)[index]

    def buffer_view(self, owner: Element) -> tuple[memoryview, int | None] | None:
        """Return the buffer view that `owner` refers to.

        Returns
        -------
        The bytes and the stride, which is None for packed data. The result is None if `owner` refers to no buffer view.

        Raises
        ------
        EclatError : the buffer cannot be read or decompressed, or the view exceeds it.
        """
        view = self.element(owner, "bufferView", "bufferViews")
        if view is None:
            return None
        index = view.index("buffer", len(self.elements("buffers")), "buffers")
        if index is None:
            raise EclatError(f"{view.where}: expected the index of a buffer as 'buffer', but it is missing")
        stride = view.integer("byteStride", 0) or None
        packed = meshopt_of(view)
        if packed is None or self._has_data(index):
            return self._range(view, index), stride
        if view.where not in self._decompressed:
            source = packed.index("buffer", len(self.elements("buffers")), "buffers")
            if source is None:
                raise EclatError(f"{packed.where}: expected the index of a buffer as 'buffer', but it is missing")
            data = decompress(packed, self._range(packed, source), view.integer("byteLength"))
            self._decompressed[view.where] = data
        return self._decompressed[view.where], stride

    def uri_bytes(self, uri: str, where: str) -> bytes:
        """Return the bytes of a data URI, or of a file in the document's folder. Raises EclatError if they cannot be
        read.
        """
        if uri[:5].lower() == "data:":
            return _data_uri(uri, where)
        return read_bytes(self.uri_path(uri, where), where=where)

    def uri_path(self, uri: str, where: str) -> Path:
        """Return the path of the file in the document's folder that a URI names. Raises EclatError if the name is
        invalid.
        """
        try:
            decoded = unquote(uri, errors="strict")
        except UnicodeDecodeError:
            raise EclatError(f"{where}: expected a percent-encoded name in UTF-8, got {uri[:100]!r}") from None
        path = resolve(self.folder, decoded, where=where)
        if decoded != uri and not path.exists():
            # Some exporters forget to encode file names, so that a file may really be called "50%25.png".
            literal = resolve(self.folder, uri, where=where)
            return literal if literal.exists() else path
        return path

    def _buffer(self, index: int) -> memoryview:
        if index not in self._buffers:
            self._buffers[index] = self._read_buffer(index)
        return self._buffers[index]

    def _read_buffer(self, index: int) -> memoryview:
        buffer = self.elements("buffers")[index]
        length = buffer.integer("byteLength")
        uri = buffer.text("uri")
        if uri:
            data = memoryview(self.uri_bytes(uri, buffer.where))
        elif index == 0 and self._bin is not None:
            data = self._bin
        else:
            raise EclatError(f"{buffer.where}: expected a 'uri', or a binary chunk in the file, got neither")
        if len(data) < length:
            raise EclatError(f"{buffer.where}: expected {length} bytes (byteLength), got {len(data)}")
        return data[:length]

    def _range(self, owner: Element, index: int) -> memoryview:
        """Return the bytes of a buffer from the byteOffset of `owner` on, as many as its byteLength says."""
        start, length = owner.integer("byteOffset", 0), owner.integer("byteLength")
        data = self._buffer(index)
        if start + length > len(data):
            raise EclatError(
                f"{owner.where}: expected a range within the {len(data)} bytes of buffers[{index}], "
                f"got byteOffset {start} and byteLength {length}"
            )
        return data[start : start + length]

    def _has_data(self, index: int) -> bool:
        """Return whether a buffer has bytes of its own, or only stands for what its views are when decompressed."""
        buffer = self.elements("buffers")[index]
        if buffer.text("uri"):
            return True
        mark = meshopt_of(buffer)
        return index == 0 and self._bin is not None and not (mark is not None and mark.flag("fallback"))


def _check_version(root: Element) -> None:
    asset = root.child("asset")
    if asset is None:
        warn(f"{root.where}: the object 'asset', which states the version, is missing; glTF 2.0 is assumed")
        return
    version = asset.text("version", "2.0")
    if version.split(".")[0] != "2":
        raise EclatError(f"{asset.where}: expected glTF version 2.x, got {version[:20]!r}")


def _glb_chunks(data: bytes, name: str) -> tuple[memoryview, memoryview | None]:
    """Return the JSON and the binary chunk of a GLB file."""
    if len(data) < 20:
        raise EclatError(f"{name}: expected a GLB header and a JSON chunk, got {len(data)} bytes")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise EclatError(f"{name}: expected GLB version 2, got {version}")
    if length > len(data):
        raise EclatError(
            f"{name}: expected {length} bytes, as the header states, got {len(data)}; the file is truncated"
        )
    if length < len(data):
        warn(
            f"{name}: the file is {len(data) - length} bytes longer than its header states; the additional bytes are "
            "ignored"
        )
    chunks = _chunks(memoryview(data)[:length], name)
    if not chunks or chunks[0][0] != _JSON_CHUNK:
        raise EclatError(f"{name}: expected a JSON chunk as the first chunk, got another kind or none")
    binary = [content for kind, content in chunks[1:2] if kind == _BIN_CHUNK]
    return chunks[0][1], binary[0] if binary else None


def _chunks(data: memoryview, name: str) -> list[tuple[int, memoryview]]:
    chunks: list[tuple[int, memoryview]] = []
    offset = 12
    # Only the first two chunks have a meaning. A file may have more, which are ignored.
    while offset + 8 <= len(data) and len(chunks) < 2:
        length, kind = struct.unpack_from("<II", data, offset)
        if offset + 8 + length > len(data):
            raise EclatError(
                f"{name}: expected a chunk of {length} bytes at offset {offset}, got only {len(data) - offset - 8} bytes"
            )
        chunks.append((kind, data[offset + 8 : offset + 8 + length]))
        offset += 8 + length
    return chunks


def _parse(data: bytes, name: str) -> dict[str, Any]:
    try:
        root = json.loads(utf8(data, name).decode("utf-8"), parse_constant=_refuse_constant)
    except UnicodeDecodeError as error:
        raise EclatError(
            f"{name}: expected JSON in UTF-8, got the byte {data[error.start]:#04x} at offset {error.start}"
        ) from None
    except RecursionError:
        raise EclatError(f"{name}: expected glTF, got JSON that is nested too deeply") from None
    except ValueError as error:
        raise EclatError(f"{name}: expected valid JSON, got an error: {error}") from None
    if not isinstance(root, dict):
        raise EclatError(f"{name}: expected a JSON object, got {type(root).__name__}")
    return root


def _refuse_constant(word: str) -> float:
    raise ValueError(f"JSON does not allow the number {word}")


def _data_uri(uri: str, where: str) -> bytes:
    header, comma, body = uri.partition(",")
    if not comma:
        raise EclatError(f"{where}: expected a data URI with a comma before the data, got {uri[:40]!r}")
    if not header.lower().endswith(";base64"):
        return unquote_to_bytes(body)
    text = unquote(body) if "%" in body else body
    try:
        return base64.b64decode(text + "=" * (-len(text) % 4), validate=True)
    except (binascii.Error, ValueError) as error:
        raise EclatError(f"{where}: expected valid base64 in the data URI, got an error: {error}") from None
