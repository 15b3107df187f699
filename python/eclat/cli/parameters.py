# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The types of the values of command-line options, and the messages for invalid values."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import click
from click.shell_completion import CompletionItem

from eclat.errors import EclatError, did_you_mean


class _Type(click.ParamType[Any]):
    """A parameter type whose error messages state what was expected and what was got."""

    expected = ""

    def refuse(self, value: object, parameter: click.Parameter | None, context: click.Context | None) -> NoReturn:
        self.fail(f"expected {self.expected}, got {str(value)!r}", parameter, context)


class Number(_Type):
    """The type of an integer or a finite number in the range `low`..`high`; with `above`, the lower limit itself is
    excluded.
    """

    def __init__(
        self,
        kind: type[int] | type[float],
        low: float = -math.inf,
        high: float = math.inf,
        *,
        above: bool = False,
        unit: str = "",
    ) -> None:
        self.kind, self.low, self.high, self.above = kind, low, high, above
        self.name = "integer" if kind is int else "number"
        number = "an integer" if kind is int else "a number"
        bounds = ""
        if low > -math.inf and high < math.inf:
            bounds = f" {'above' if above else 'from'} {low:,.10g} {'and at most' if above else 'to'} {high:,.10g}"
        elif low > -math.inf:
            bounds = f" above {low:,.10g}" if above else f" of at least {low:,.10g}"
        self.expected = f"{number}{bounds}{unit and ' ' + unit}"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = _number(value, self.kind)
        if number is None or not self.low <= number <= self.high or (self.above and number == self.low):
            self.refuse(value, param, ctx)
        return number


class Exposure(Number):
    """The type of an exposure in stops, for which the word "auto" may also be allowed."""

    def __init__(self) -> None:
        super().__init__(float, -64, 64)
        self.expected += " or auto"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        return value if value == "auto" else super().convert(value, param, ctx)


