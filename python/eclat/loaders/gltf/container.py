# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The containers of glTF: `.gltf` and `.glb` files, buffers, data URIs [glTF 2.0, 3.6 and 4]."""

from __future__ import annotations

import base64
import binascii
import json
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

from eclat.errors import EclatError, warn
from eclat.loaders.files import read_bytes, resolve
from eclat.loaders.gltf.element import Element
from eclat.loaders.text_files import utf8

_MAGIC = b"glTF"
_JSON_CHUNK = 0x4E4F534A
_BIN_CHUNK = 0x004E4942
_MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression", "MESHOPT_compression")


class Document:
    """A glTF file: its JSON, and its buffers as they are asked for."""

    def __init__(self, path: Path) -> None:
        """Read `path`; its content decides whether it is .gltf or .glb. Raises EclatError."""
        self.folder = path.parent
        self.name = path.name
        data = read_bytes(path, where=self.name)
        if not data:
            raise EclatError(f"{self.name}: expected a glTF file, got an empty one")
        self._bin: memoryview | None = None
        text: bytes | memoryview = data
        if data.startswith(_MAGIC):
            text, self._bin = _glb_chunks(data, self.name)
        self.root = Element(_parse(bytes(text), self.name), self.name)
        self._elements: dict[str, list[Element]] = {}
        self._buffers: dict[int, memoryview] = {}
        _check_version(self.root)
        asset = self.root.child("asset")
        self.own_note = asset.own_note() if asset is not None else None
        # A file that we baked has its light map in TEXCOORD_1.
        self.second_uv_set = 1 if self.own_note is None or self.own_note.data.get("lightmap") is None else 2

    def elements(self, kind: str) -> list[Element]:
        """The top-level list `kind`: "nodes", "meshes", …"""
        if kind not in self._elements:
            self._elements[kind] = self.root.children(kind)
        return self._elements[kind]

    def element(self, owner: Element, member: str, kind: str) -> Element | None:
        """The element of the top-level list `kind` whose index `owner` holds as `member`."""
        index = owner.index(member, len(self.elements(kind)), kind)
        return None if index is None else self.elements(kind)[index]

    def buffer_view(self, owner: Element) -> tuple[memoryview, int | None] | None:
        """The bytes and the stride (None = packed) of the buffer view that `owner` names; None where it names none."""
        view = self.element(owner, "bufferView", "bufferViews")
        if view is None:
            return None
        index = view.index("buffer", len(self.elements("buffers")), "buffers")
        if index is None:
            raise EclatError(f"{view.where}: expected an integer as 'buffer', which is missing")
        self._refuse_compressed(view, index)
        start, length = view.integer("byteOffset", 0), view.integer("byteLength")
        data = self._buffer(index)
        if start + length > len(data):
            raise EclatError(
                f"{view.where}: expected bytes within buffers[{index}], which has {len(data)}, "
                f"got byteOffset {start} + byteLength {length}"
            )
        stride = view.integer("byteStride", 0)
        return data[start : start + length], stride or None

    def uri_bytes(self, uri: str, where: str) -> bytes:
        """The content of a URI: that of a data URI, or of a file in the document's folder. Raises EclatError."""
        if uri[:5].lower() == "data:":
            return _data_uri(uri, where)
        return read_bytes(self.uri_path(uri, where), where=where)

    def uri_path(self, uri: str, where: str) -> Path:
        """The file in the document's folder that a URI names. Raises EclatError."""
        try:
            decoded = unquote(uri, errors="strict")
        except UnicodeDecodeError:
            raise EclatError(f"{where}: expected UTF-8 in the percent-encoded name {uri[:100]!r}") from None
        path = resolve(self.folder, decoded, where=where)
        if decoded != uri and not path.exists():
            # Exporters forget to encode: a file may really be called "50%25.png".
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
            raise EclatError(f"{buffer.where}: expected a 'uri' or a binary chunk, got neither")
        if len(data) < length:
            raise EclatError(f"{buffer.where}: expected {length} bytes (byteLength), got {len(data)}")
        return data[:length]

    def _refuse_compressed(self, view: Element, buffer: int) -> None:
        has_data = self.elements("buffers")[buffer].text("uri") or (buffer == 0 and self._bin is not None)
        names = [name for name in _MESHOPT if view.extension(name)]
        if names and not has_data:
            raise EclatError(
                f"{view.where}: the data are compressed by {names[0]}, which is not supported; "
                f"decompress the file first (gltf-transform and gltfpack can)"
            )


