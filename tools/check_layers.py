#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Includes and imports follow the order of tools/layers.toml; prints each that does not and exits with 1."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]', re.MULTILINE)


def sources(*folders: str, suffixes: tuple[str, ...]) -> Iterator[Path]:
    for folder in folders:
        yield from (p for p in sorted((ROOT / folder).rglob("*")) if p.suffix in suffixes)


def line_of(text: str, position: int) -> int:
    return text.count("\n", 0, position) + 1


def check_includes(layers: list[str], only: dict[str, list[str]]) -> Iterator[str]:
    rank = {layer: i for i, layer in enumerate(layers)}
    for path in sources("core", "bindings", suffixes=(".h", ".cpp")):
        name = path.relative_to(ROOT).as_posix()
        in_core = name.startswith("core/")
        layer = path.parent.relative_to(ROOT / "core").as_posix() if in_core else ""
        if in_core and layer not in rank:
            yield f"{name}: folder {layer!r} has no place in tools/layers.toml"
            continue
        text = path.read_text(encoding="utf-8")
        for match in INCLUDE.finditer(text):
            quote, included = match.groups()
            where = f"{name}:{line_of(text, match.start())}"
            for prefix, files in only.items():
                if included.startswith(prefix) and not any(fnmatch(name, pattern) for pattern in files):
                    yield f"{where}: {included} may be included by these only: {', '.join(files) or 'none'}"
            if quote == "<" or not in_core:
                continue
            target = included.rpartition("/")[0]
            if target not in rank:
                yield f'{where}: "{included}" is not a header of the core named from core/'
            elif rank[target] > rank[layer]:
                yield f"{where}: {layer} may not use {target}, which is a later layer"


def imported_modules(tree: ast.AST, modules: set[str]) -> Iterator[tuple[int, str]]:
    """Line and dotted name below eclat of each import of the package; '' is the front door."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.split(".")[0] == "eclat":
                    yield node.lineno, alias.name.partition(".")[2]
        elif isinstance(node, ast.ImportFrom):
            if node.level:
                yield node.lineno, "?"
            elif node.module == "eclat":
                for alias in node.names:
                    yield node.lineno, alias.name if alias.name in modules else ""
            elif node.module and node.module.startswith("eclat."):
                yield node.lineno, node.module.partition(".")[2]


def check_imports(layers: list[list[str]], front_door_after: str) -> Iterator[str]:
    rank = {module: i for i, layer in enumerate(layers) for module in layer}
    rank[""] = rank[front_door_after]
    package = ROOT / "python/eclat"
    for path in sources("python/eclat", suffixes=(".py",)):
        name = path.relative_to(ROOT).as_posix()
        if path == package / "__init__.py":
            continue
        module = path.relative_to(package).with_suffix("").parts[0]
        if module not in rank:
            yield f"{name}: module {module!r} has no place in tools/layers.toml"
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"), filename=name)
        for line, target in imported_modules(tree, set(rank)):
            top = target.split(".")[0]
            if target == "?":
                yield f"{name}:{line}: relative import; write the module's full name"
            elif top not in rank:
                yield f"{name}:{line}: eclat.{target} has no place in tools/layers.toml"
            elif rank[top] > rank[module]:
                yield f"{name}:{line}: {module} may not import {top or 'eclat'}, which is a later layer"


def diagrams(order: dict[str, dict[str, list[str]]]) -> Iterator[str]:
    yield " → ".join(order["core"]["layers"])
    yield " → ".join(", ".join(layer) for layer in order["python"]["layers"])


def main() -> int:
    order = tomllib.loads((ROOT / "tools/layers.toml").read_text(encoding="utf-8"))
    problems = [
        *check_includes(order["core"]["layers"], order["core"]["only"]),
        *check_imports(order["python"]["layers"], order["python"]["front_door_after"]),
    ]
    page = " ".join((ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8").split())
    problems += [f"ARCHITECTURE.md: does not show the order {line!r}" for line in diagrams(order) if line not in page]
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
