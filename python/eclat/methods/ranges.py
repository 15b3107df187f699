# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Ranges and names of options, checked when a method is made."""

from __future__ import annotations

import math
from typing import Any, get_args, get_type_hints

from eclat.errors import EclatError, did_you_mean


def check_range(method: object, name: str, low: float, high: float) -> None:
    """Raises EclatError where the field `name` is not None and no number from `low` to `high`."""
    value = getattr(method, name)
    if value is None:
        return
    if not isinstance(value, int | float) or math.isnan(value) or not low <= value <= high:
        raise EclatError(f"{type(method).__name__}: {name} must be between {low:g} and {high:g}, got {value!r}")


def check_names(method: object, *names: str) -> None:
    """Raises EclatError where a field is not one of the words of its type, a `Literal`."""
    types = get_type_hints(type(method))
    for name in names:
        value, known = getattr(method, name), get_args(types[name])
        if value not in known:
            raise EclatError(
                f"{type(method).__name__}: {name} must be one of {', '.join(known)}, got {value!r}"
                + did_you_mean(str(value), known)
            )


def core_enum(kind: Any, name: str) -> Any:
    """The member of one of the core's enums that an option names: "split-sphere" is `split_sphere` there."""
    return kind[name.replace("-", "_")]
