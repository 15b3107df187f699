# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Small glTF files made by code: a builder that packs arrays into one buffer."""

from __future__ import annotations

import base64
import io
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

COMPONENT_TYPES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}

TRIANGLE = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
"""In the plane z = 0, its normal +z."""


class GltfFile:
    """A document under construction: `json` may be changed at will before `save`."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.json: dict[str, Any] = {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": []}

    def append(self, kind: str, value: dict[str, Any]) -> int:
        """Add to a top-level list; the index."""
        self.json.setdefault(kind, []).append(value)
        return len(self.json[kind]) - 1

    def view(self, data: bytes, **extra: Any) -> int:
        """A buffer view of `data`; the index."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data), **extra}
        self.binary += data
        return self.append("bufferViews", view)

    def accessor(self, values: Any, dtype: str = "f4", **extra: Any) -> int:
        """An accessor of (N,) or (N, width) values; the index."""
        array = np.atleast_1d(np.asarray(values)).astype(f"<{dtype}")
        width = 1 if array.ndim == 1 else array.shape[1]
        description = {"componentType": COMPONENT_TYPES[dtype], "type": KINDS[width], "count": len(array)}
        return self.append("accessors", {"bufferView": self.view(array.tobytes()), **description, **extra})

    def primitive(self, positions: Any = TRIANGLE, indices: Any = None, **extra: Any) -> dict[str, Any]:
        """A primitive; other attributes go into its "attributes"."""
        primitive = {"attributes": {"POSITION": self.accessor(positions)}, **extra}
        if indices is not None:
            primitive["indices"] = self.accessor(indices, "u2")
        return primitive

    def mesh_node(self, *primitives: dict[str, Any], **node: Any) -> int:
        """A root node with a mesh of the primitives (one triangle if none); the node's index."""
        mesh = self.append("meshes", {"primitives": list(primitives or (self.primitive(),))})
        return self.append("nodes", {"mesh": mesh, **node})

    def texture(self, pixels: Any, **sampler: int) -> int:
        """A texture with an embedded PNG of an (H, W, C) uint8 image; the index."""
        image = self.append("images", {"bufferView": self.view(png_bytes(pixels)), "mimeType": "image/png"})
        texture = {"source": image}
        if sampler:
            texture["sampler"] = self.append("samplers", sampler)
        return self.append("textures", texture)

    def glb(self) -> bytes:
        """The file as GLB."""
        text = json.dumps({**self.json, "buffers": [{"byteLength": len(self.binary)}]}).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.binary) + b"\0" * (-len(self.binary) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
        return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks

    def save(self, folder: Path, name: str = "scene.glb") -> Path:
        """Write `.glb`, or `.gltf` with the buffer in a data URI; the path."""
        path = folder / name
        if path.suffix == ".glb":
            path.write_bytes(self.glb())
        else:
            uri = "data:application/octet-stream;base64," + base64.b64encode(bytes(self.binary)).decode()
            buffers = self.json.get("buffers", [{"byteLength": len(self.binary), "uri": uri}])
            path.write_text(json.dumps({**self.json, "buffers": buffers}), encoding="utf-8")
        return path


def moving_file(folder: Path, name: str = "scene.glb") -> Path:
    """Write a file with a triangle "door" that slides by 4 m along x in 2 s; its path."""
    file = GltfFile()
    node = file.mesh_node(name="door")
    sampler = {"input": file.accessor([0, 2]), "output": file.accessor([[0, 0, 0], [4, 0, 0]])}
    channel = {"sampler": 0, "target": {"node": node, "path": "translation"}}
    file.append("animations", {"samplers": [sampler], "channels": [channel]})
    return file.save(folder, name)


def png_bytes(pixels: Any) -> bytes:
    """An (H, W, C) uint8 image as PNG."""
    array = np.asarray(pixels, dtype=np.uint8)
    buffer = io.BytesIO()
    Image.fromarray(array[..., 0] if array.shape[2] == 1 else array).save(buffer, "PNG")
    return buffer.getvalue()
