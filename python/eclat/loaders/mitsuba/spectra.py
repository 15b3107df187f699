# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Colours as scene files write them, and their conversion to linear sRGB, which depends on their role."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal

from eclat.errors import EclatError, warn
from eclat.loaders.files import read_bytes
from eclat.loaders.mitsuba.node import (
    Blackbody,
    Color,
    Curve,
    Rgb,
    Uniform,
    Vector,
    check_number,
    parse_number,
    parse_numbers,
)
from eclat.measure.spectrum import blackbody_to_rgb, emission_to_rgb, reflectance_to_rgb, srgb_to_linear

Role = Literal["reflectance", "emission"]

_MAX_SPD_BYTES = 1 << 24
_HEX = re.compile(r"#([0-9a-fA-F]{6}|[0-9a-fA-F]{3})")


def to_rgb(color: Color, role: Role, where: str, legacy: bool = False) -> Vector:
    """Linear sRGB of `color`.

    Reflectances are seen under D65. Emission, and the eta and k of metals, are taken as they are: as in Mitsuba 3's RGB
    mode, a spectrum of one number is then the reddish equal-energy white. In files of version 0.x it is grey.
    """
    try:
        if isinstance(color, Rgb):
            return color.values
        if isinstance(color, Uniform):
            if role == "reflectance" or legacy:
                return color.value, color.value, color.value
            return emission_to_rgb((360.0, 830.0), (color.value, color.value))
        if isinstance(color, Blackbody):
            r, g, b = blackbody_to_rgb(color.temperature)
            return r * color.scale, g * color.scale, b * color.scale
        convert = reflectance_to_rgb if role == "reflectance" else emission_to_rgb
        return convert(color.wavelengths, color.values)
    except EclatError as error:
        raise EclatError(f"{where}: {error}") from None


def parse_rgb(text: str, where: str, encoded: bool = False) -> Rgb:
    """A colour from three numbers, one number for grey, or `#rrggbb`. Hexadecimal colours, and numbers if `encoded`,
    are sRGB and become linear."""
    match = _HEX.fullmatch(text.strip())
    if match:
        digits = match[1] if len(match[1]) == 6 else "".join(digit * 2 for digit in match[1])
        numbers = [int(digits[i : i + 2], 16) / 255 for i in (0, 2, 4)]
        encoded = True
    else:
        numbers = parse_numbers(text, where)
    if len(numbers) == 1:
        numbers = numbers * 3
    if len(numbers) != 3:
        raise EclatError(f"{where}: expected three numbers, one, or #rrggbb, got {text[:60]!r}")
    if encoded:
        numbers = srgb_to_linear(numbers).tolist()
    return Rgb((numbers[0], numbers[1], numbers[2]))


def parse_spectrum(text: str, where: str) -> Color:
    """A spectrum from one number, three numbers (linear sRGB), hexadecimal sRGB, or `wavelength:value` pairs."""
    if ":" not in text:
        if text.strip().startswith("#"):
            return parse_rgb(text, where)
        numbers = parse_numbers(text, where)
        if len(numbers) == 1:
            return Uniform(numbers[0])
        if len(numbers) == 3:
            return Rgb((numbers[0], numbers[1], numbers[2]))
        raise EclatError(f"{where}: expected one number, three, or wavelength:value pairs, got {len(numbers)} numbers")
    pairs = []
    for part in re.split(r"[\s,;]+", re.sub(r"\s*:\s*", ":", text)):
        if part:
            wavelength, _, value = part.partition(":")
            pairs.append((parse_number(wavelength, where), parse_number(value, where)))
    return curve(pairs, where)


def parse_blackbody(temperature: str, scale: float, where: str) -> Blackbody:
    """A temperature in kelvin, written with or without a K."""
    return Blackbody(parse_number(temperature.strip().rstrip("kK"), where), scale)


def curve(pairs: list[tuple[float, float]], where: str) -> Curve:
    """A curve through (wavelength, value) pairs, sorted; of equal wavelengths the first stays, with a warning."""
    ordered = sorted(pairs, key=lambda pair: pair[0])
    if ordered != pairs:
        warn(f"{where}: the wavelengths are not in increasing order; they are sorted")
    unique = [pair for i, pair in enumerate(ordered) if i == 0 or pair[0] > ordered[i - 1][0]]
    if len(unique) != len(ordered):
        warn(f"{where}: {len(ordered) - len(unique)} wavelengths appear twice; the first value counts")
    if not unique:
        raise EclatError(f"{where}: expected wavelength:value pairs, got none")
    return Curve(tuple(pair[0] for pair in unique), tuple(pair[1] for pair in unique))


def read_spd(path: Path, where: str) -> Curve:
    """Read a file of lines `wavelength value`, in which # begins a comment. Raises EclatError with file and line."""
    text = read_bytes(path, where=where, limit=_MAX_SPD_BYTES).decode("utf-8", "replace")
    pairs = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = re.split(r"[\s,;:]+", line.partition("#")[0].strip())
        if words == [""]:
            continue
        here = f"{path.name}:{number}"
        if len(words) != 2:
            raise EclatError(f"{here}: expected a wavelength and a value, got {line[:60]!r}")
        pairs.append((parse_number(words[0], here), parse_number(words[1], here)))
    return curve(pairs, f"{where}, {path.name}")


def check_curve(wavelengths: list[float], values: list[float], where: str) -> Curve:
    """A curve from two lists of the same length. Raises EclatError."""
    if len(wavelengths) != len(values):
        raise EclatError(f"{where}: expected as many wavelengths as values, got {len(wavelengths)} and {len(values)}")
    pairs = zip(wavelengths, values, strict=True)
    return curve([(check_number(wavelength, where), check_number(value, where)) for wavelength, value in pairs], where)
