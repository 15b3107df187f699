# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Reads XML text into a tree of elements that know their lines. Entities and document types are refused."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from eclat.errors import EclatError
from eclat.loaders.files import read_bytes
from eclat.loaders.mitsuba.node import MAX_DEPTH

_MAX_BYTES = 1 << 28
_CHUNK = 1 << 16


@dataclass(eq=False)
class Element:
    """An XML element: `where` is file, line and tag."""

    tag: str
    attributes: dict[str, str]
    where: str
    children: list[Element] = field(default_factory=list)


class _Builder:
    """Expat's handlers; the tree grows in `root`."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.root: Element | None = None
        self.stack: list[Element] = []
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.StartDoctypeDeclHandler = self.refuse
        self.parser.EntityDeclHandler = self.refuse

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        where = f"{self.name}:{self.parser.CurrentLineNumber} <{tag}{_label(attributes)}>"
        if len(self.stack) >= MAX_DEPTH:
            raise EclatError(f"{where}: elements are nested more than {MAX_DEPTH} deep")
        element = Element(tag, attributes, where)
        if self.stack:
            self.stack[-1].children.append(element)
        else:
            self.root = element
        self.stack.append(element)

    def end(self, tag: str) -> None:
        self.stack.pop()

    def refuse(self, *_: object) -> NoReturn:
        line = self.parser.CurrentLineNumber
        raise EclatError(f"{self.name}:{line}: document types and entities are not allowed in scene files")


def read_elements(path: Path, where: str) -> Element:
    """The root element of an XML file.

    Raises
    ------
    EclatError : unreadable or malformed files, document types, deep nesting; `where` says who asked for the file.
    """
    return parse_elements(read_bytes(path, where=where, limit=_MAX_BYTES), path.name)


def parse_elements(data: bytes, name: str) -> Element:
    """As `read_elements`, from the bytes of the file called `name`."""
    builder = _Builder(name)
    try:
        for begin in range(0, len(data), _CHUNK):
            builder.parser.Parse(data[begin : begin + _CHUNK], False)
        builder.parser.Parse(b"", True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code) or "unknown error"
        raise EclatError(f"{name}:{error.lineno}: expected well-formed XML, but: {reason}") from None
    except EclatError:
        raise
    except (ValueError, LookupError) as error:  # encodings that Python does not know or expat cannot use
        raise EclatError(f"{name}: expected XML in a usual encoding, got: {error}") from None
    if builder.root is None:
        raise EclatError(f"{name}: expected an XML element, got an empty file")
    return builder.root


def _label(attributes: dict[str, str]) -> str:
    """The attributes that tell elements apart, for messages."""
    shown = ((key, attributes[key]) for key in ("type", "id", "name") if key in attributes)
    return "".join(f' {key}="{value[:60]}"' for key, value in shown)
