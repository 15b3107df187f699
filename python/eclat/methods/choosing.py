# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Choosing a method: by its name with options, or as the verbs do, by whatever stands for one."""

from __future__ import annotations

import dataclasses

from eclat.errors import EclatError, did_you_mean, shown
from eclat.methods.method import METHODS, Method, Prepared, Source


def method_class(name: str) -> type[Method]:
    """Return the class of the method with the given name. Raises EclatError if there is none."""
    if name not in METHODS:
        raise EclatError(f"unknown method {name!r}, expected one of {', '.join(METHODS)}{did_you_mean(name, METHODS)}")
    return METHODS[name]


def make_options(method: str, **settings: object) -> Method:
    """Make a method with some options set. Raises EclatError if the method or an option is unknown."""
    cls = method_class(method)
    known = [field.name for field in dataclasses.fields(cls)]
    for key in settings:
        if key not in known:
            raise EclatError(f"unknown option {key} for {method}{did_you_mean(key, known)}")
    return cls(**settings)


def as_method(what: Source | type[Method] | str | None, default: Method | None = None, **settings: object) -> Source:
    """Turn the `what` of a verb into a method or a solution.

    Parameters
    ----------
    what : a method, its class, its name, a solution, or None. For a class or a name, the `settings` that are options of
        the method are applied.
    default : the method that is returned for None.

    Raises
    ------
    EclatError : the name is unknown, or `what` is none of these.
    """
    if isinstance(what, str):
        what = method_class(what)
    if isinstance(what, type) and issubclass(what, Method):
        known = {field.name for field in dataclasses.fields(what)}
        return what(**{name: value for name, value in settings.items() if name in known})
    if what is None and default is not None:
        return default
    if isinstance(what, Method | Prepared):
        return what
    raise EclatError(f"expected a method, its class, its name or a solution, got {shown(what)}")
