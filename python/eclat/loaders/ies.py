# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read photometric files of luminaires, IES LM-63 of 1986 to 2019 [IES19]."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, shown, warn
from eclat.intensity_profile import IntensityProfile
from eclat.loaders.files import read_bytes
from eclat.loaders.text_files import utf8
from eclat.typed import typed

LARGEST_FILE = 1 << 26
"""The largest number of bytes of a file. A measurement each half degree has 0.26 million numbers, which take about 2 MB."""

_TYPES: dict[int, Literal["A", "B", "C"]] = {1: "C", 2: "B", 3: "A"}
_TILT = re.compile(r"^\s*TILT\s*=\s*(.*?)\s*$", re.I | re.M)


@typed
def load_ies(path: str | os.PathLike[str]) -> IntensityProfile:
    """Load the intensities of a luminaire from a photometric file (.ies).

    The candela of the file are multiplied by its candela multiplier and its ballast factors. The size of the luminous opening is
    not used, since a profile is a point. Tilt is ignored, with a warning.

    Raises
    ------
    EclatError : the file cannot be read or is no valid LM-63 file.
    """
    path = Path(path)
    return parse_ies(read_bytes(path, where=path.name, limit=LARGEST_FILE), path.name)


def parse_ies(data: bytes, where: str) -> IntensityProfile:
    """Read the bytes of a photometric file; `where` names it in messages. Warnings and errors are those of `load_ies`."""
    text = utf8(data, where).decode("latin-1")
    tilt = _TILT.search(text)
    if tilt is None:
        raise EclatError(f"{where}: expected a photometric file (LM-63) with a line TILT=, got none")
    numbers = _Numbers(text[tilt.end() :], where)
    if tilt[1].upper() == "INCLUDE":
        numbers.take(1, "geometry of the tilt")
        numbers.take(2 * numbers.count("angles of the tilt"), "angles and factors of the tilt")
    if tilt[1].upper() != "NONE":
        warn(f"{where}: the tilt of the lamp (TILT={shown(tilt[1])}) is not supported and is ignored")
    numbers.take(2, "number and lumens of the lamps")
    (multiplier,) = numbers.take(1, "candela multiplier")
    vertical, horizontal = (numbers.count(f"{which} angles") for which in ("vertical", "horizontal"))
    kind = int(numbers.take(1, "photometric type")[0])
    if kind not in _TYPES:
        raise EclatError(f"{where}: expected the photometric type 1 (C), 2 (B) or 3 (A), got {kind}")
    numbers.take(4, "units and size")
    ballast, photometric, _ = numbers.take(3, "ballast factors and watts")
    factor = float(multiplier * ballast * photometric)
    if not (np.isfinite(factor) and factor >= 0):
        raise EclatError(
            f"{where}: expected multipliers of at least 0, got {multiplier:g}, {ballast:g} and {photometric:g}"
        )
    angles = [numbers.take(count, "angles") for count in (vertical, horizontal)]
    candela = numbers.take(vertical * horizontal, "candela values").reshape(horizontal, vertical) * factor
    if (candela < 0).any():
        warn(f"{where}: negative candela values are replaced by 0")
        candela = np.maximum(candela, 0)
    return IntensityProfile(_TYPES[kind], angles[0], angles[1], candela, Path(where).stem)


def encode_ies(profile: IntensityProfile) -> bytes:
    """Write a profile as a file of LM-63-2002."""
    vertical, horizontal, candela = (np.asarray(a) for a in (profile.vertical, profile.horizontal, profile.candela))
    kind = next(number for number, name in _TYPES.items() if name == profile.photometry)
    rows = [vertical, horizontal, *candela]
    lines = [" ".join(f"{value:.9g}" for value in row) for row in rows]
    head = f"1 -1 1 {len(vertical)} {len(horizontal)} {kind} 2 0 0 0"
    name = "".join(c if " " <= c <= "~" else "?" for c in profile.name) or "profile"
    text = ["IESNA:LM-63-2002", f"[LUMINAIRE] {name}", "TILT=NONE", head, "1 1 0", *_wrapped(lines)]
    return ("\r\n".join(text) + "\r\n").encode("ascii")


def _wrapped(lines: list[str]) -> Iterator[str]:
    """Break lines at blanks to at most 132 characters, the limit of the format [IES19]."""
    for line in lines:
        words, row = line.split(), ""
        for word in words:
            if len(row) + len(word) > 130:
                yield row
                row = ""
            row += (" " if row else "") + word
        yield row


class _Numbers:
    """The numbers of a file, which blanks, ends of lines or commas separate."""

    def __init__(self, text: str, where: str) -> None:
        self._words = text.replace(",", " ").split()
        self._next, self._where = 0, where

    def take(self, count: int, what: str) -> NDArray[np.float64]:
        """Return the next numbers. Raises EclatError if there are fewer, or if one is none."""
        words = self._words[self._next : self._next + count]
        self._next += count
        if len(words) < count:
            raise EclatError(f"{self._where}: expected {count:,} numbers as {what}, got {len(words):,}")
        try:
            numbers = np.array([float(word) for word in words])
        except ValueError:
            raise EclatError(f"{self._where}: expected numbers as {what}, got {shown(' '.join(words))}") from None
        if not np.isfinite(numbers).all():
            raise EclatError(f"{self._where}: expected finite numbers as {what}, got others")
        return numbers

    def count(self, what: str) -> int:
        """Return the next number, which says how many others follow."""
        (number,) = self.take(1, f"number of {what}")
        if number != int(number) or not 1 <= number <= len(self._words):
            raise EclatError(f"{self._where}: expected a number of {what} that fits the file, got {number:g}")
        return int(number)
