#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Each source file has its test: one of the same name in the same room, or a row in tools/tests.toml that says where or
why not. The rooms of tests/core and tests/python are those of core/ and python/eclat/; what a whole method does may be
tested in tests/methods/ instead.

Prints sources without either, rows that name files which do not exist or that nothing needs any more, and exits with 1
if there are any. Tests known to be missing are printed too, but do not fail.
"""

from __future__ import annotations

import sys
import tomllib
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def sources() -> list[str]:
    core = [p for p in ROOT.glob("core/**/*") if p.suffix in (".h", ".cpp")]
    # A .cpp file is tested with its header.
    core = [p for p in core if p.suffix == ".h" or not p.with_suffix(".h").exists()]
    python = [p for p in ROOT.glob("python/eclat/**/*.py") if "__pycache__" not in p.parts]
    return sorted(p.relative_to(ROOT).as_posix() for p in [*core, *python])


def own_tests(source: str) -> list[str]:
    """The places, relative to the root, where a test of this source may stand."""
    path = Path(source)
    if path.suffix in (".h", ".cpp"):
        return [f"tests/core/{path.relative_to('core').parent}/test_{path.stem}.cpp"]
    # A package's front door is tested under the package's name.
    stem = path.parent.name if path.name == "__init__.py" else path.stem
    room = path.relative_to("python/eclat").parent.as_posix()
    return [f"tests/python/{room}/test_{stem}.py".replace("/./", "/"), f"tests/methods/test_{stem}.py"]


def has_own_test(source: str) -> bool:
    return any((ROOT / test).exists() for test in own_tests(source))


def main() -> int:
    table = tomllib.loads((ROOT / "tools/tests.toml").read_text(encoding="utf-8"))
    found = sources()
    without = [source for source in found if not has_own_test(source)]
    problems, needed = [], set()
    for source in without:
        patterns = [p for section in ("covered", "plain", "missing") for p in table[section] if fnmatch(source, p)]
        needed.update(patterns)
        if not patterns:
            problems.append(f"{source}: no {' or '.join(own_tests(source))}, and no row in tools/tests.toml")
    for section in ("covered", "plain", "missing"):
        for pattern in table[section]:
            if pattern not in needed:
                problems.append(f"tools/tests.toml: {pattern!r} is not needed: no such file, or it has its own test")
    for pattern, tests in table["covered"].items():
        problems += [f"tools/tests.toml: {pattern!r}: {t} does not exist" for t in tests if not (ROOT / t).exists()]
    for source, instead in table["missing"].items():
        print(f"known to be missing: a test of {source} ({instead})")
    for problem in problems:
        print(problem)
    own = len(found) - len(without)
    print(f"{len(found)} sources: {own} with a test of their own, {len(table['missing'])} known to have none")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
