# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The manual page eclat(1), made from the same tables as `--help`. tools/make_manpage.py writes it to docs/eclat.1."""

from __future__ import annotations

import re

import click

import eclat
from eclat.cli.command import Command, Group, Option
from eclat.instruction_set import VARIABLE


def manpage(group: Group) -> str:
    """The manual page of all commands in the language of man(7)."""
    context = click.Context(group, info_name="eclat", **group.context_settings)
    lines = [
        ".\\" + '" Written by tools/make_manpage.py from the help of the commands: not edited by hand.',
        f'.TH ECLAT 1 "" "eclat {eclat.__version__}" "User Commands"',
        ".SH NAME",
        "eclat \\- render global illumination",
        ".SH SYNOPSIS",
        ".B eclat",
        ".I COMMAND",
        "[\\fIARGUMENTS\\fR]",
        ".SH DESCRIPTION",
        *_text(group.help or ""),
        ".SH OPTIONS",
        *_records([p.get_help_record(context) for p in group.get_params(context)]),
    ]
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        assert isinstance(command, Command)
        lines += _command(command, context)
    lines += [
        ".SH EXIT STATUS",
        *_records([(str(code), meaning) for code, meaning in group.exit_codes.items()]),
        ".SH ENVIRONMENT",
        *_records([(VARIABLE, "The instruction set that Éclat and Embree use, where --isa is not given.")]),
    ]
    return "\n".join(lines) + "\n"


def _command(command: Command, parent: click.Context) -> list[str]:
    context = click.Context(command, info_name=command.name, parent=parent)
    usage = " ".join(command.collect_usage_pieces(context))
    lines = [f".SH ECLAT {_escaped((command.name or '').upper())}", ".B eclat " + (command.name or "")]
    lines += [_escaped(usage), ".PP", *_text(command.help or "")]
    for line, meaning in command.examples.items():
        lines += [".PP", _escaped(meaning), ".PP", ".RS 4", ".nf", f"\\fB{_escaped(line)}\\fR", ".fi", ".RE"]
    sections: dict[str, list[tuple[str, str] | None]] = {}
    for parameter in command.get_params(context):
        if not isinstance(parameter, click.Argument):
            section = parameter.section if isinstance(parameter, Option) else "Other"
            sections.setdefault(section, []).append(parameter.get_help_record(context))
    sections["Other"] = sections.pop("Other", [])
    for name, records in (command.notes() if command.notes else {}).items():
        sections[name] = list(records)
    for name, shown in sections.items():
        if any(shown):
            lines += [f".SS {_escaped(name)}", *_records(shown)]
    return lines


def _records(records: list[tuple[str, str] | None]) -> list[str]:
    lines = []
    for term, meaning in filter(None, records):
        lines += [".TP", f"\\fB{_escaped(term)}\\fR", _escaped(meaning)]
    return lines


def _text(text: str) -> list[str]:
    """Paragraphs of a help text; those that begin with the mark \\b keep their lines."""
    lines: list[str] = []
    for paragraph in re.split(r"\n\s*\n", text.strip()):
        rows = [row.strip() for row in paragraph.splitlines()]
        kept = rows[0] == "\b"
        body = [_escaped(row) for row in rows if row != "\b"]
        lines += [".PP", ".nf", *body, ".fi"] if kept else [".PP", " ".join(body)]
    return lines


def _escaped(text: str) -> str:
    """Escape what roff would interpret; a hyphen becomes one that can be copied into a shell."""
    escaped = text.replace("\\", "\\e").replace("-", "\\-").replace("…", "...")
    return "\\&" + escaped if escaped.startswith((".", "'")) else escaped
