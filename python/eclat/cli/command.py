# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Commands whose help has sections and examples, and whose errors suggest the nearest known name for a misspelt one."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import click
from click.shell_completion import CompletionItem

from eclat.errors import did_you_mean

COMPLETION_VARIABLE = "_ECLAT_COMPLETE"
"""The environment variable by which shells ask for completions."""

F = TypeVar("F", bound=Callable[..., Any])


class Option(click.Option):
    """An option that belongs to a section of the help."""

    def __init__(self, *arguments: Any, section: str = "Other", **keywords: Any) -> None:
        super().__init__(*arguments, **keywords)
        self.section = section


def option(*names: str, section: str, **keywords: Any) -> Callable[[F], F]:
    """Make a `click.option` that the help lists under the heading `section`.

    Shells complete the value as a file or a folder if its name in the help begins with FILE or DIR.
    """
    metavar = str(keywords.get("metavar") or getattr(keywords.get("type"), "name", ""))
    for begin, kind in (("FILE", "file"), ("DIR", "dir")):
        if metavar.startswith(begin):
            keywords.setdefault("shell_complete", completes(kind))
    return click.option(*names, cls=Option, section=section, **keywords)


def completes(kind: str) -> Callable[[click.Context, click.Parameter, str], list[CompletionItem[str]]]:
    """Make the completion of a value that is the name of a file ("file") or of a folder ("dir"); the shell finds them."""
    return lambda context, parameter, incomplete: [CompletionItem(incomplete, type=kind)]


def together(*decorators: Callable[[F], F]) -> Callable[[F], F]:
    """Combine options into one decorator; the help shows them in the order given."""

    def decorate(function: F) -> F:
        for decorator in reversed(decorators):
            function = decorator(function)
        return function

    return decorate


class Command(click.Command):
    """A command with examples and further sections in its help.

    `examples` maps command lines to descriptions; `notes` returns the entries of further sections by heading.
    """

    def __init__(
        self,
        *arguments: Any,
        examples: Mapping[str, str] | None = None,
        notes: Callable[[], Mapping[str, list[tuple[str, str]]]] | None = None,
        **keywords: Any,
    ) -> None:
        super().__init__(*arguments, **keywords)
        self.examples = dict(examples or {})
        self.notes = notes

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        sections: dict[str, list[tuple[str, str]]] = {}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            # The text at the top of the help describes the arguments.
            if record is not None and not isinstance(parameter, click.Argument):
                section = parameter.section if isinstance(parameter, Option) else "Other"
                sections.setdefault(section, []).append(record)
        # General flags such as --help come last, wherever they were declared.
        sections["Other"] = sections.pop("Other", [])
        if self.examples:
            with formatter.section("Examples"):
                for line, meaning in self.examples.items():
                    formatter.write_text(meaning)
                    formatter.write(f"{'':{formatter.current_indent + 4}}{line}\n")
        for name, records in {**sections, **(self.notes() if self.notes else {})}.items():
            if records:
                with formatter.section(name):
                    formatter.write_dl(records)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            raise _unknown_option(error, self, ctx) from None
        except click.UsageError as error:
            # Some errors of click lack the context that names the command whose help to read.
            error.ctx = error.ctx or ctx
            raise


def _unknown_option(
    error: click.NoSuchOption, command: click.Command, context: click.Context, elsewhere: str = ""
) -> click.UsageError:
    """Make the error for an unknown option. It says `elsewhere`, where the option belongs, or suggests the most similar known
    one; leading dashes are not compared."""
    known = [name.removeprefix("--") for name in _long_options(command, context)]
    hint = elsewhere or did_you_mean(error.option_name.lstrip("-"), known).replace("'", "'--", 1)
    return click.UsageError(f"unknown option {error.option_name} for {context.command_path}{hint}", context)


def _long_options(command: click.Command, context: click.Context) -> list[str]:
    return [name for parameter in command.get_params(context) for name in parameter.opts if name.startswith("--")]


class Group(click.Group):
    """The group of all commands, each of which is imported only when it is run or listed.

    `table` maps the names of commands to modules, and `exit_codes` exit codes to meanings.
    """

    def __init__(
        self, *arguments: Any, table: Mapping[str, str], exit_codes: Mapping[int, str], **keywords: Any
    ) -> None:
        super().__init__(*arguments, **keywords)
        self.table = dict(table)
        self.exit_codes = dict(exit_codes)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Exit codes"):
            formatter.write_dl([(str(code), meaning) for code, meaning in self.exit_codes.items()])

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        given = list(args)
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            name = next((word for word in given if word in self.table), "")
            command = self.get_command(ctx, name)
            after = command is not None and error.option_name in _long_options(command, ctx)
            elsewhere = f"; it goes after the command, as in 'eclat {name} {error.option_name} …'" if after else ""
            raise _unknown_option(error, self, ctx, elsewhere) from None

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self.table)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.table:
            return None
        found = getattr(importlib.import_module(self.table[cmd_name]), "command", None)
        assert isinstance(found, click.Command)
        return found

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name = args[0]
        found = self.get_command(ctx, name)
        if found is None:
            known = ", ".join(self.table)
            raise click.UsageError(
                f"unknown command {name!r}, expected one of {known}{did_you_mean(name, self.table)}", ctx
            )
        return name, found, args[1:]
