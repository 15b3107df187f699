# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Citations such as [Key], [Key eq. 3] and [Key, Other sec. 2] become links to the page of references.

The pages and docstrings hold the bare brackets, so that they are readable without the site; `tools/check_citations.py`
checks them. Brackets in code stay as they are.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from pybtex.plugin import register_plugin
from pybtex.style.formatting.unsrt import Style as UnsortedStyle
from pybtex.style.labels import BaseLabelStyle
from sphinx.application import Sphinx

BIBLIOGRAPHY = Path(__file__).resolve().parent.parent / "references.bib"
ENTRY = re.compile(r"@\w+\{([^,\s]+),")
BRACKET = re.compile(r"(?<![\w\]!])\[([^\[\]]+)\](?![(:])")
FENCE = re.compile(r"(^ *(`{3,}|~{3,}).*?^ *\2 *$)", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"(`+[^`]+`+)")


class KeyLabels(BaseLabelStyle):
    """Labels that are the keys of references.bib."""

    def format_labels(self, sorted_entries: Any) -> Any:
        for entry in sorted_entries:
            yield entry.key


class KeyedStyle(UnsortedStyle):
    """References that are sorted by author and labelled by key."""

    default_label_style = KeyLabels
    default_sorting_style = "author_year_title"


def keys() -> set[str]:
    """Return the keys of references.bib."""
    return set(ENTRY.findall(BIBLIOGRAPHY.read_text(encoding="utf-8")))


def linked(text: str, role: str, known: set[str]) -> str:
    """Replace the citations in a piece of prose; `role` has one `%s` for the key."""

    def of_bracket(match: re.Match[str]) -> str:
        parts = [part.strip() for part in match.group(1).split(",")]
        if parts[0].split(" ")[0] not in known:
            return match.group()
        words = [part.partition(" ") for part in parts]
        shown = [(role % key if key in known else key) + blank + rest for key, blank, rest in words]
        return "[" + ", ".join(shown) + "]"

    return BRACKET.sub(of_bracket, text)


def in_markdown(app: Sphinx, docname: str, source: list[str]) -> None:
    """Link the citations of a page, outside of its code."""
    if app.env.doc2path(docname).suffix != ".md":
        return
    known = keys()
    pieces = FENCE.split(source[0])
    for i in range(0, len(pieces), 3):
        prose = CODE.split(pieces[i])
        prose[::2] = [linked(text, "{cite:label}`%s`", known) for text in prose[::2]]
        pieces[i] = "".join(prose)
    # Each split yields the prose, the fence, and the mark of the fence.
    source[0] = "".join(piece for i, piece in enumerate(pieces) if i % 3 != 2)


def in_docstring(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Link the citations of a docstring."""
    known = keys()
    lines[:] = [linked(line, r"\ :cite:label:`%s`\ ", known) for line in lines]


def setup(app: Sphinx) -> dict[str, bool]:
    register_plugin("pybtex.style.formatting", "keyed", KeyedStyle)
    app.connect("source-read", in_markdown)
    app.connect("autodoc-process-docstring", in_docstring)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
