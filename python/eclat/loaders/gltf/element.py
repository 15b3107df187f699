# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""JSON objects with typed access to their members. Errors name the location of the member in the file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from eclat.errors import EclatError, warn


def printable(text: str) -> str:
    """Replace lone surrogates in `text` by question marks. JSON allows them, but files and terminals do not."""
    return text.encode("utf-8", "replace").decode("utf-8")


@dataclass(frozen=True)
class Element:
    """A JSON object, and its location in the file, such as ``"room.glb, meshes[2].primitives[0]"``.

    All methods raise EclatError if the member is invalid.
    """

    data: dict[str, Any]
    where: str

    def at(self, name: str) -> str:
        """Return the location of the member `name`, for messages."""
        return f"{self.where}.{name}" if "[" in self.where else f"{self.where}, {name}"

    def child(self, name: str) -> Element | None:
        """Return the object `name`, or None if it is absent."""
        value = self.data.get(name)
        if value is None:
            return None
        if not isinstance(value, dict):
            raise self._expected("an object", name, value)
        return Element(value, self.at(name))

    def children(self, name: str) -> list[Element]:
        """Return the list of objects `name`, which is empty if it is absent."""
        values = self._list(name)
        for i, value in enumerate(values):
            if not isinstance(value, dict):
                raise self._expected("an object", f"{name}[{i}]", value)
        return [Element(value, self.at(f"{name}[{i}]")) for i, value in enumerate(values)]

    def extension(self, name: str) -> Element | None:
        """Return the object of the extension `name`, or None if it is absent."""
        extensions = self.child("extensions")
        return extensions.child(name) if extensions else None

    def eclat_extras(self) -> Element | None:
        """Return the object extras.eclat that `eclat.gltf_export` writes, or None if there is none."""
        extras = self.data.get("extras")
        note = extras.get("eclat") if isinstance(extras, dict) else None
        return Element(note, self.at("extras.eclat")) if isinstance(note, dict) else None

    def number(self, name: str, default: float | None = None) -> float:
        """Return a finite number. If it is absent, the result is `default`, or EclatError is raised if there is no
        default.
        """
        value = self.data.get(name)
        if value is None:
            if default is None:
                raise self._expected("a number", name, value)
            return default
        return self._finite(value, name)

    def clamped(self, name: str, default: float, low: float = 0.0, high: float = 1.0) -> float:
        """Return a number, or `default` if it is absent. If it is outside [low, high], it is clamped, with a warning."""
        return self._clamp(self.number(name, default), name, low, high)

    def numbers(self, name: str, size: int, default: Sequence[float] | None = None) -> tuple[float, ...]:
        """Return a list of `size` finite numbers.

        If it is absent, the result is `default`, or EclatError is raised if there is no default.
        """
        if self.data.get(name) is None and default is not None:
            return tuple(default)
        values = self._list(name)
        if len(values) != size:
            raise self._expected(f"{size} numbers", name, self.data.get(name))
        return tuple(self._finite(value, f"{name}[{i}]") for i, value in enumerate(values))

    def levels(self, name: str, default: Sequence[float], high: float = math.inf) -> tuple[float, ...]:
        """Return a list of as many numbers as `default` has, or `default` if it is absent.

        Numbers outside [0, high] are clamped, with a warning.
        """
        values = self.numbers(name, len(default), default)
        return tuple(self._clamp(value, f"{name}[{i}]", 0.0, high) for i, value in enumerate(values))

    def color(self, name: str, default: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return a list of three numbers of at least 0, or `default` if it is absent. Negative ones become 0 with a
        warning.
        """
        r, g, b = self.levels(name, default)
        return r, g, b

    def integer(self, name: str, default: int | None = None) -> int:
        """Return an integer of at least 0.

        If it is absent, the result is `default`, or EclatError is raised if there is no default.
        """
        value = self.data.get(name)
        if value is None and default is not None:
            return default
        return self._natural(value, name)

    def index(self, name: str, count: int, what: str) -> int | None:
        """Return an index into the `count` elements of the file that are called `what`, or None if it is absent."""
        if self.data.get(name) is None:
            return None
        return self._in_range(self._natural(self.data[name], name), name, count, what)

    def indices(self, name: str, count: int, what: str) -> list[int]:
        """Return a list of indices into the `count` elements of the file that are called `what`. It is empty if absent."""
        places = [f"{name}[{i}]" for i in range(len(self._list(name)))]
        return [
            self._in_range(self._natural(value, place), place, count, what)
            for place, value in zip(places, self._list(name), strict=True)
        ]

    def text(self, name: str, default: str = "") -> str:
        """Return a string, or `default` if it is absent."""
        value = self.data.get(name, default)
        if not isinstance(value, str):
            raise self._expected("a string", name, value)
        return printable(value)

    def texts(self, name: str) -> list[str]:
        """Return a list of strings, which is empty if it is absent."""
        for i, value in enumerate(self._list(name)):
            if not isinstance(value, str):
                raise self._expected("a string", f"{name}[{i}]", value)
        return [printable(value) for value in self._list(name)]

    def flag(self, name: str, default: bool = False) -> bool:
        """True or false, or `default` if it is absent."""
        value = self.data.get(name, default)
        if not isinstance(value, bool):
            raise self._expected("true or false", name, value)
        return value

    def _list(self, name: str) -> list[Any]:
        value = self.data.get(name)
        if value is None:
            return []
        if not isinstance(value, list):
            raise self._expected("a list", name, value)
        return value

    def _finite(self, value: Any, name: str) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._expected("a number", name, value)
        if not abs(value) <= 3.4e38:  # the largest value of a 32-bit float
            raise self._expected("a finite number", name, value)
        return float(value)

    def _natural(self, value: Any, name: str) -> int:
        if isinstance(value, bool) or not isinstance(value, int | float) or value < 0 or value != value // 1:
            raise self._expected("an integer of at least 0", name, value)
        return int(value)

    def _in_range(self, value: int, name: str, count: int, what: str) -> int:
        if value >= count:
            raise self._expected(f"an index below {count}, the number of {what}", name, value)
        return value

    def _clamp(self, value: float, name: str, low: float, high: float) -> float:
        inside = min(max(value, low), high)
        if inside != value:
            warn(f"{self.at(name)}: expected a number in {low:g}..{high:g}, got {value:g}; {inside:g} is used instead")
        return inside

    def _expected(self, what: str, name: str, got: Any) -> EclatError:
        if got is None:
            return EclatError(f"{self.where}: expected {what} as {name!r}, but it is missing")
        shown = repr(got)
        return EclatError(f"{self.at(name)}: expected {what}, got {shown if len(shown) < 60 else shown[:57] + '...'}")
