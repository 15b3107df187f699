# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read files of measured BRDFs: those of MERL (.binary) [Matusik03], and those of RGL (.bsdf) [DupuyJakob18]."""

from __future__ import annotations

import hashlib
import math
import os
import struct
import weakref
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, did_you_mean, shown, warn
from eclat.loaders.files import read_bytes
from eclat.measure.spectrum import reflectance_weights
from eclat.measured_brdf import MERL_SHAPE, MeasuredBrdf, MerlBrdf, RglBrdf
from eclat.typed import typed

LARGEST_FILE = 1 << 30
"""The largest number of bytes of a file. A file of MERL has 35 MB, the largest of RGL some hundred."""

MERL_SCALES = (1 / 1500, 1.15 / 1500, 1.66 / 1500)
"""The unit of the numbers of a file of MERL in sr⁻¹, for red, green and blue [Matusik03, BRDFRead.cpp of the database]."""

MAGIC = b"tensor_file\0"
"""The first bytes of a file of RGL."""
_TYPES = {1: "u1", 2: "i1", 3: "<u2", 4: "<i2", 5: "<u4", 6: "<i4", 7: "<u8", 8: "<i8", 9: "<f2", 10: "<f4", 11: "<f8"}
_in_use: weakref.WeakValueDictionary[tuple[bytes, str], MeasuredBrdf] = weakref.WeakValueDictionary()
_MOST_FIELDS, _MOST_DIMENSIONS = 64, 8
_DIMENSIONS = {"phi_i": 1, "theta_i": 1, "ndf": 2, "sigma": 2, "vndf": 4, "luminance": 4}


@typed
def load_brdf(path: str | os.PathLike[str]) -> MeasuredBrdf:
    """Load a measured BRDF: a file of MERL (.binary) or of RGL (.bsdf), spectral or RGB. The content decides which it is.

    Spectra become linear sRGB as a reflector under D65 has. Cells of MERL without a measurement, which the file marks by negative
    numbers, take the value of the nearest cell with a smaller θ_d, or 0.

    Raises
    ------
    EclatError : the file cannot be read, is truncated, or is of neither kind.
    """
    path = Path(path)
    return parse_brdf(read_bytes(path, where=path.name, limit=LARGEST_FILE), path.name)


def parse_brdf(data: bytes, where: str) -> MeasuredBrdf:
    """Read the bytes of a file; `where` names it in messages. Warnings and errors are those of `load_brdf`.

    As long as something uses the result, the same bytes give the same object, so that materials share it.
    """
    key = (hashlib.sha256(data).digest(), where)
    brdf = _in_use.get(key)
    if brdf is None:
        brdf = _in_use[key] = _rgl(data, where) if data.startswith(MAGIC) else _merl(data, where)
    return brdf


def _merl(data: bytes, where: str) -> MerlBrdf:
    if len(data) < 12:
        raise EclatError(f"{where}: expected a measured BRDF of MERL or RGL, got {len(data)} bytes")
    dimensions = struct.unpack_from("<3i", data)
    if dimensions != MERL_SHAPE[1:]:
        raise EclatError(
            f"{where}: expected a measured BRDF of MERL, which begins with the numbers 90, 90 and 180, or of RGL, "
            f"got one that begins with {', '.join(map(str, dimensions))}"
        )
    count = math.prod(MERL_SHAPE)
    if len(data) != 12 + 8 * count:
        raise EclatError(f"{where}: expected {12 + 8 * count:,} bytes, got {len(data):,}")
    numbers = np.frombuffer(data, "<f8", count, 12).reshape(MERL_SHAPE)
    bad = int(np.count_nonzero(~np.isfinite(numbers)))
    if bad:
        warn(f"{where}: {bad:,} of {count:,} numbers are not finite and count as not measured")
    with np.errstate(over="ignore", invalid="ignore"):
        values = (numbers * np.reshape(MERL_SCALES, (3, 1, 1, 1))).astype(np.float32)
    measured = np.isfinite(values).all(axis=0) & (values >= 0).all(axis=0)
    if not measured.any():
        raise EclatError(f"{where}: expected measurements, got none")
    return MerlBrdf(_filled(values, measured), Path(where).stem)


