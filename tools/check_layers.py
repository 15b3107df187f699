#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Includes and imports follow the order of tools/layers.toml, and no modules import each other in a circle.

Prints each that does not and exits with 1.
"""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "python/eclat"
COMPILED = ("_core", "_processor")
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


def module_name(path: Path) -> str:
    """The dotted name below eclat of a source file; '' is the front door."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported_modules(tree: ast.AST, modules: set[str]) -> Iterator[tuple[int, str]]:
    """Line and dotted name below eclat of each import of the package, at whatever depth it stands."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.split(".")[0] == "eclat":
                    yield node.lineno, alias.name.partition(".")[2]
        elif isinstance(node, ast.ImportFrom):
            if node.level:
                yield node.lineno, "?"
            elif node.module and node.module.split(".")[0] == "eclat":
                base = node.module.partition(".")[2]
                for alias in node.names:
                    inner = f"{base}.{alias.name}".strip(".")
                    yield node.lineno, inner if inner in modules else base


def rank_of(module: str, rank: dict[str, int]) -> int | None:
    """The layer of a module: its own entry, or that of the nearest room around it."""
    while module not in rank and "." in module:
        module = module.rpartition(".")[0]
    return rank.get(module)


def check_imports(layers: list[list[str]], front_door_after: str) -> Iterator[str]:
    rank = {module: i for i, layer in enumerate(layers) for module in layer}
    rank[""] = rank[front_door_after]
    paths = {module_name(path): path for path in sources("python/eclat", suffixes=(".py",))}
    graph: dict[str, set[str]] = {}
    for module, path in paths.items():
        if not module:
            continue
        name, own = path.relative_to(ROOT).as_posix(), rank_of(module, rank)
        if own is None:
            yield f"{name}: module {module!r} has no place in tools/layers.toml"
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"), filename=name)
        graph[module] = set()
        for line, target in imported_modules(tree, {*paths, *COMPILED}):
            theirs = rank_of(target, rank)
            if target == "?":
                yield f"{name}:{line}: relative import; write the module's full name"
            elif theirs is None:
                yield f"{name}:{line}: eclat.{target} has no place in tools/layers.toml"
            elif theirs > own:
                yield f"{name}:{line}: {module} may not import {target or 'eclat'}, which is a later layer"
            else:
                graph[module].add(target)
    for circle in circles(graph):
        yield f"python/eclat: these modules import each other in a circle: {' → '.join((*circle, circle[0]))}"


def circles(graph: dict[str, set[str]]) -> list[list[str]]:
    """Circles of modules, by depth-first search: one for each module that closes any."""
    found: list[list[str]] = []
    done: set[str] = set()

    def visit(module: str, way: list[str]) -> None:
        if module in way:
            found.append(way[way.index(module) :])
        elif module not in done:
            for target in sorted(graph.get(module, ())):
                visit(target, [*way, module])
            done.add(module)

    for module in sorted(graph):
        visit(module, [])
    return found


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
