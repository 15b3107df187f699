# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Docstrings become reStructuredText: headings such as `Parameters` become rubrics, and their entries, `name : meaning`
or `name` with the meaning indented below, become lists of definitions."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from sphinx.application import Sphinx

SECTIONS = ("Parameters", "Attributes", "Returns", "Yields", "Raises", "Warns", "Notes", "Examples", "References")
OF_ENTRIES = ("Parameters", "Attributes", "Raises", "Warns")
COLUMNS = re.compile(r"\S {3,}\S")
ENTRY = re.compile(r"^(\*{0,2}[\w.]+(?:, \*{0,2}[\w.]+)*)(?: : (.*))?$")


def rewritten(lines: list[str]) -> list[str]:
    """Return the docstring as reStructuredText."""
    out: list[str] = []
    for heading, body in sections(list(with_tables(lines))):
        if heading:
            out += ["", f".. rubric:: {heading}", ""]
        out += list(definitions(body)) if heading in OF_ENTRIES else body
    return [without_bars(line) for line in out]


def without_bars(line: str) -> str:
    """Escape the bars of absolute values, outside of code."""
    if line.lstrip().startswith((">>>", "...")):
        return line
    pieces = line.split("`")
    pieces[::2] = [piece.replace("|", r"\|") for piece in pieces[::2]]
    return "`".join(pieces)


def with_tables(lines: list[str]) -> Iterator[str]:
    """Keep the columns of paragraphs whose lines have columns, such as lists of symbols."""
    paragraph: list[str] = []
    for line in [*lines, ""]:
        if line.strip():
            paragraph.append(line)
            continue
        columns = sum(bool(COLUMNS.search(row)) for row in paragraph)
        if columns > len(paragraph) / 2 and not any(set(row) <= {"=", " "} for row in paragraph):
            paragraph = ["::", "", *("    " + row for row in paragraph)]
        yield from [*paragraph, line]
        paragraph = []


def sections(lines: list[str]) -> Iterator[tuple[str, list[str]]]:
    """Split a docstring at its headings; what stands before the first has the heading ""."""
    heading, body, i = "", [], 0
    while i < len(lines):
        underlined = i + 1 < len(lines) and set(lines[i + 1].strip()) == {"-"}
        if underlined and lines[i].strip() in SECTIONS:
            yield heading, body
            heading, body = lines[i].strip(), []
            i += 2
        else:
            body.append(lines[i])
            i += 1
    yield heading, body


def definitions(lines: list[str]) -> Iterator[str]:
    """Turn entries into definitions; the names are set as code."""
    for line in lines:
        match = ENTRY.match(line)
        if match is None:
            yield line
            continue
        names, meaning = match.groups()
        yield ""
        yield ", ".join(f"``{name}``" for name in names.split(", "))
        if meaning:
            yield "    " + meaning


def process(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    lines[:] = rewritten(lines)


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("autodoc-process-docstring", process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
