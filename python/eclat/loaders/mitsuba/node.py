# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The neutral tree that both forms of a Mitsuba scene, XML and dict, are read into."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, shown
from eclat.loaders.files import resolve

MAX_DEPTH = 50
"""Nesting of elements, includes and references together; real scenes stay under 15."""

MAX_MAGNITUDE = 1e30
"""Numbers beyond it (or not finite) are mistakes, and their products would overflow float32."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Rgb:
    """A colour in linear sRGB."""

    values: Vector


@dataclass(frozen=True)
class Uniform:
    """A `spectrum` of one number, whose colour depends on its role."""

    value: float


@dataclass(frozen=True, eq=False)
class Curve:
    """Samples of a spectrum: wavelengths in nanometres, values."""

    wavelengths: tuple[float, ...]
    values: tuple[float, ...]


@dataclass(frozen=True)
class Blackbody:
    """A black body of `temperature` kelvin, times `scale`."""

    temperature: float
    scale: float = 1.0


Color = Rgb | Uniform | Curve | Blackbody


@dataclass(eq=False)
class Node:
    """An object of the scene: a shape, a bsdf, a film. `where` names it in messages, with file and line.

    `properties` have snake_case names whatever the file wrote; `children` keep the name they were given (a property's
    or, for a bsdf inside a shape of type obj, a material's) and their order. `used` holds the properties that were
    read, and `asked` all that were looked up, whether they exist or not.
    """

    tag: str
    type: str
    where: str
    folders: tuple[Path, ...]
    id: str = ""
    legacy: bool = False
    """From a file of version 0.x, whose defaults differ in places."""
    properties: dict[str, Any] = field(default_factory=dict)
    children: list[tuple[str, Node]] = field(default_factory=list)
    used: set[str] = field(default_factory=set)
    asked: set[str] = field(default_factory=set)

    def get(self, *names: str) -> Any:
        """The property or child node of the first of `names` that exists; None if none does."""
        self.asked.update(names)
        for name in names:
            if name in self.properties:
                self.used.update(names)
                return self.properties[name]
        for name in names:
            for edge, child in self.children:
                if snake_case(edge) == name:
                    return child
        return None

    def of_tag(self, *tags: str) -> list[tuple[str, Node]]:
        """The children with one of these tags, as (name, node)."""
        return [(name, child) for name, child in self.children if child.tag in tags]

    def number(self, *names: str, default: float) -> float:
        """A finite number. Raises EclatError for anything else."""
        value = self.get(*names)
        if value is None:
            return default
        if isinstance(value, Uniform):
            return value.value
        if isinstance(value, Rgb) and value.values[0] == value.values[1] == value.values[2]:
            return value.values[0]
        if isinstance(value, str):
            return parse_number(value, f"{self.where}, {names[0]}")
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self.mismatch(names[0], "a number", value)
        return float(value)

    def positive(self, *names: str, default: float) -> float:
        """A number above 0. Raises EclatError for anything else."""
        value = self.number(*names, default=default)
        if value <= 0:
            raise self.mismatch(names[0], "a number above 0", value)
        return value

    def integer(self, *names: str, default: int) -> int:
        """A whole number. Raises EclatError for anything else."""
        value = self.number(*names, default=default)
        if value != int(value):
            raise self.mismatch(names[0], "a whole number", value)
        return int(value)

    def boolean(self, *names: str, default: bool) -> bool:
        """true or false, also written as a number or a string; EclatError for anything else."""
        value = self.get(*names)
        if value is None:
            return default
        if isinstance(value, str):
            return parse_boolean(value, f"{self.where}, {names[0]}")
        if isinstance(value, (bool, int, float)):
            return bool(value)
        raise self.mismatch(names[0], "true or false", value)

    def string(self, *names: str, default: str = "") -> str:
        """A string; numbers are spelled out. EclatError for anything else."""
        value = self.get(*names)
        if value is None:
            return default
        if isinstance(value, (str, float, int)):
            return str(value)
        raise self.mismatch(names[0], "a string", value)

    def vector(self, *names: str) -> Vector | None:
        """Three numbers, or None. Raises EclatError for anything else."""
        value = self.get(*names)
        if isinstance(value, Rgb):
            return value.values
        if value is None or (isinstance(value, tuple) and len(value) == 3):
            return value
        raise self.mismatch(names[0], "three numbers", value)

    def transform(self, *names: str) -> NDArray[np.float64]:
        """A 4×4 matrix, the identity where there is none; EclatError for anything else."""
        value = self.get(*names)
        if value is None:
            return np.eye(4)
        if isinstance(value, np.ndarray) and value.shape == (4, 4):
            return value
        raise self.mismatch(names[0], "a transform", value)

    def file(self, *names: str, default: str = "") -> Path:
        """The path of a file that the scene names; it need not exist. EclatError without a name."""
        name = self.string(*names, default=default)
        if not name:
            raise EclatError(f"{self.where}: expected a {names[0]}, got none")
        where = f"{self.where}, {names[0]}"
        for folder in self.folders:
            try:
                if (folder / name.replace("\\", "/").strip()).exists():
                    return resolve(folder, name, where=where, allow_parent=True)
            except (OSError, ValueError):  # names too long or with zeros: `resolve` says what is wrong with them
                break
        return resolve(self.folders[0], name, where=where, allow_parent=True)

    def mismatch(self, name: str, expected: str, got: object) -> EclatError:
        """The error to raise for a property of the wrong kind."""
        what = f"a {got.tag} of type {got.type!r}" if isinstance(got, Node) else shown(got)
        return EclatError(f"{self.where}, {name}: expected {expected}, got {what}")


def snake_case(name: str) -> str:
    """The name in snake case: `toWorld` and `to_world` become `to_world`, and `intIOR` becomes `int_ior`."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).replace("-", "_").lower()


_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?f?")


def parse_number(text: str, where: str) -> float:
    """A finite number: leading dots and a trailing `f` are fine. Raises EclatError."""
    stripped = text.strip().rstrip(",")
    if len(stripped) <= 400 and _NUMBER.fullmatch(stripped):
        return check_number(float(stripped.rstrip("f")), where)
    raise EclatError(f"{where}: expected a number, got {shown(text)}")


def check_number(value: float, where: str) -> float:
    """Return `value`. Raises EclatError if it is not finite or larger than `MAX_MAGNITUDE`."""
    if not math.isfinite(value) or abs(value) > MAX_MAGNITUDE:
        raise EclatError(f"{where}: expected a finite number of at most {MAX_MAGNITUDE:g} in size, got {value:g}")
    return value


def parse_numbers(text: str, where: str) -> list[float]:
    """Numbers with commas or blanks between them, trailing ones too. Raises EclatError."""
    return [parse_number(part, where) for part in re.split(r"[\s,;]+", text) if part]


def parse_boolean(text: str, where: str) -> bool:
    """true/false in any case, 1/0, yes/no. Raises EclatError."""
    word = text.strip().lower()
    if word in ("true", "1", "yes"):
        return True
    if word in ("false", "0", "no"):
        return False
    raise EclatError(f"{where}: expected true or false, got {shown(text)}")


def parse_vector(text: str, where: str) -> Vector:
    """Three numbers, or one for all three. Raises EclatError."""
    numbers = parse_numbers(text, where)
    if len(numbers) == 1:
        numbers = numbers * 3
    if len(numbers) != 3:
        raise EclatError(f"{where}: expected three numbers, got {shown(text)}")
    return numbers[0], numbers[1], numbers[2]