def _check_version(root: Element) -> None:
    asset = root.child("asset")
    if asset is None:
        warn(f"{root.where}: expected an 'asset' with the version, got none; glTF 2.0 is assumed")
        return
    version = asset.text("version", "2.0")
    if version.split(".")[0] != "2":
        raise EclatError(f"{asset.where}: expected glTF version 2.x, got {version[:20]!r}")


def _glb_chunks(data: bytes, name: str) -> tuple[memoryview, memoryview | None]:
    """The JSON and the binary chunk of a GLB file."""
    if len(data) < 20:
        raise EclatError(f"{name}: expected a GLB header and a JSON chunk, got {len(data)} bytes")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise EclatError(f"{name}: expected GLB version 2, got {version}")
    if length > len(data):
        raise EclatError(f"{name}: expected {length} bytes (the header's length), got {len(data)}: the file is cut off")
    if length < len(data):
        warn(f"{name}: {len(data) - length} bytes after the end that the header states are ignored")
    chunks = _chunks(memoryview(data)[:length], name)
    if not chunks or chunks[0][0] != _JSON_CHUNK:
        raise EclatError(f"{name}: expected a JSON chunk first, got another")
    binary = [content for kind, content in chunks[1:2] if kind == _BIN_CHUNK]
    return chunks[0][1], binary[0] if binary else None


def _chunks(data: memoryview, name: str) -> list[tuple[int, memoryview]]:
    chunks: list[tuple[int, memoryview]] = []
    offset = 12
    # Only the first two chunks have a meaning. More are allowed, and ignored.
    while offset + 8 <= len(data) and len(chunks) < 2:
        length, kind = struct.unpack_from("<II", data, offset)
        if offset + 8 + length > len(data):
            raise EclatError(
                f"{name}: expected a chunk of {length} bytes at offset {offset}, got {len(data) - offset - 8}"
            )
        chunks.append((kind, data[offset + 8 : offset + 8 + length]))
        offset += 8 + length
    return chunks


def _parse(data: bytes, name: str) -> dict[str, Any]:
    try:
        root = json.loads(utf8(data, name).decode("utf-8"), parse_constant=_refuse_constant)
    except UnicodeDecodeError as error:
        raise EclatError(
            f"{name}: expected JSON in UTF-8, got byte {data[error.start]:#04x} at {error.start}"
        ) from None
    except RecursionError:
        raise EclatError(f"{name}: expected glTF, got JSON nested too deeply") from None
    except ValueError as error:
        raise EclatError(f"{name}: expected JSON: {error}") from None
    if not isinstance(root, dict):
        raise EclatError(f"{name}: expected a JSON object, got {type(root).__name__}")
    return root


def _refuse_constant(word: str) -> float:
    raise ValueError(f"{word} is not a number that JSON knows")


def _data_uri(uri: str, where: str) -> bytes:
    header, comma, body = uri.partition(",")
    if not comma:
        raise EclatError(f"{where}: expected a comma in the data URI {uri[:40]!r}")
    if not header.lower().endswith(";base64"):
        return unquote_to_bytes(body)
    text = unquote(body) if "%" in body else body
    try:
        return base64.b64decode(text + "=" * (-len(text) % 4), validate=True)
    except (binascii.Error, ValueError) as error:
        raise EclatError(f"{where}: expected base64 in the data URI: {error}") from None
