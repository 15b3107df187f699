#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Citations and docs/references.bib agree in both directions, and files that comments and pages name exist.

A citation stands in a comment, a docstring or a page as [Key], [Key eq. 3], [Key sec. 2.1] or [Key, Other]. Prints
each citation without an entry, each entry without a citation, each malformed entry, each name of a file that is not
there; exits with 1 if there is any.
"""

from __future__ import annotations

import io
import re
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ("core", "bindings", "python", "tests", "tools", "examples", "benchmarks", "docs")
BIBLIOGRAPHY = ROOT / "docs/references.bib"

KEY = re.compile(r"[A-Z][A-Za-z]+\d+[\w-]*")
# Not an index (a[Key]) and not a Markdown link ([Key](…)).
BRACKET = re.compile(r"(?<![\w\])])\[([^\[\]]+)\](?!\()")
ENTRY = re.compile(r"@(\w+)\{([^,\s]+),")
CPP_TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.DOTALL)
NAMED_FILE = re.compile(rf"\b(?:{'|'.join(FOLDERS)})/[\w/.-]+\.(?:h|cpp|py|md|toml|bib|csv)\b")


def cpp_comments(text: str) -> Iterator[tuple[int, str]]:
    for match in CPP_TOKEN.finditer(text):
        if match.group().startswith("/"):
            yield text.count("\n", 0, match.start()) + 1, match.group()


def python_comments(text: str) -> Iterator[tuple[int, str]]:
    """Comments and strings that stand alone on their line: docstrings."""
    previous = tokenize.NEWLINE
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        alone = previous in (tokenize.NEWLINE, tokenize.NL, tokenize.INDENT, tokenize.DEDENT)
        if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and alone):
            yield token.start[0], token.string
        if token.type != tokenize.COMMENT:
            previous = token.type


def texts() -> Iterator[tuple[Path, int, str]]:
    """File, first line and text of everything that is prose: comments, docstrings, pages."""
    pages = list(ROOT.glob("*.md"))
    for path in [*pages, *(p for folder in FOLDERS for p in sorted((ROOT / folder).rglob("*")))]:
        if path.suffix not in (".h", ".cpp", ".py", ".md"):
            continue
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".md":
            yield path, 1, text
        else:
            for line, comment in python_comments(text) if path.suffix == ".py" else cpp_comments(text):
                yield path, line, comment


def citations(text: str, entries: set[str]) -> Iterator[tuple[int, str]]:
    """Offset and key of each citation. In [Key eq. 3, 4] what follows the comma is no key."""
    for match in BRACKET.finditer(text):
        for part in match.group(1).split(","):
            word = part.strip().split(" ")[0]
            if word in entries or KEY.fullmatch(word):
                yield match.start(), word


def entries_of(bibliography: str, problems: list[str]) -> set[str]:
    found: set[str] = set()
    starts = list(ENTRY.finditer(bibliography))
    for match, following in zip(starts, [*starts[1:], None], strict=True):
        key = match.group(2)
        body = bibliography[match.start() : following.start() if following else None]
        where = f"docs/references.bib:{bibliography.count(chr(10), 0, match.start()) + 1}"
        if key in found:
            problems.append(f"{where}: {key} stands there twice")
        if body.count("{") != body.count("}"):
            problems.append(f"{where}: the braces of {key} do not match")
        for field in ("author", "title", "year"):
            if not re.search(rf"^\s*{field}\s*=", body, re.MULTILINE):
                problems.append(f"{where}: {key} has no {field}")
        found.add(key)
    return found


def main() -> int:
    problems: list[str] = []
    entries = entries_of(BIBLIOGRAPHY.read_text(encoding="utf-8"), problems)
    cited: set[str] = set()
    for path, first_line, text in texts():
        name = path.relative_to(ROOT).as_posix()
        for offset, key in citations(text, entries):
            cited.add(key)
            if key not in entries:
                line = first_line + text.count("\n", 0, offset)
                problems.append(f"{name}:{line}: [{key}] has no entry in docs/references.bib")
        for match in NAMED_FILE.finditer(text):
            if not (ROOT / match.group()).exists():
                line = first_line + text.count("\n", 0, match.start())
                problems.append(f"{name}:{line}: {match.group()} does not exist")
    problems += [f"docs/references.bib: nothing cites {key}" for key in sorted(entries - cited)]
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
