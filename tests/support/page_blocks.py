# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The code blocks of a Markdown page, and a way to run them all in one folder, in the order in which they stand.

A block that cannot run has a paragraph right above it, which readers see: `*Not run by the tests: REASON.*`.

`PYTHONPATH=python:tests .venv/bin/python -m support.page_blocks PAGE FOLDER` runs a page as it is written, in a folder that
it makes; the tests run the same blocks with small pictures and few samples (`support.small_work`).
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import eclat

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = ("sh", "python", "js", "html", "xml", "cpp")
"""Languages of blocks that someone might run; others, such as `text`, `json` and `math`, show something."""

FENCE = re.compile(
    r"^(?P<indent> *)(?P<mark>`{3,})(?P<language>\w*)[^\n]*\n(?P<code>.*?)^(?P=indent)(?P=mark) *$", re.M | re.S
)
MARK = re.compile(r"\*Not run by the tests: (?P<reason>[^*]+?)\.?\*\s*\Z")


@dataclass(frozen=True)
class Block:
    """A block of code on a page."""

    page: Path
    line: int
    language: str
    code: str
    reason: str
    """Why it cannot run; empty if it can."""

    @property
    def where(self) -> str:
        return f"{self.page.relative_to(ROOT).as_posix()}:{self.line}"


def blocks_of(page: Path) -> list[Block]:
    """Return the blocks of a page that are programs."""
    text = page.read_text(encoding="utf-8")
    blocks = []
    for fence in FENCE.finditer(text):
        if fence["language"] not in PROGRAMS:
            continue
        mark = MARK.search(text[: fence.start()])
        indent = len(fence["indent"])
        code = "".join(line[indent:] for line in fence["code"].splitlines(keepends=True))
        line = text.count("\n", 0, fence.start()) + 1
        blocks.append(Block(page, line, fence["language"], code, " ".join(mark["reason"].split()) if mark else ""))
    return blocks


def run_block(block: Block, names: dict[str, Any], commands: Path) -> None:
    """Run a block in the current folder.

    Parameters
    ----------
    names : the variables of the page's Python, which blocks share.
    commands : a folder with the command `eclat`, before all others.

    Raises
    ------
    AssertionError : a command failed, with what it printed.
    """
    if block.language == "python":
        exec(compile(block.code, block.where, "exec"), names)
        return
    assert block.language == "sh", (
        f"{block.where}: no way to run a block of {block.language!r}; mark it with the reason"
    )
    environment = {**os.environ, "PATH": f"{commands}{os.pathsep}{os.environ['PATH']}"}
    # A page in which any command fails is wrong, also if a later command succeeds.
    done = subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", block.code],
        env=environment,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, f"{block.where}: exit code {done.returncode}\n{done.stdout}{done.stderr}"


def write_command(folder: Path, module: str) -> None:
    """Write the command `eclat` into a folder; it runs a module of the package or of the tests by this interpreter."""
    folder.mkdir(parents=True, exist_ok=True)
    # The package that this process uses, whether it is installed or lies beside the tests.
    package = Path(eclat.__file__).resolve().parent.parent
    path = os.pathsep.join([str(ROOT / "tests"), str(package)])
    script = folder / "eclat"
    script.write_text(f'#!/bin/sh\nPYTHONPATH="{path}" exec "{sys.executable}" -m {module} "$@"\n', encoding="utf-8")
    script.chmod(0o755)


def main(page: Path, folder: Path) -> None:
    """Run a page as it is written."""
    commands = folder.resolve() / "commands"
    write_command(commands, "eclat")
    os.chdir(folder)
    names: dict[str, Any] = {"__name__": "__page__"}
    for block in blocks_of(page):
        if not block.reason:
            print(f"{block.where}:\n{block.code}", flush=True)
            run_block(block, names, commands)


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]))
