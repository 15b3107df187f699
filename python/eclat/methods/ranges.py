# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Checks of the types, ranges and names of options when a method is made."""

from __future__ import annotations

import dataclasses
import math
import numbers
from typing import Any, get_args, get_type_hints

from eclat.errors import EclatError, did_you_mean, shown

_KINDS: dict[type, tuple[type, str]] = {
    bool: (bool, "True or False"),
    int: (numbers.Integral, "a whole number"),
    float: (numbers.Real, "a number"),
}
"""A field's type → the types that values may have, and what messages call it."""


def check_types(method: object) -> None:
    """Raise EclatError for the first field whose value is not of its type: a truth value, a whole number or a number.

    Numbers of other types, such as NumPy's, become Python numbers, which can be saved. `check_names` checks words.
    """
    types = get_type_hints(type(method))
    for field in dataclasses.fields(method):  # type: ignore[arg-type]
        value = getattr(method, field.name)
        alternatives = get_args(types[field.name]) or (types[field.name],)
        kind = next((kind for kind in alternatives if kind in _KINDS), None)
        if kind is None or (value is None and type(None) in alternatives):
            continue
        base, noun = _KINDS[kind]
        if not isinstance(value, base) or isinstance(value, bool) != (kind is bool):
            empty = " or None" if type(None) in alternatives else ""
            raise EclatError(f"{type(method).__name__}: {field.name} must be {noun}{empty}, got {shown(value)}")
        if type(value) not in (bool, int, float):
            object.__setattr__(method, field.name, kind(value))


def check_range(method: object, name: str, low: float, high: float) -> None:
    """Raise EclatError if the field `name` is neither None nor a number from `low` to `high`."""
    value = getattr(method, name)
    if value is None:
        return
    if not isinstance(value, int | float) or math.isnan(value) or not low <= value <= high:
        raise EclatError(f"{type(method).__name__}: {name} must be between {low:g} and {high:g}, got {shown(value)}")


def check_names(method: object, *names: str) -> None:
    """Raise EclatError if a field is not one of the words of its `Literal` type."""
    types = get_type_hints(type(method))
    for name in names:
        value, known = getattr(method, name), get_args(types[name])
        if value not in known:
            raise EclatError(
                f"{type(method).__name__}: {name} must be one of {', '.join(known)}, got {shown(value)}"
                + did_you_mean(str(value), known)
            )


def core_enum(kind: Any, name: str) -> Any:
    """The member of one of the core's enums that an option names: "split-sphere" is `split_sphere` there."""
    return kind[name.replace("-", "_")]
