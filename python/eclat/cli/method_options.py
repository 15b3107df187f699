# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The options `--method` and `--set` of the command line, derived from the classes of the methods."""

from __future__ import annotations

import ast
import inspect
import itertools
import textwrap
import typing
from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

import click
import msgspec
from click.shell_completion import CompletionItem

from eclat.cli.command import F, option
from eclat.errors import EclatError, did_you_mean

if TYPE_CHECKING:
    from eclat.methods import Method

METHOD = "Method"
DEFAULT_METHOD = "irradiance-cache"


def set_option(function: F) -> F:
    """Add the option `--set NAME=VALUE`."""
    return option(
        "--set",
        "settings",
        metavar="NAME=VALUE",
        multiple=True,
        section=METHOD,
        shell_complete=_complete_setting,
        help="Set an option of the method to a value; repeatable. All options are listed below; their defaults suit most "
        "scenes.",
    )(function)


def method_option(function: F) -> F:
    """Add the option `--method NAME`."""
    return option(
        "--method",
        metavar="NAME",
        default=DEFAULT_METHOD,
        section=METHOD,
        shell_complete=_complete_method,
        help=f"Method that computes the light; all methods are listed below [{DEFAULT_METHOD}].",
    )(function)


def _complete_method(context: click.Context, parameter: click.Parameter, begun: str) -> list[CompletionItem[str]]:
    from eclat.methods import METHODS

    return [CompletionItem(name, help=_first_sentence(METHODS[name])) for name in METHODS if name.startswith(begun)]


def _complete_setting(context: click.Context, parameter: click.Parameter, begun: str) -> list[CompletionItem[str]]:
    """Complete the names of the options of the method that stands on the command line so far."""
    from eclat.methods import METHODS

    method = METHODS.get(context.params.get("method") or DEFAULT_METHOD)
    names = [] if method is None else [f"{field.name.replace('_', '-')}=" for field in fields(method)]
    return [CompletionItem(name) for name in names if name.startswith(begun)]


def options_of(method: str, settings: Sequence[str] = (), **defaults: object) -> Method:
    """Make the method called `method`, with its options.

    Parameters
    ----------
    settings : texts `name=value`, where the name is that of an option in kebab-case or snake_case.
    defaults : values of options that `settings` do not name. Values that are None, and options that the method does not
        have, are ignored.

    Raises
    ------
    EclatError : the method or an option is unknown, a value has the wrong type or is out of range, or an option is
        given twice.
    """
    from eclat.methods import METHODS, make_options

    if method not in METHODS:
        raise EclatError(
            f"--method: expected one of {', '.join(METHODS)}, got {method!r}{did_you_mean(method, METHODS)}"
        )
    types = typing.get_type_hints(METHODS[method])
    known = {field.name: types[field.name] for field in fields(METHODS[method])}
    values = {name: value for name, value in defaults.items() if name in known and value is not None}
    seen: set[str] = set()
    for setting in settings:
        name, equals, text = setting.partition("=")
        name = name.strip().replace("-", "_")
        if not equals:
            raise EclatError(f"--set: expected NAME=VALUE, got {setting!r}")
        if name not in known:
            hint = did_you_mean(name, known)
            raise EclatError(f"--set: unknown option {name.replace('_', '-')} for {method}{hint.replace('_', '-')}")
        if name in seen:
            raise EclatError(f"--set: {name.replace('_', '-')} is given twice, expected it once")
        seen.add(name)
        values[name] = _value(name, text.strip(), known[name])
    return make_options(method, **values)


def method_notes(*, that_solve: bool = False) -> dict[str, list[tuple[str, str]]]:
    """Describe the methods and their options as sections of the help; with `that_solve`, only methods that have a
    solution.
    """
    from eclat.methods import METHODS

    chosen = {name: cls for name, cls in METHODS.items() if cls.solved is not None or not that_solve}
    notes = {"Methods": [(name, _first_sentence(cls)) for name, cls in chosen.items()]}
    for name, cls in chosen.items():
        types, explained = typing.get_type_hints(cls), field_explanations(cls)
        records = [
            (
                f"{field.name.replace('_', '-')}={type_text(types[field.name])}",
                f"{explained.get(field.name, '')} [{value_text(field.default)}]".strip(),
            )
            for field in fields(cls)
        ]
        if records:
            notes[f"Options of {name} for --set"] = records
    return notes


def field_explanations(cls: type) -> dict[str, str]:
    """Collect the docstrings of the fields of a class from its source, because Python does not keep them."""
    explained: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        if not is_dataclass(base):
            continue
        body = typing.cast(ast.ClassDef, ast.parse(textwrap.dedent(inspect.getsource(base))).body[0]).body
        for statement, following in itertools.pairwise(body):
            match statement, following:
                case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(text))):
                    explained[name] = " ".join(text.split())
    return explained


def type_text(kind: Any) -> str:
    """Describe how values of the type `kind` are written on the command line."""
    if typing.get_origin(kind) is typing.Literal:
        return " | ".join(typing.get_args(kind))
    if isinstance(kind, type) and kind is not type(None):
        return {int: "integer", float: "number", bool: "true | false", str: "text"}.get(kind, kind.__name__)
    alternatives = [type_text(part) if part is not type(None) else "none" for part in typing.get_args(kind)]
    return " | ".join(alternatives) or str(kind)


def value_text(value: object) -> str:
    """Format an option's value as it is written on the command line."""
    return str(value).lower() if value is None or isinstance(value, bool) else str(value)


def _value(name: str, text: str, kind: Any) -> object:
    word = {"none": None, "on": "true", "yes": "true", "off": "false", "no": "false"}.get(text.lower(), text)
    # "none" is valid for all types. The other words are replaced only for bool, since a Literal may have such a name.
    candidate = word if kind is bool or word is None else text
    try:
        return msgspec.convert(candidate, kind, strict=False)
    except msgspec.ValidationError:
        raise EclatError(f"--set: {name.replace('_', '-')}: expected {type_text(kind)}, got {text!r}") from None


def _first_sentence(cls: type) -> str:
    return " ".join((cls.__doc__ or "").split("\n\n")[0].split())
