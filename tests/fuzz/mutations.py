# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Damages files. Half of the changes keep the file's outer form (JSON, chunks with right checksums, archives of arrays),
so that what lies behind the first check of a reader is met too."""

from __future__ import annotations

import io
import json
import re
import struct
import zlib
from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np

NUMBERS = (
    *("0", "-1", "1", "2", "-0.0", "0.5", "255", "256", "65535", "65536", "2147483647", "-2147483648", "4294967295"),
    *("4294967296", "9223372036854775807", "18446744073709551616", "99999999999999999999999", "1e18", "-1e20", "3e38"),
    *("1e-38", "1e-320", "1e39", "1e308", "1e999", "nan", "-inf", "inf", "NaN", "1_0", "0x10", "1.#QNAN", "1,5", ""),
)
PIECES = (
    *(b"\x00", b"\xff\xfe", b"/", b"//", b"\\\n", b"#", b"\n", b"\r\n", b" ", b"\t", b"-", b"\xe9", b"\x00" * 8, b'"'),
    *(b"<", b">", b"&", b"&amp;", b"$a", b"{", b"}", b"[", b"]", b",", b":", b"..", b"../", b"\x1b[31m", b"\xff" * 4),
)
WORDS = re.compile(rb"[A-Za-z0-9_.+\-$#]+")
INTEGERS = (0, 1, 2, 3, 127, 128, 255, 256, 32767, 32768, 65535, 65536, 2**24, 2**31 - 1, 2**31, 2**32 - 1)

Damage = Callable[[bytes, Random], bytes]


def damaged(name: str, data: bytes, random: Random) -> bytes:
    """The content `data` of the file `name` after one to six changes."""
    suffix = name[name.rfind(".") :].lower()
    damage = BY_SUFFIX.get(suffix, damaged_bytes)
    for _ in range(1 + min(int(random.expovariate(0.7)), 5)):
        # What is no JSON at all is refused before any code of ours.
        whole = suffix == ".json" or random.random() < 0.75
        data = (damage if whole else damaged_bytes)(data, random)
    return data


def damaged_bytes(data: bytes, random: Random) -> bytes:
    """One change that knows no format. Early bytes, where headers are, are chosen more often."""
    size = len(data)
    place = int(size * random.random() ** 3) if random.random() < 0.5 else random.randrange(size + 1)
    kind = random.randrange(8)
    if kind == 0 and size:
        changed = bytearray(data)
        changed[min(place, size - 1)] ^= 1 << random.randrange(8)
        return bytes(changed)
    if kind == 1:
        order, code = random.choice("<>"), random.choice("BHIQ")
        number = struct.pack(order + code, random.choice(INTEGERS) % (1 << 8 * struct.calcsize(code)))
        return data[:place] + number + data[place + len(number) :]
    if kind == 2:
        return data[:place] + data[place + int(random.expovariate(0.1)) :]
    if kind == 3:
        return data[:place] + random.choice(PIECES) + data[place:]
    if kind == 4:
        other = random.randrange(size + 1)
        return data[:place] + data[other : other + random.randrange(1, 40)] + data[place:]
    if kind == 5:
        return data[:place] if random.random() < 0.3 else data + data[place:]
    if kind == 6:
        piece = struct.pack(random.choice("<>") + random.choice("fd"), float(random.choice(FLOATS)))
        return data[:place] + piece + data[place + len(piece) :]
    return data[:place] + random.randbytes(random.randrange(1, 9)) + data[place + 1 :]


FLOATS = (0.0, -0.0, 1.0, -1.0, 1e-38, 1e-45, 1e18, -1e20, 3e38, float("inf"), float("nan"))


def damaged_text(data: bytes, random: Random) -> bytes:
    """A word becomes another one of the file, or a number that few expect; or a line moves, doubles or goes."""
    kind = random.randrange(4)
    if kind == 0:
        lines = data.splitlines(keepends=True)
        if not lines:
            return b"\n"
        line = lines.pop(random.randrange(len(lines)))
        for _ in range(random.randrange(3)):
            lines.insert(random.randrange(len(lines) + 1), line)
        return b"".join(lines)
    words = list(WORDS.finditer(data))
    if not words:
        return damaged_bytes(data, random)
    word = random.choice(words)
    new = random.choice(words)[0] if kind == 1 else random.choice(NUMBERS).encode()
    return data[: word.start()] + new + data[word.end() :]


def damaged_json(data: bytes, random: Random) -> bytes:
    """A value of the tree changes, goes, or comes twice."""
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError):
        return damaged_text(data, random)
    change_tree(tree, random)
    return json.dumps(tree).encode("utf-8", "surrogatepass")


def change_tree(tree: Any, random: Random, values: tuple[Any, ...] = ()) -> None:
    """Change one place in a tree of dicts and lists; `values` are taken beside those of JSON."""
    places: list[tuple[Any, Any]] = []

    def walk(node: Any) -> None:
        for key, value in node.items() if isinstance(node, dict) else enumerate(node):
            places.append((node, key))
            if isinstance(value, dict | list):
                walk(value)

    if isinstance(tree, dict | list):
        walk(tree)
    if not places:
        return
    owner, key = random.choice(places)
    kind = random.randrange(6)
    if kind == 0:
        del owner[key]
    elif kind == 1:
        other, name = random.choice(places)
        if name in other if isinstance(other, dict) else name < len(other):
            # A copy, since a tree that contains itself is no JSON.
            owner[key] = json.loads(json.dumps(other[name], default=str))
    elif kind == 2 and isinstance(owner, list):
        owner.insert(key, json.loads(json.dumps(owner[key], default=str)))
    elif isinstance(owner[key], int | float) and kind < 5:
        owner[key] = random.choice((*INTEGERS, -1, 0.5, 1e18, -1e20, 1e38, 1e39, 1e-40, owner[key] + 1, -owner[key]))
    else:
        owner[key] = random.choice((None, True, -1, 2**70, 1e300, "", "x", "1", [], {}, [1, 2], {"x": 1}, *values))


def damaged_glb(data: bytes, random: Random) -> bytes:
    """The JSON or the binary chunk changes; lengths are right."""
    try:
        (length,) = struct.unpack_from("<I", data, 12)
        text, binary = data[20 : 20 + length], data[28 + length :]
    except struct.error:
        return damaged_bytes(data, random)
    if random.random() < 0.7:
        text = damaged_json(text, random)
    else:
        binary = damaged_bytes(binary, random)
    return glb(text, binary)


def glb(text: bytes, binary: bytes) -> bytes:
    """A GLB file of two chunks."""
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def damaged_png(data: bytes, random: Random) -> bytes:
    """The content of one chunk changes, or chunks move; checksums are right. Pixels change as they are before packing."""
    chunks: list[tuple[bytes, bytes]] = []
    place = 8
    while place + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, place)
        chunks.append((kind, data[place + 8 : place + 8 + length]))
        place += 12 + length
    if not chunks:
        return damaged_bytes(data, random)
    index = random.randrange(len(chunks))
    kind, content = chunks[index]
    how = random.randrange(4)
    if how == 0:
        chunks.insert(random.randrange(len(chunks) + 1), chunks.pop(index))
    elif kind in (b"IDAT", b"iTXt") and how < 3:
        start = content.rfind(b"\0") + 1 if kind == b"iTXt" else 0
        try:
            plain = zlib.decompress(content[start:])
        except zlib.error:
            plain = content[start:]
        plain = (damaged_json if kind == b"iTXt" else damaged_bytes)(plain, random)
        chunks[index] = kind, content[:start] + zlib.compress(plain)
    else:
        chunks[index] = kind, damaged_bytes(content, random)
    packed = [
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body)) for name, body in chunks
    ]
    return data[:8] + b"".join(packed)


def damaged_archive(data: bytes, random: Random) -> bytes:
    """An array of an .npz archive, or its header, changes; the archive is whole."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            arrays = dict(archive)
    except Exception:  # What was damaged before is no archive any more.
        return damaged_bytes(data, random)
    if not arrays:
        return damaged_bytes(data, random)
    name = "header" if "header" in arrays and random.random() < 0.5 else random.choice(list(arrays))
    try:
        arrays[name] = _damaged_array(arrays[name], random)
        file = io.BytesIO()
        np.savez(file, **arrays)
    except Exception:  # Some arrays cannot be written.
        return damaged_bytes(data, random)
    return file.getvalue()


