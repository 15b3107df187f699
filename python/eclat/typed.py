# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Arguments of public functions have the types that their annotations say, or a message says what was expected."""

from __future__ import annotations

import functools
import inspect
import numbers
import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ParamSpec, TypeVar

import numpy as np

from eclat.errors import EclatError, did_you_mean, shown

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True)
class Kind:
    """A kind of value: its noun in messages, and a function that returns the value as Python's own type or raises
    TypeError."""

    noun: str
    taken: Callable[[Any], Any]


def _whole(value: Any) -> int:
    if isinstance(value, bool | np.bool_) or not isinstance(value, numbers.Integral):
        raise TypeError
    return int(value)


def _number(value: Any) -> float:
    if isinstance(value, bool | np.bool_) or not isinstance(value, numbers.Real):
        raise TypeError
    try:
        return float(value)
    except OverflowError:
        raise TypeError from None


def _truth(value: Any) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise TypeError
    return bool(value)


def _instance(*classes: type) -> Callable[[Any], Any]:
    def taken(value: Any) -> Any:
        if not isinstance(value, classes):
            raise TypeError
        return value

    return taken


def _callable(value: Any) -> Any:
    if not callable(value):
        raise TypeError
    return value


def _several(count: int | None) -> Callable[[Any], Any]:
    def taken(value: Any) -> Any:
        if not isinstance(value, Sequence | np.ndarray) or (count is not None and len(value) != count):
            raise TypeError
        found = [_whole(item) for item in value]
        return found if count is None else tuple(found)

    return taken


_KINDS = {
    "None": Kind("None", _instance(type(None))),
    "int": Kind("a whole number", _whole),
    "float": Kind("a number", _number),
    "bool": Kind("True or False", _truth),
    "str": Kind("a text", _instance(str)),
    "Component": Kind("a text", _instance(str)),
    "SidesChoice": Kind("a text", _instance(str)),
    "os.PathLike[str]": Kind("a path", _instance(os.PathLike)),
    "tuple[int, int]": Kind("two whole numbers", _several(2)),
    "tuple[int, int, int, int]": Kind("four whole numbers", _several(4)),
    "list[int]": Kind("whole numbers", _several(None)),
    "dict[str, float]": Kind("a dict", _instance(dict)),
    "ProgressReport": Kind("a function", _callable),
}
"""The kinds of values by how annotations write them."""

_CLASSES = {
    "Camera": "a Camera",
    "Effort": "an Effort",
    "Image": "an Image",
    "Reference": "a Reference",
    "Scene": "a Scene",
    "Solved": "a solution",
}
"""Classes of the package, by name, that arguments may be instances of, with their nouns."""


def _kind(annotation: str) -> Kind | None:
    """Return the kind of one alternative of an annotation; None for those that the function checks itself."""
    if annotation in _KINDS:
        return _KINDS[annotation]
    if annotation.startswith("Callable["):
        return _KINDS["ProgressReport"]
    if annotation.startswith("Mapping["):
        return Kind("a dict", _instance(Mapping))
    if annotation.startswith("Literal["):
        return _KINDS["str"]
    if annotation not in _CLASSES:
        return None

    def taken(value: Any) -> Any:
        # The class is known by its name, because a module may import it for type checkers only.
        if all(base.__name__ != annotation for base in type(value).__mro__):
            raise TypeError
        return value

    return Kind(_CLASSES[annotation], taken)


def _kinds(annotation: str) -> list[Kind] | None:
    # Alternatives are separated outside of brackets only.
    names = _alternatives(annotation)
    if len(names) > 1 and "Scene" in names:
        return None  # `staged` knows more of names and paths of scenes
    kinds = [_kind(name) for name in names]
    known = [kind for kind in kinds if kind is not None]
    return known if len(known) == len(kinds) else None


def _alternatives(annotation: str) -> list[str]:
    """Split an annotation at the signs `|` that stand outside of brackets."""
    pieces = annotation.split("|")
    names = [pieces[0]]
    for piece in pieces[1:]:
        if names[-1].count("[") > names[-1].count("]"):
            names[-1] += "|" + piece
        else:
            names.append(piece)
    return [name.strip() for name in names]


def typed(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a public function: arguments of wrong types raise EclatError, and numbers of NumPy become Python's.

    The module of the function must have `from __future__ import annotations`. Parameters whose annotation contains a type that
    `_kind` does not know, such as arrays, are left to the function.
    """
    signature = inspect.signature(function)
    annotations = {name: str(p.annotation) for name, p in signature.parameters.items()}
    kinds = {name: kinds for name, text in annotations.items() if (kinds := _kinds(text)) is not None}

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            bound = signature.bind(*args, **kwargs)
        except TypeError:
            refuse_unknown(function.__name__, kwargs, signature.parameters)
            return function(*args, **kwargs)  # which raises Python's own message
        for name, value in bound.arguments.items():
            if name in kinds:
                bound.arguments[name] = _taken(value, kinds[name], f"{function.__name__}: {name}")
        return function(*bound.args, **bound.kwargs)

    return checked


def refuse_unknown(name: str, given: Mapping[str, Any], known: Collection[str]) -> None:
    """Raise TypeError for a keyword argument of the function `name` that is not among those known, as Python does, with the
    most similar known one.
    """
    for key in given:
        if key not in known:
            near = did_you_mean(key, known) or f"; expected one of {', '.join(known)}"
            raise TypeError(f"{name}() got an unexpected keyword argument {key!r}{near}")


def _taken(value: Any, kinds: list[Kind], where: str) -> Any:
    for kind in kinds:
        try:
            return kind.taken(value)
        except TypeError:
            continue
    nouns = list(dict.fromkeys(kind.noun for kind in kinds))
    expected = nouns[0] if len(nouns) == 1 else f"{', '.join(nouns[:-1])} or {nouns[-1]}"
    raise EclatError(f"{where}: expected {expected}, got {shown(value)}")
