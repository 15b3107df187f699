# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Parse colours and spectra, and convert them to linear sRGB.

The conversion depends on the role of the colour: a reflectance or an emission.
"""

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
from eclat.loaders.text_files import utf8
from eclat.measure.spectrum import blackbody_to_rgb, emission_to_rgb, reflectance_to_rgb, srgb_to_linear

Role = Literal["reflectance", "emission"]

_MAX_SPD_BYTES = 1 << 24
"""The largest size of a file with a spectrum, in bytes. Real ones have a few kilobytes."""
_HEX = re.compile(r"#([0-9a-fA-F]{6}|[0-9a-fA-F]{3})")


def to_rgb(color: Color, role: Role, where: str, legacy: bool = False) -> Vector:
    """Convert `color` to linear sRGB.

    A reflectance is converted under the illuminant D65, so that a constant spectrum is grey. An emission, and the eta
    and k of a metal, are converted without an illuminant: a constant spectrum is then equal-energy white, which is
    reddish in sRGB, as in the RGB mode of Mitsuba 3. In `legacy` files of version 0.x it is grey.

    Raises
    ------
    EclatError : the spectrum cannot be converted. The message starts with `where`.
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
    """Parse a colour from three numbers, one number for grey, or `#rrggbb`.

    Hexadecimal colours are sRGB and are converted to linear. So are numbers if `encoded`. Raises EclatError.
    """
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
        raise EclatError(f"{where}: expected three numbers, one number, or #rrggbb, got {text[:60]!r}")
    if encoded:
        numbers = srgb_to_linear(numbers).tolist()
    return Rgb((numbers[0], numbers[1], numbers[2]))


def parse_spectrum(text: str, where: str) -> Color:
    """Parse a spectrum from one number, three numbers (linear sRGB), hexadecimal sRGB, or `wavelength:value` pairs.

    Wavelengths are in nanometres. Raises EclatError.
    """
    if ":" not in text:
        if text.strip().startswith("#"):
            return parse_rgb(text, where)
        numbers = parse_numbers(text, where)
        if len(numbers) == 1:
            return Uniform(numbers[0])
        if len(numbers) == 3:
            return Rgb((numbers[0], numbers[1], numbers[2]))
        raise EclatError(
            f"{where}: expected one number, three numbers, or wavelength:value pairs, got {len(numbers)} numbers"
        )
    pairs = []
    for part in re.split(r"[\s,;]+", re.sub(r"\s*:\s*", ":", text)):
        if part:
            wavelength, _, value = part.partition(":")
            pairs.append((parse_number(wavelength, where), parse_number(value, where)))
    return curve(pairs, where)


def parse_blackbody(temperature: str, scale: float, where: str) -> Blackbody:
    """Parse a temperature in kelvin, with or without the unit K. `scale` multiplies the radiance. Raises EclatError."""
    return Blackbody(parse_number(temperature.strip().rstrip("kK"), where), scale)


def curve(pairs: list[tuple[float, float]], where: str) -> Curve:
    """Build a spectrum from pairs of a wavelength in nanometres and a value.

    Pairs that are not sorted are sorted, with a warning. If a wavelength occurs several times, its first value is used,
    with a warning. Raises EclatError if there are no pairs.
    """
    ordered = sorted(pairs, key=lambda pair: pair[0])
    if ordered != pairs:
        warn(f"{where}: the wavelengths are not in increasing order, so they are sorted")
    unique = [pair for i, pair in enumerate(ordered) if i == 0 or pair[0] > ordered[i - 1][0]]
    if len(unique) != len(ordered):
        warn(
            f"{where}: expected each wavelength once, but {len(ordered) - len(unique)} of {len(ordered)} entries repeat "
            "an earlier one; the first value of each wavelength is used"
        )
    if not unique:
        raise EclatError(f"{where}: expected wavelength:value pairs, got none")
    return Curve(tuple(pair[0] for pair in unique), tuple(pair[1] for pair in unique))


def read_spd(path: Path, where: str) -> Curve:
    """Read a spectrum from a text file whose lines contain a wavelength in nanometres and a value.

    The character # starts a comment. Raises EclatError with the file and the line.
    """
    text = utf8(read_bytes(path, where=where, limit=_MAX_SPD_BYTES), path.name).decode("utf-8", "replace")
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
    """Build a spectrum from a list of wavelengths in nanometres and a list of values.

    Raises EclatError if the lists have different lengths or are empty, or if a number is not finite.
    """
    if len(wavelengths) != len(values):
        raise EclatError(f"{where}: expected as many wavelengths as values, got {len(wavelengths)} and {len(values)}")
    pairs = zip(wavelengths, values, strict=True)
    return curve([(check_number(wavelength, where), check_number(value, where)) for wavelength, value in pairs], where)