class Depth(Number):
    """The type of the greatest number of edges of a path, which is at least 1, or −1 for no limit."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        depth = super().convert(value, param, ctx)
        if depth == 0:
            self.fail("expected -1 (no limit) or at least 1, got 0", param, ctx)
        return depth


class Numbers(_Type):
    """The type of a tuple of numbers, which are separated by commas and whose count is fixed."""

    def __init__(self, name: str, expected: str, count: int, kind: type[int] | type[float] = float) -> None:
        self.name, self.expected, self.count, self.kind = name, expected, count, kind

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[float, ...]:
        numbers = tuple(_number(part, self.kind) for part in _spelled(value, ",").split(","))
        given = tuple(number for number in numbers if number is not None)
        if len(given) != len(numbers) or len(given) != self.count or not self.accepts(given):
            self.refuse(value, param, ctx)
        return given

    def accepts(self, numbers: tuple[float, ...]) -> bool:
        """Return whether the numbers are valid; their count has been checked."""
        return True


class _Crop(Numbers):
    def accepts(self, numbers: tuple[float, ...]) -> bool:
        x0, y0, x1, y1 = numbers
        return 0 <= x0 < x1 and 0 <= y0 < y1


class _Bounds(Numbers):
    def accepts(self, numbers: tuple[float, ...]) -> bool:
        return numbers[:3] != numbers[3:] and all(a <= b for a, b in zip(numbers[:3], numbers[3:], strict=True))


class _Grid(Numbers):
    def accepts(self, numbers: tuple[float, ...]) -> bool:
        return min(numbers) >= 1


class _Sun(Numbers):
    def accepts(self, numbers: tuple[float, ...]) -> bool:
        return -90 <= numbers[1] <= 90


class _Replay(Numbers):
    def accepts(self, numbers: tuple[float, ...]) -> bool:
        return min(numbers) >= 0


class _Size(_Type):
    name = "WxH"
    expected = "WIDTHxHEIGHT in pixels, such as 1280x720"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, int]:
        width, _, height = _spelled(value, "x").lower().replace("×", "x").partition("x")
        if not (_number(width, int) is not None and _number(height, int) is not None):
            self.refuse(value, param, ctx)
        from eclat.images.image import check_size

        check_size(int(width), int(height), "--size")
        return int(width), int(height)


class _Environment(_Type):
    name = "FILE|r,g,b"
    expected = "an image file or a radiance r,g,b, each at least 0"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str | tuple[float, ...]:
        text = _spelled(value, ",")
        numbers = [_number(part, float) for part in text.split(",")]
        given = tuple(number for number in numbers if number is not None)
        if not given:
            return text
        if len(given) != 3 or len(numbers) != 3 or min(given) < 0:
            self.refuse(value, param, ctx)
        return given


class Name(_Type):
    """The type of one of a set of names; the error for an unknown name suggests the most similar one."""

    def __init__(self, name: str, *names: str) -> None:
        self.name, self.names = name, names
        self.expected = f"one of {', '.join(names)}"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        text = str(value)
        if text not in self.names:
            self.fail(f"expected {self.expected}, got {text!r}{did_you_mean(text, self.names)}", param, ctx)
        return text

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem[str]]:
        return [CompletionItem(name) for name in self.names if name.startswith(incomplete)]


class Adaptive(Name):
    """The type of `adaptive` of `eclat.render`: the name of the error that decides how many samples a pixel gets, or `off`."""

    def __init__(self) -> None:
        super().__init__("ERROR", "off", "noise", "denoised")

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if isinstance(value, bool):
            return value  # The settings of a picture hold what `convert` returned.
        name = super().convert(value, param, ctx)
        return False if name == "off" else name


class Parsed(_Type):
    """The type of a text that a function parses, which raises EclatError if the text is invalid. `expected` says what is."""

    def __init__(self, name: str, expected: str, parse: Callable[[str], Any]) -> None:
        self.name, self.expected, self._parse = name, expected, parse

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
        try:
            return self._parse(value)
        except EclatError:
            self.refuse(value, parameter, context)


class LightGroups(_Type):
    """The type of a group of lamps, `NAME=LAMP,…`, or of the word `each`, which stands for a group of each name."""

    name = "each|NAME=LAMP,…"
    expected = "each, or a group and the names of its lamps, such as kitchen=lamp*,stove"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        text = str(value)
        group, _, lamps = text.partition("=")
        if text != "each" and not (group and all(lamps.split(","))):
            self.refuse(value, param, ctx)
        return text


def groups_given(texts: Sequence[str]) -> bool | dict[str, list[str]]:
    """Return the groups that values of `LightGroups` ask for, as `render` takes them."""
    if "each" in texts or not texts:
        if len(texts) > 1:
            raise EclatError(f"--light-groups: expected each or groups, got {' and '.join(texts)}")
        return bool(texts)
    groups: dict[str, list[str]] = {}
    for text in texts:
        name, _, lamps = text.partition("=")
        groups.setdefault(name, []).extend(lamps.split(","))
    return groups


def _spelled(value: Any, separator: str) -> str:
    """Format a value as it is typed on the command line; values stored in a file may be lists."""
    return separator.join(map(str, value)) if isinstance(value, list | tuple) else str(value)


def _number(text: Any, kind: type[int] | type[float]) -> float | None:
    """Read a finite number from `text`; return None if it is not one."""
    try:
        # Python would accept 1_000 too. An integer of more than 40 digits is not a size, a seed or a count.
        if "_" in str(text) or len(str(text)) > 40:
            return None
        number = kind(str(text))
    except ValueError:
        return None
    return number if math.isfinite(number) else None


SIZE = _Size()
CROP = _Crop("x0,y0,x1,y1", "x0,y0,x1,y1 in pixels with x0 < x1 and y0 < y1, such as 100,50,300,200", 4, int)
BOUNDS = _Bounds("x0,y0,z0,x1,y1,z1", "a box x0,y0,z0,x1,y1,z1 in metres, such as 0,0,0,6,2.5,8", 6)
GRID = _Grid("X,Y,Z", "three numbers of probes X,Y,Z of at least 1, such as 16,6,12", 3, int)
POINT = Numbers("x,y,z", "three numbers x,y,z", 3)
SUN = _Sun("AZIMUTH,ELEVATION", "azimuth,elevation in degrees with an elevation from -90 to 90, such as 135,40", 2)
REPLAY = _Replay("x,y,SAMPLE", "a pixel and the index of one of its samples, x,y,sample, such as 412,77,19", 3, int)
ENVIRONMENT = _Environment()