def _damaged_array(array: np.ndarray, random: Random) -> np.ndarray:
    if array.dtype.kind == "U" and array.ndim == 0:
        return np.array(damaged_json(str(array).encode(), random).decode("utf-8", "replace"))
    kind = random.randrange(5)
    if kind == 0:
        return array[: random.randrange(len(array) + 1)] if array.ndim else array.reshape(1)
    if kind == 1:
        return array.astype(random.choice(["f4", "f8", "i4", "u1", "i8", "U5", "?"]))
    if kind == 2:
        return array.reshape(-1) if array.ndim > 1 else array[None]
    if kind == 3:
        return np.concatenate([array, array]) if array.ndim else array
    changed = array.copy().reshape(-1)
    if changed.size:
        values = FLOATS if array.dtype.kind == "f" else (*INTEGERS[:8], -1)
        with np.errstate(all="ignore"):
            value = np.array(random.choice(values)).astype(array.dtype)
        changed[random.randrange(changed.size)] = value
    return changed.reshape(array.shape)


BY_SUFFIX: dict[str, Damage] = {
    ".gltf": damaged_json,
    ".glb": damaged_glb,
    ".json": damaged_json,
    ".obj": damaged_text,
    ".mtl": damaged_text,
    ".xml": damaged_text,
    ".txt": damaged_text,
    ".png": damaged_png,
    ".npz": damaged_archive,
}
"""By suffix; the others are damaged as bytes."""
