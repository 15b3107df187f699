# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The tree of nodes that Mitsuba scenes in both forms, XML and dict, are read into."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, shown
from eclat.files.confinement import is_outside
from eclat.loaders.files import resolve
from eclat.loaders.mitsuba.moving import MovingTransform

MAX_DEPTH = 50
"""The largest depth of nested elements, included files and references together. Real scenes stay below 15."""

MAX_MAGNITUDE = 1e30
"""The largest absolute value of a number. Larger numbers are mistakes, and their products would overflow float32."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Rgb:
    """A colour in linear sRGB."""

    values: Vector


@dataclass(frozen=True)
class Uniform:
    """A constant spectrum. Its colour depends on its role (see `spectra.to_rgb`)."""

    value: float


@dataclass(frozen=True, eq=False)
class Curve:
    """A sampled spectrum: wavelengths in nanometres, and the value at each of them."""

    wavelengths: tuple[float, ...]
    values: tuple[float, ...]


@dataclass(frozen=True)
class Blackbody:
    """The emission of a black body with a `temperature` in kelvin, multiplied by `scale`."""

    temperature: float
    scale: float = 1.0


Color = Rgb | Uniform | Curve | Blackbody


@dataclass(eq=False)
class Node:
    """An object of the scene, such as a shape, a BSDF or a film.

    `where` names the object in messages, with its file and line. The names of `properties` are in snake case, even if
    the file writes them differently. `children` are in the order of the file, and each has the name of the property or,
    for a BSDF in a shape of type obj, of the material that it replaces. `used` contains the names of the properties
    that have been read. `asked` contains all names that have been looked up, whether they exist or not.
    """

    tag: str
    type: str
    where: str
    folders: tuple[Path, ...]
    id: str = ""
    legacy: bool = False
    """Whether the object is from a file of version 0.x, in which some defaults are different."""
    properties: dict[str, Any] = field(default_factory=dict)
    children: list[tuple[str, Node]] = field(default_factory=list)
    used: set[str] = field(default_factory=set)
    asked: set[str] = field(default_factory=set)

    def get(self, *names: str) -> Any:
        """Return the property, or otherwise the child, of the first name in `names` that exists, or None if none
        exists.
        """
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
        """Return the names and nodes of the children that have one of these tags."""
        return [(name, child) for name, child in self.children if child.tag in tags]

    def number(self, *names: str, default: float) -> float:
        """Return the finite number in the first property that exists. Raises EclatError if it is anything else."""
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
        """Return the number above 0 in the first property that exists. Raises EclatError if it is anything else."""
        value = self.number(*names, default=default)
        if value <= 0:
            raise self.mismatch(names[0], "a number above 0", value)
        return value

    def integer(self, *names: str, default: int) -> int:
        """Return the integer in the first property that exists. Raises EclatError if it is anything else."""
        value = self.number(*names, default=default)
        if value != int(value):
            raise self.mismatch(names[0], "an integer", value)
        return int(value)

    def boolean(self, *names: str, default: bool) -> bool:
        """Return the truth value, also as a number or a string, in the first property that exists.

        Raises EclatError if it is anything else.
        """
        value = self.get(*names)
        if value is None:
            return default
        if isinstance(value, str):
            return parse_boolean(value, f"{self.where}, {names[0]}")
        if isinstance(value, (bool, int, float)):
            return bool(value)
        raise self.mismatch(names[0], "true or false", value)

    def string(self, *names: str, default: str = "") -> str:
        """Return the string in the first property that exists. Numbers become strings.

        Raises EclatError if it is anything else.
        """
        value = self.get(*names)
        if value is None:
            return default
        if isinstance(value, (str, float, int)):
            return str(value)
        raise self.mismatch(names[0], "a string", value)

    def vector(self, *names: str) -> Vector | None:
        """Return the three numbers in the first property that exists, or None if none exists.

        Raises EclatError if it is anything else.
        """
        value = self.get(*names)
        if isinstance(value, Rgb):
            return value.values
        if value is None or (isinstance(value, tuple) and len(value) == 3):
            return value
        raise self.mismatch(names[0], "three numbers", value)

    def transform(self, *names: str) -> NDArray[np.float64]:
        """Return the 4×4 matrix in the first property that exists, at the time of `moving.at_time`, or the identity.

        Raises EclatError if it is anything else.
        """
        value = self.get(*names)
        if value is None:
            return np.eye(4)
        if isinstance(value, MovingTransform):
            return value.now()
        if isinstance(value, np.ndarray) and value.shape == (4, 4):
            return value
        raise self.mismatch(names[0], "a transform", value)

    def file(self, *names: str, default: str = "") -> Path:
        """Return the path of the file that the first existing property names. The file need not exist.

        Relative names are searched in all `folders`. Raises EclatError if no property exists or the name is invalid.
        """
        name = self.string(*names, default=default)
        if not name:
            raise EclatError(f"{self.where}: expected the property {names[0]!r} with the name of a file, got none")
        where = f"{self.where}, {names[0]}"
        for folder in self.folders:
            try:
                path = folder / name.replace("\\", "/").strip()
                if not is_outside(path) and path.exists():
                    return resolve(folder, name, where=where, allow_parent=True)
            except (OSError, ValueError):  # `resolve` raises EclatError for names that are too long or contain zeros
                break
        return resolve(self.folders[0], name, where=where, allow_parent=True)

    def mismatch(self, name: str, expected: str, got: object) -> EclatError:
        """Make the error for a property `name` with an invalid value."""
        what = f"a {got.tag} of type {got.type!r}" if isinstance(got, Node) else shown(got)
        return EclatError(f"{self.where}, {name}: expected {expected}, got {what}")


def snake_case(name: str) -> str:
    """Convert `name` to snake case: `toWorld` and `to_world` become `to_world`, and `intIOR` becomes `int_ior`."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).replace("-", "_").lower()


_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?f?")


def parse_number(text: str, where: str) -> float:
    """Parse a finite number, which may start with a dot and end with `f`. Raises EclatError."""
    stripped = text.strip().rstrip(",")
    if len(stripped) <= 400 and _NUMBER.fullmatch(stripped):
        return check_number(float(stripped.rstrip("f")), where)
    raise EclatError(f"{where}: expected a number, got {shown(text)}")


def check_number(value: float, where: str) -> float:
    """Return `value`. Raises EclatError if it is not finite or its absolute value exceeds `MAX_MAGNITUDE`."""
    if not math.isfinite(value) or abs(value) > MAX_MAGNITUDE:
        raise EclatError(
            f"{where}: expected a finite number whose absolute value is at most {MAX_MAGNITUDE:g}, got {value:g}"
        )
    return value


def parse_numbers(text: str, where: str) -> list[float]:
    """Parse numbers that are separated by commas, semicolons or white space. Raises EclatError."""
    return [parse_number(part, where) for part in re.split(r"[\s,;]+", text) if part]


def parse_boolean(text: str, where: str) -> bool:
    """Parse true or false, 1 or 0, yes or no, in upper or lower case. Raises EclatError."""
    word = text.strip().lower()
    if word in ("true", "1", "yes"):
        return True
    if word in ("false", "0", "no"):
        return False
    raise EclatError(f"{where}: expected true or false, got {shown(text)}")


def parse_vector(text: str, where: str) -> Vector:
    """Parse three numbers, or one number that stands for all three. Raises EclatError."""
    numbers = parse_numbers(text, where)
    if len(numbers) == 1:
        numbers = numbers * 3
    if len(numbers) != 3:
        raise EclatError(f"{where}: expected three numbers, got {shown(text)}")
    return numbers[0], numbers[1], numbers[2]