def _filled(values: NDArray[np.float32], measured: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Give cells that were not `measured` (90, 90, 180) the value of the nearest one with a smaller θ_d, or 0."""
    index = np.where(measured, np.arange(MERL_SHAPE[2])[:, None], -1)
    last = np.maximum.accumulate(index, axis=1)
    taken = np.take_along_axis(values, np.maximum(last, 0)[None], axis=2)
    return np.where(last[None] >= 0, taken, np.float32(0))


def _rgl(data: bytes, where: str) -> RglBrdf:
    fields = read_tensors(data, where)
    for name, count in _DIMENSIONS.items():
        _require(fields, name, count, where)
    luminance = fields["luminance"]
    if "rgb" in fields:
        channels = np.moveaxis(_require(fields, "rgb", 5, where), 2, 0)
    else:
        spectra, wavelengths = _require(fields, "spectra", 5, where), _require(fields, "wavelengths", 1, where)
        if spectra.shape[2] != len(wavelengths):
            raise EclatError(
                f"{where}: expected as many spectra as wavelengths, got {spectra.shape[2]} and {len(wavelengths)}"
            )
        try:
            weights = reflectance_weights(wavelengths).astype(np.float32)
        except EclatError as error:
            raise EclatError(f"{where}: {error}") from None
        channels = np.einsum("cl,ptlhw->cpthw", weights, spectra, optimize=True)
    jacobian = fields.get("jacobian")
    return RglBrdf(
        phi=fields["phi_i"], theta=fields["theta_i"], normals=fields["ndf"], projected=fields["sigma"],
        visible=fields["vndf"], luminance=luminance, channels=channels,
        jacobian=bool(jacobian is not None and jacobian.any()), name=Path(where).stem,
    )  # fmt: skip


def _require(fields: Mapping[str, NDArray[Any]], name: str, dimensions: int, where: str) -> NDArray[Any]:
    """Return a field. Raises EclatError if it is missing or has other dimensions."""
    if name not in fields:
        raise EclatError(f"{where}: expected the field {name!r}, got {', '.join(fields)}{did_you_mean(name, fields)}")
    if fields[name].ndim != dimensions:
        raise EclatError(f"{where}, {name}: expected {dimensions} dimensions, got the shape {fields[name].shape}")
    return fields[name]


def read_tensors(data: bytes, where: str) -> dict[str, NDArray[Any]]:
    """Read the arrays by name of a file that begins with `MAGIC`: a version, and for each array a name, the number of dimensions,
    the type, the offset and the shape, all little endian.

    Raises EclatError if the file is truncated or has another version or type.
    """
    try:
        (*version, count) = struct.unpack_from("<2BI", data, len(MAGIC))
        if version != [1, 0] or count > _MOST_FIELDS:
            raise EclatError(
                f"{where}: expected version 1.0 of the format, got {version[0]}.{version[1]} with {count} fields"
            )
        at, fields = len(MAGIC) + 6, {}
        for _ in range(count):
            (length,) = struct.unpack_from("<H", data, at)
            name = data[at + 2 : at + 2 + length].decode("utf-8", "replace")
            at += 2 + length
            dimensions, kind, offset = struct.unpack_from("<HBQ", data, at)
            if dimensions > _MOST_DIMENSIONS or kind not in _TYPES:
                raise EclatError(f"{where}, {shown(name)}: expected an array of numbers, got the type {kind}")
            shape = struct.unpack_from(f"<{dimensions}Q", data, at + 11)
            at += 11 + 8 * dimensions
            dtype = np.dtype(_TYPES[kind])
            size = math.prod(shape)
            if offset + size * dtype.itemsize > len(data):
                raise EclatError(f"{where}, {shown(name)}: expected {size:,} numbers, got the end of the file")
            fields[name] = np.frombuffer(data, dtype, size, offset).reshape(shape)
    except struct.error:
        raise EclatError(f"{where}: expected a list of arrays, got the end of the file") from None
    return fields
