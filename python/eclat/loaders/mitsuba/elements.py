# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Parse XML to a tree of elements with their line numbers. Entities and document types are refused."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from eclat.errors import EclatError
from eclat.loaders.files import read_bytes
from eclat.loaders.mitsuba.node import MAX_DEPTH

_MAX_BYTES = 1 << 28
"""The largest size of an XML file, in bytes."""
_CHUNK = 1 << 16
"""The number of bytes that are parsed at once."""


@dataclass(eq=False)
class Element:
    """An XML element. `where` names its file, line and tag in messages."""

    tag: str
    attributes: dict[str, str]
    where: str
    children: list[Element] = field(default_factory=list)


class _Builder:
    """The handlers of the Expat parser. They build the tree below `root`."""

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
            raise EclatError(f"{where}: expected at most {MAX_DEPTH} levels of nested elements, got more")
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
        raise EclatError(f"{self.name}:{line}: expected no document type and no entities in a scene file; remove them")


def read_elements(path: Path, where: str) -> Element:
    """Parse an XML file and return its root element.

    `where` names the element that refers to the file, for messages.

    Raises
    ------
    EclatError : the file cannot be read, is malformed, contains a document type or entities, or is nested too deeply.
    """
    return parse_elements(read_bytes(path, where=where, limit=_MAX_BYTES), path.name)


def parse_elements(data: bytes, name: str) -> Element:
    """Parse `data`, the bytes of the XML file called `name`. Errors are raised as in `read_elements`."""
    builder = _Builder(name)
    try:
        for begin in range(0, len(data), _CHUNK):
            builder.parser.Parse(data[begin : begin + _CHUNK], False)
        builder.parser.Parse(b"", True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code) or "unknown error"
        raise EclatError(f"{name}:{error.lineno}: expected well-formed XML, got an error: {reason}") from None
    except EclatError:
        raise
    except (ValueError, LookupError) as error:  # encodings that Python does not know or Expat cannot use
        raise EclatError(f"{name}: expected XML in an encoding such as UTF-8, got an error: {error}") from None
    if builder.root is None:
        raise EclatError(f"{name}: expected an XML element, got an empty file")
    return builder.root


def _label(attributes: dict[str, str]) -> str:
    """Return the attributes that identify an element in messages: its type, id and name."""
    shown = ((key, attributes[key]) for key in ("type", "id", "name") if key in attributes)
    return "".join(f' {key}="{value[:60]}"' for key, value in shown)
