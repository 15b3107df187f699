#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Functions stay short: at most 60 lines without their docstring, and helpers take at most eight parameters.

It reads Python by its syntax tree, and C++ by the indentation that clang-format gives it: a function's body begins at a
line that ends in an opening brace and follows a parameter list, and ends at the closing brace of the same indentation.
The public verbs of `eclat`, options and commands may take more parameters: those stand in `MANY_PARAMETERS`.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MOST_LINES, MOST_PARAMETERS = 60, 8

MANY_PARAMETERS = (
    "python/eclat/verbs/*",
    "python/eclat/viewer/showing.py",
    "python/eclat/cli/*",
    "python/eclat/brdf_table.py",
    "tests/*",
    "benchmarks/*",
)
"""Files whose functions are what users call by keyword, or that fill in such calls."""

CPP_NO_FUNCTION = re.compile(
    r"^\s*(?:if|else|for|while|switch|do|try|catch|namespace|struct|class|enum|union|public:|return)\b"
)


def python_functions(path: Path) -> Iterator[tuple[str, int, int, int]]:
    """Name, line, lines without the docstring, and positional or keyword parameters without self."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        lines = (node.end_lineno or node.lineno) - node.lineno + 1
        first = node.body[0]
        if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str):
            lines -= (first.end_lineno or first.lineno) - first.lineno + 1
        arguments = [a.arg for a in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)]
        yield node.name, node.lineno, lines, len([a for a in arguments if a not in ("self", "cls")])


def cpp_functions(path: Path) -> Iterator[tuple[str, int, int, int]]:
    """The same for functions, methods and lambdas that have a body of their own lines."""
    lines = path.read_text(encoding="utf-8").splitlines()
    for start, line in enumerate(lines):
        if not line.endswith("{") or CPP_NO_FUNCTION.match(line) or "(" not in statement(lines, start):
            continue
        head = statement(lines, start)
        if CPP_NO_FUNCTION.match(head):
            continue
        indent = len(head_line(lines, start)) - len(head_line(lines, start).lstrip())
        end = next(
            (i for i in range(start + 1, len(lines)) if re.match(rf" {{{indent}}}\}}", lines[i])), len(lines) - 1
        )
        yield name_of(head), start + 1, end - start + 1, parameters_of(head)


def first_line(lines: list[str], end: int) -> int:
    """Where the statement that ends at line `end` begins: its brackets are balanced from there on."""
    start, depth = end, 0
    while True:
        depth += sum(lines[start].count(c) for c in ")]") - sum(lines[start].count(c) for c in "([")
        if depth <= 0 or start == 0:
            return start
        start -= 1


def head_start(lines: list[str], end: int) -> int:
    """The same for a function's head, of which a constructor's list of initialisers is a part."""
    start = at = first_line(lines, end)
    while at > 0 and lines[at - 1].endswith(",") and not lines[at].lstrip().startswith(":"):
        at = first_line(lines, at - 1)
    return first_line(lines, at - 1) if lines[at].lstrip().startswith(": ") else start


def head_line(lines: list[str], end: int) -> str:
    return lines[head_start(lines, end)]


def statement(lines: list[str], end: int) -> str:
    return " ".join(line.strip() for line in lines[head_start(lines, end) : end + 1])


def name_of(head: str) -> str:
    found = re.search(r"([\w:~]+)\s*\(", head)
    return found.group(1) if found else head[:40]


def parameters_of(head: str) -> int:
    """Parameters of the first parenthesised list that does not belong to a call inside a lambda's head."""
    start = head.find("(")
    depth = count = 0
    for i in range(start, len(head)):
        depth += head[i] in "([{<" and head[i - 1 : i + 1] != "<<"
        depth -= head[i] in ")]}>" and head[i - 1 : i + 1] != "->"
        count += head[i] == "," and depth == 1
        if depth == 0:
            return count + 1 if head[start + 1 : i].strip() else 0
    return 0


def main() -> int:
    problems = []
    for folder, suffixes, functions in (
        ("blender", (".py",), python_functions),
        ("python", (".py",), python_functions),
        ("tools", (".py",), python_functions),
        ("core", (".h", ".cpp"), cpp_functions),
        ("bindings", (".h", ".cpp"), cpp_functions),
    ):
        for path in sorted(p for p in (ROOT / folder).rglob("*") if p.suffix in suffixes):
            name = path.relative_to(ROOT).as_posix()
            may_take_many = any(path.relative_to(ROOT).match(pattern) for pattern in MANY_PARAMETERS)
            for function, line, count, parameters in functions(path):
                if count > MOST_LINES:
                    problems.append(f"{name}:{line}: {function} has {count} lines, at most {MOST_LINES}")
                if parameters > MOST_PARAMETERS and not may_take_many:
                    problems.append(
                        f"{name}:{line}: {function} takes {parameters} parameters, at most {MOST_PARAMETERS}"
                    )
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
