# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Checks of the options of a method when it is made: their types, ranges and names."""

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
"""Maps the type of a field to the type that its values may have, and to the noun for it in messages."""


def check_types(method: object) -> None:
    """Raise EclatError for the first field whose value does not have its type: bool, a whole number or a number.

    Numbers of other types, such as those of NumPy, are converted to Python numbers, which can be saved. `check_names`
    checks fields that hold one of several names.
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
    """Raise EclatError if the value of a field is not one of the names of its `Literal` type."""
    types = get_type_hints(type(method))
    for name in names:
        value, known = getattr(method, name), get_args(types[name])
        if value not in known:
            raise EclatError(
                f"{type(method).__name__}: {name} must be one of {', '.join(known)}, got {shown(value)}"
                + did_you_mean(str(value), known)
            )


def core_enum(kind: Any, name: str) -> Any:
    """Return the member of an enum of the core that an option names: "split-sphere" is the member `split_sphere`."""
    return kind[name.replace("-", "_")]
