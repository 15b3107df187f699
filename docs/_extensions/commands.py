# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The reference of the command line: one page for each command, `reference/commands/eclat-render.rst`, from the calls by
which the command writes its `--help`. The pages are written at each build.

Sections that several commands share word for word, such as the options of methods, stand on a page of their own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click
from sphinx.application import Sphinx

from eclat.cli import group
from project_pages import write_if_changed

SHARED = "methods"
"""The name of the page of shared sections."""


def escaped(text: str) -> str:
    """Help as reStructuredText: what stands in backquotes is code, and nothing else is markup."""
    pieces = text.split("`")
    pieces[::2] = [re.sub(r"([*|\\]|_(?!\w))", r"\\\1", piece) for piece in pieces[::2]]
    return "`".join(pieces)


class Pages(click.HelpFormatter):
    """Writes reStructuredText where click's own formatter writes lines for a terminal."""

    def __init__(self, program: str, shared: dict[str, str]) -> None:
        super().__init__(width=10**6)
        self.program = program
        self.shared = shared
        self.heading = ""

    def write_usage(self, prog: str, args: str = "", prefix: str | None = None) -> None:
        self.write(f"\n.. code-block:: text\n\n    {prog} {args}\n\n")

    def write_paragraph(self) -> None:
        self.write("\n")

    def write_text(self, text: str) -> None:
        for paragraph in re.split(r"\n\s*\n", text.strip()):
            lines = paragraph.strip().splitlines()
            if lines[0].strip() == "\b":
                self.write("\n.. code-block:: text\n\n" + "".join(f"    {line.strip()}\n" for line in lines[1:]))
            else:
                self.write("\n" + escaped(" ".join(line.strip() for line in lines)) + "\n")

    def write(self, string: str) -> None:
        if self.heading == "Examples" and string.startswith(" "):
            string = f"\n.. code-block:: sh\n\n    {string.strip()}\n"
        super().write(string)

    @contextmanager
    def section(self, name: str) -> Iterator[None]:
        self.heading = name
        self.write(f"\n{name}\n{'-' * len(name)}\n")
        yield
        self.heading = ""

    def write_dl(self, rows: Iterable[tuple[str, str]], col_max: int = 30, col_spacing: int = 2) -> None:
        rows = list(rows)
        if self.heading == "Commands":
            text = "".join(f"\n:doc:`eclat-{name}`\n    {escaped(meaning)}\n" for name, meaning in rows)
        elif all(term.startswith("-") for term, _ in rows):
            text = "".join(of_option(term, meaning) for term, meaning in rows)
        else:
            text = "".join(f"\n``{term}``\n    {escaped(meaning)}\n" for term, meaning in rows)
            place = ".. _command-" + re.sub(r"\W+", "-", self.heading.lower()).strip("-") + ":"
            title = f"\n{place}\n\n{self.heading}\n{'-' * len(self.heading)}\n"
            if self.shared.setdefault(self.heading, title + text) == title + text:
                text = f"\nSee :ref:`{self.heading} <{place[4:-1]}>`.\n"
        self.write(text + "\n")


def of_option(term: str, meaning: str) -> str:
    """One option with an anchor of its own. In `--denoise / --no-denoise`, both names are known to the search."""
    names = re.sub(r"\s*/\s*", ", ", term)
    return f"\n.. option:: {names}\n\n    {escaped(meaning)}\n"


def page_of(command: click.Command, path: str, shared: dict[str, str], parent: click.Context | None = None) -> str:
    """Return the page of a command, from what it would print for `--help`."""
    context = click.Context(command, info_name=path.split(" ")[-1], parent=parent)
    formatter = Pages(path, shared)
    command.format_help(context, formatter)
    return f"{path}\n{'=' * len(path)}\n\n.. program:: {path}\n{formatter.getvalue()}"


def write_pages(app: Sphinx) -> None:
    folder = Path(app.srcdir) / "reference/commands"
    shared: dict[str, str] = {}
    top = click.Context(group, info_name="eclat")
    pages = {"index": page_of(group, "eclat", shared)}
    for name in group.list_commands(top):
        command = group.get_command(top, name)
        assert command is not None
        pages[f"eclat-{name}"] = page_of(command, f"eclat {name}", shared, top)
    pages[SHARED] = (
        "Methods and their options\n=========================\n\n"
        "All commands that compute light offer the same methods. ``--method NAME`` chooses one, and\n"
        "``--set NAME=VALUE`` sets one of its options.\n" + "".join(shared.values())
    )
    commands = "\n".join(f"    {name}" for name in pages if name != "index")
    pages["index"] += f"\n.. toctree::\n    :hidden:\n\n{commands}\n"
    for stale in set(folder.glob("*.rst")) - {folder / f"{name}.rst" for name in pages}:
        stale.unlink()
    for name, text in pages.items():
        write_if_changed(folder / f"{name}.rst", text)


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
