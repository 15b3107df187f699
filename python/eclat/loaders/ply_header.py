# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Parse the header of a PLY file: the encoding, the elements, and the number of rows and the properties of each."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from eclat.errors import EclatError
from eclat.loaders.text_files import decoded

Encoding = Literal["ascii", "<", ">"]

TYPES = {
    # PLY's name of each type: NumPy's name, without byte order
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8", "int64": "i8", "uint64": "u8"},
}

_TEXTURE = re.compile(
    r"(?:comment|obj_info)\s+(?:texturefile:?\s+(?P<name>\S.*)|"
    r"texture\w*:?\s+(?P<image>\S.*\.(?:bmp|dds|exr|gif|hdr|jpe?g|jp2|pfm|png|psd|tga|tiff?|webp)[\"']?))\s*",
    re.IGNORECASE,
)
"""A comment that names a texture. After words other than `TextureFile`, such as `texture`, only the name of an image
counts, because the comment may be prose."""
_END = re.compile(rb"(?:\A|[\r\n])[ \t]*end_header[ \t]*(\r\n|\r|\n|\Z)")
_MOST = 1000
"""The largest number of elements in a file, and of properties in an element. Real files have a dozen."""
_LONGEST = 1 << 20
"""The number of bytes in which `end_header` must occur. Real headers have some hundred bytes."""
_ENCODINGS: dict[str, Encoding] = {"ascii": "ascii", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True)
class Property:
    """A property: a number in each row, or a list of numbers if `count_type` is given.

    `type` and `count_type` are NumPy's names of types, without byte order.
    """

    name: str
    type: str
    count_type: str | None = None


@dataclass(frozen=True)
class Element:
    """An element of a PLY file, which consists of `count` rows with the same properties."""

    name: str
    count: int
    properties: tuple[Property, ...]


@dataclass(frozen=True)
class Header:
    """The header of a PLY file.

    `encoding` is "ascii", or NumPy's sign for the byte order of binary data. The data start at byte `size`.
    """

    encoding: Encoding
    elements: tuple[Element, ...]
    size: int
    textures: tuple[str, ...] = ()
    """The image files that comments of the form `comment TextureFile skin.png` or `comment texture skin.png` name.
    MeshLab and others write these."""


def read_header(data: bytes, where: str) -> Header:
    """Parse the header of the PLY file `data`. Raises EclatError, with the line number, if it is invalid."""
    if not re.match(rb"ply[ \t]*[\r\n]", data):
        raise EclatError(f"{where}: expected a PLY file, which starts with 'ply', got {data[:16]!r}")
    end = _END.search(data, 0, _LONGEST)
    if end is None:
        raise EclatError(f"{where}: expected a PLY header that ends with 'end_header', got none")
    encoding: Encoding | None = None
    elements: list[Element] = []
    textures: list[str] = []
    for number, line in enumerate(data[: end.start() + 1].splitlines()[1:], 2):
        words = decoded(line).split()
        place = f"{where}, line {number}"
        match words:
            case [] | ["comment" | "obj_info", *_]:
                if found := _TEXTURE.fullmatch(decoded(line).strip()):
                    textures.append(_unquoted((found["name"] or found["image"]).strip()))
            case ["format", name, *_]:
                if name not in _ENCODINGS:
                    raise EclatError(f"{place}: expected format {', '.join(_ENCODINGS)}, got {name[:40]!r}")
                encoding = _ENCODINGS[name]
            case ["element", name, count]:
                elements.append(Element(name, _count(count, place), ()))
            case ["property", *rest] if elements:
                last = elements[-1]
                if any(p.name == rest[-1] for p in last.properties if rest):
                    raise EclatError(f"{place}: expected different property names, got {rest[-1][:40]!r} twice")
                elements[-1] = Element(last.name, last.count, (*last.properties, _property(rest, place)))
            case _:
                raise EclatError(f"{place}: expected a PLY header statement, got {' '.join(words)[:60]!r}")
        if len(elements) > _MOST or (elements and len(elements[-1].properties) > _MOST):
            raise EclatError(f"{place}: expected at most {_MOST} elements with at most {_MOST} properties, got more")
    if encoding is None:
        raise EclatError(f"{where}: expected a 'format' statement in the PLY header, got none")
    return Header(encoding, tuple(elements), _data_start(data, end), tuple(textures[:_MOST]))


def _data_start(data: bytes, end: re.Match[bytes]) -> int:
    """Return the offset of the first byte after the header.

    In a file whose first line ends with CR alone, the header ends with CR alone too: an LF after it is data.
    """
    if end[1] == b"\r\n" and not re.match(rb"ply[ \t]*\r\n", data) and re.match(rb"ply[ \t]*\r", data):
        return end.start(1) + 1
    return end.end()


def _unquoted(name: str) -> str:
    """Remove the quotation marks that some programs write around the name of a file."""
    return name[1:-1] if len(name) > 2 and name[0] == name[-1] and name[0] in "\"'" else name


def _count(word: str, place: str) -> int:
    # No file has as many rows as a number of nineteen digits, and int() is fast for that many.
    if not re.fullmatch(r"[0-9]{1,19}", word):
        raise EclatError(f"{place}: expected a number of rows, got {word[:40]!r}")
    return int(word)


def _property(words: list[str], place: str) -> Property:
    match words:
        case [kind, name] if kind in TYPES:
            return Property(name, TYPES[kind])
        case ["list", count, kind, name] if TYPES.get(count, "f")[0] in "iu" and kind in TYPES:
            return Property(name, TYPES[kind], TYPES[count])
    raise EclatError(f"{place}: expected the type and the name of a property, got {' '.join(words)[:60]!r}")
