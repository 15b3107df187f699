# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The format of everything that the page of `eclat view` reads, as a file or as a message of the web socket.

A message is a header and arrays, all numbers little-endian:

    bytes 0..3     "ECLV"
    bytes 4..7     uint32, VERSION
    bytes 8..11    uint32, the length of the header in bytes
    then           the header: JSON in UTF-8, padded with spaces so that the arrays begin at a multiple of 8
    then           the arrays, C-contiguous, each beginning at a multiple of 8

The header is an object. `kind` says what the message is, and `arrays` maps the name of each array to its `type` ("f4",
"f2", "u4", "u2", "u1"), `shape` and `offset`, which is counted from the beginning of the message. The other fields
depend on the kind:

    scene      name, center, up, photometric, exposure, cameras, materials, lights, meshes, textures, notes.
               A mesh names its arrays: `positions` (V, 3) relative to the center, `triangles` (T, 3), and where it has
               them `normals`, `uvs`, `uvs2`, `colors`, `tangents` and `light_uvs`. A texture is an array of the bytes of a PNG
               file ("u1") or of half floats (H, W, 4). See `surfaces`, `materials` and `lamps`.
    light      the direct irradiance of glowing surfaces and of what is sharp in the sky: `map` (H, W, 4) half floats,
               in W/m² times `scale`, which the coordinates `light_uvs` of the meshes read. Where a scene has normal maps,
               `moments` is true, and `moment_r`, `moment_g` and `moment_b` (H, W, 4) hold M = ∫ L ω dω of each channel.
    records    `first` and `count` (the number of records of irradiance that there are after this message), `reading`
               (how they are read), and `rows` (n, 52) of "f4": they become the records first, first + 1, …, so that a
               message may append records, or replace some whose radius has changed. See `record_rows`.
    gloss      records of radiance, see `gloss`.
    truth      a picture by the core, see `live`.
    hemisphere what a record sees, see `hemisphere`.

The page's side of this format is in `web/view/src/messages.ts`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

MAGIC = b"ECLV"

VERSION = 1
"""Version of the format. The page refuses messages of another version."""

ALIGNMENT = 8

_TYPES = {"float32": "f4", "float16": "f2", "uint32": "u4", "uint16": "u2", "uint8": "u1"}


def encode_message(kind: str, content: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> bytes:
    """Encode a message.

    Parameters
    ----------
    kind : "scene", "light", "records", "gloss", "truth" or "hemisphere".
    content : the other fields of the header, which must be representable as JSON.
    arrays : the arrays by name, whose types are those that the format lists.

    Raises
    ------
    KeyError : an array has another type.
    """
    entries = {
        name: {"type": _TYPES[array.dtype.name], "shape": list(array.shape), "offset": 0}
        for name, array in arrays.items()
    }
    header = {"kind": kind, **content, "arrays": entries}
    # The offsets are written with as many digits as the longest of them may have, so that the length does not change.
    room = _padded(len(_json(header)) + 20 * len(arrays))
    at = _padded(12 + room)
    blocks = []
    for name, array in arrays.items():
        data = np.ascontiguousarray(array, array.dtype.newbyteorder("<")).tobytes()
        entries[name]["offset"] = at
        blocks.append(data.ljust(_padded(len(data)), b"\0"))
        at += len(blocks[-1])
    text = _json(header).ljust(_padded(12 + room) - 12)
    numbers = np.array([VERSION, len(text)], "<u4").tobytes()
    return b"".join([MAGIC, numbers, text, *blocks])


def decode_message(data: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Decode a message into its header, without `arrays`, and its arrays.

    Raises
    ------
    ValueError : the bytes are not a message of this version.
    """
    if data[:4] != MAGIC or len(data) < 12:
        raise ValueError("expected a message of the viewer, got other bytes")
    version, length = (int(x) for x in np.frombuffer(data, "<u4", 2, 4))
    if version != VERSION:
        raise ValueError(f"expected version {VERSION} of the viewer's format, got {version}")
    header = json.loads(data[12 : 12 + length])
    arrays = {}
    for name, entry in header.pop("arrays").items():
        count = int(np.prod(entry["shape"], dtype=np.int64))
        arrays[name] = np.frombuffer(data, "<" + entry["type"], count, entry["offset"]).reshape(entry["shape"])
    return header, arrays


def _json(header: Mapping[str, Any]) -> bytes:
    return json.dumps(header, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()


def _padded(size: int) -> int:
    return -(-size // ALIGNMENT) * ALIGNMENT
