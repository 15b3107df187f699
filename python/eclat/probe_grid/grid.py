# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A grid of probes, and its files: JSON that engines read without a library, or the same as NumPy arrays."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

import eclat
from eclat.errors import EclatError, shown
from eclat.files.archive import read_archive, write_archive
from eclat.files.arrays import read_file
from eclat.files.atomic_file import write_file
from eclat.probe_grid.quadric import COUNT, irradiance_of
from eclat.scene import FloatArray
from eclat.typed import typed

FORMAT, VERSION = "eclat-probes", 1
"""Name and version of the format of the files."""

SUFFIXES = (".json", ".npz")
"""What the names of files end in."""

LARGEST_FILE = 1 << 31
"""Largest size of a file in bytes: a million probes take 3 · 10⁸ bytes of JSON."""


@dataclass(frozen=True, eq=False)
class ProbeGrid:
    """Incident radiance at the points of a grid, as spherical harmonics.

    Probe [x, y, z] stands at `origin` + (x, y, z) · `spacing`, in metres and world axes. Its `coefficients` (X, Y, Z, 9, 3)
    float32 are ∫ L(ω) Y(ω) dω for each of the nine harmonics of bands 0 to 2, in the order of `eclat.harmonics` and of
    three.js, and for R, G and B; in W·m⁻², or in lux if the scene is photometric (`unit`). `inside` (X, Y, Z) marks the
    probes inside solids, whose coefficients are those of their neighbours. `component` tells which light the probes hold,
    `window` which window was applied. `statistics` holds the counts, rays, seconds and errors, `settings` the options of
    the method.
    """

    origin: FloatArray
    spacing: FloatArray
    coefficients: NDArray[np.float32]
    inside: NDArray[np.bool_]
    component: str
    method: str
    window: str
    unit: str
    statistics: dict[str, float] = field(default_factory=dict)
    settings: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        x, y, z = self.counts
        return f"<ProbeGrid: {x} x {y} x {z} probes, {self.component} light by {self.method}>"

    @property
    def counts(self) -> tuple[int, int, int]:
        """The numbers of probes along x, y and z."""
        x, y, z = self.inside.shape
        return x, y, z

    @property
    def positions(self) -> FloatArray:
        """The positions (X, Y, Z, 3) of the probes in metres, float64."""
        steps = np.stack(np.meshgrid(*(np.arange(n) for n in self.counts), indexing="ij"), axis=-1)
        found: FloatArray = self.origin + steps * self.spacing
        return found

    def at(self, points: ArrayLike) -> FloatArray:
        """Interpolate the coefficients (N, 9, 3) at `points` (N, 3), trilinearly between the eight nearest probes. Points
        outside of the grid get those of its border."""
        places = np.asarray(points, np.float64).reshape(-1, 3)
        last = np.array(self.counts) - 1
        steps = np.divide(places - self.origin, self.spacing, out=np.zeros_like(places), where=self.spacing > 0)
        steps = np.clip(steps, 0, last)
        low = np.minimum(steps.astype(np.int64), np.maximum(last - 1, 0))
        part = steps - low
        found = np.zeros((len(places), COUNT, 3))
        for corner in np.ndindex(2, 2, 2):
            weight = np.prod(np.where(np.array(corner) == 1, part, 1 - part), axis=1)
            x, y, z = np.minimum(low + corner, last).T
            found += weight[:, None, None] * self.coefficients[x, y, z]
        return found

    def irradiance(self, points: ArrayLike, normals: ArrayLike) -> FloatArray:
        """Compute the irradiance (N, 3) on surfaces at `points` (N, 3) with unit `normals` (N, 3), as engines do from
        interpolated coefficients."""
        return irradiance_of(self.at(points), np.asarray(normals, np.float64).reshape(-1, 3))

    def rows(self) -> tuple[FloatArray, NDArray[np.float32]]:
        """Return the positions (N, 3) and the coefficients (N, 9, 3) in the order of files: x changes fastest."""
        return (
            self.positions.transpose(2, 1, 0, 3).reshape(-1, 3),
            self.coefficients.transpose(2, 1, 0, 3, 4).reshape(-1, COUNT, 3),
        )

    def header(self) -> dict[str, Any]:
        """Return everything but the coefficients as JSON-compatible values."""
        return {
            "format": FORMAT,
            "version": VERSION,
            "generator": f"eclat {eclat.__version__}",
            "unit": self.unit,
            "component": self.component,
            "method": self.method,
            "window": self.window,
            "counts": list(self.counts),
            "origin": [float(x) for x in self.origin],
            "spacing": [float(x) for x in self.spacing],
            "inside": np.flatnonzero(self.inside.transpose(2, 1, 0)).tolist(),
            "statistics": self.statistics,
            "settings": self.settings,
        }

    @typed
    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a `.json` or an `.npz` file, either completely or not at all. Both hold the same, to the last bit.

        Raises EclatError if the name has another ending, or the file cannot be written.
        """
        check_name(path)
        _, coefficients = self.rows()
        if Path(path).suffix.lower() == ".npz":
            write_archive(path, self.header(), {"coefficients": coefficients})
            return
        # Nine digits hold a float32 exactly.
        rows = ",\n".join(
            f"[{','.join(f'{v:.9g}' for v in row)}]" for row in coefficients.reshape(-1, 3 * COUNT).tolist()
        )
        header = json.dumps(self.header(), ensure_ascii=False, indent=1, allow_nan=False)
        write_file(path, f'{header[:-2]},\n "coefficients": [\n{rows}\n ]\n}}\n'.encode())

    @classmethod
    @typed
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a file that `save` wrote. Raises EclatError if it cannot be read, is damaged, or is something else."""
        name = os.fspath(path)
        check_name(path)
        if Path(path).suffix.lower() == ".npz":
            header, arrays = read_archive(path)
            values: object = arrays.get("coefficients")
        else:
            header = _json(read_file(path, where=name, limit=LARGEST_FILE), name)
            values = header.pop("coefficients", None)
        return cls._from_parts(header, values, name)

    @classmethod
    def _from_parts(cls, header: dict[str, Any], values: object, name: str) -> Self:
        if header.get("format") != FORMAT:
            raise EclatError(f"{name}: expected a file of probes, whose format is {FORMAT!r}, got something else")
        if header.get("version") != VERSION:
            raise EclatError(f"{name}: expected version {VERSION} of {FORMAT}, got {shown(header.get('version'))}")
        try:
            x, y, z = (int(n) for n in header["counts"])
            coefficients = np.asarray(values, np.float32)
            inside = np.zeros(x * y * z, bool)
            inside[np.asarray(header["inside"], np.int64)] = True
            origin, spacing = (np.asarray(header[key], np.float64) for key in ("origin", "spacing"))
            if min(x, y, z) < 1 or coefficients.size != x * y * z * COUNT * 3 or origin.shape + spacing.shape != (3, 3):
                raise ValueError(f"{coefficients.size} numbers for {x} x {y} x {z} probes of {3 * COUNT}")
            if not all(np.isfinite(part).all() for part in (coefficients, origin, spacing)):
                raise ValueError("numbers that are not finite")
            words = {key: header[key] for key in ("component", "method", "window", "unit")}
            if not all(isinstance(word, str) for word in words.values()):
                raise TypeError("a text is missing")
            return cls(
                origin=origin,
                spacing=spacing,
                coefficients=coefficients.reshape(z, y, x, COUNT, 3).transpose(2, 1, 0, 3, 4).copy(),
                inside=inside.reshape(z, y, x).transpose(2, 1, 0).copy(),
                statistics={str(key): float(value) for key, value in dict(header["statistics"]).items()},
                settings=dict(header["settings"]),
                **words,
            )
        except (KeyError, TypeError, ValueError, IndexError, OverflowError) as error:
            reason = " ".join(str(error).split())[:120]
            raise EclatError(f"{name}: the file of probes is damaged ({reason})") from None


def check_name(path: str | os.PathLike[str]) -> None:
    """Raise EclatError if the name of a file of probes does not end in one of `SUFFIXES`."""
    if Path(path).suffix.lower() not in SUFFIXES:
        raise EclatError(f"{os.fspath(path)}: expected a name that ends in {' or '.join(SUFFIXES)}")


def _json(data: bytes, name: str) -> dict[str, Any]:
    try:
        header = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise EclatError(f"{name}: the file is not JSON, or it is damaged ({str(error)[:120]})") from None
    if not isinstance(header, dict):
        raise EclatError(f"{name}: expected a file of probes, got JSON of another kind")
    return header
