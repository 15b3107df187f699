# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records of radiance as rows of floats: the row of a record of irradiance, then the coefficients of its light.

Of order n there are 9 n² coefficients: the values of each colour channel, then the derivatives of each along u, then along v.
The core has them in the frame around the record's normal; on surfaces that move they are kept in a frame that turns with the
surface, which has the same normal, so that both differ by a turn about it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.bridge.anchors import Numbers, Posed
from eclat.methods.records.solution import RadianceRecords

RECORD = _core.SolvedCaches().near.shape[1]
"""The number of floats of a record of irradiance."""
_NORMALS = next(slice(first, first + count) for name, first, count in _core.record_layout() if name == "normals")

Rows = NDArray[np.float32]


def order_of(rows: Rows) -> int:
    """Return the order of the coefficients in rows, 0 if these are of records of irradiance."""
    return math.isqrt((rows.shape[1] - RECORD) // 9)


def rows_of(records: RadianceRecords, order: int) -> Rows:
    """Return records of radiance as rows."""
    if not len(records):
        return np.zeros((0, RECORD + 9 * order**2), np.float32)
    gradients = (records.gradients.astype(np.uint32) << 16).view(np.float32)
    parts = [a.reshape(len(records), k, -1)[:, :, : order**2] for a, k in ((records.values, 3), (gradients, 6))]
    return np.concatenate([records.records, *(part.reshape(len(records), -1) for part in parts)], axis=1)


def records_of(rows: Rows) -> RadianceRecords:
    """Return rows as records of radiance, as the core keeps them: padded to multiples of eight, and gradients as upper
    halves."""
    count = order_of(rows) ** 2
    padded = np.zeros((len(rows), 9, -(-count // 8) * 8), np.float32)
    padded[:, :, :count] = rows[:, RECORD:].reshape(len(rows), 9, count)
    values, gradients = padded[:, :3], np.ascontiguousarray(padded[:, 3:])
    halves = ((gradients.view(np.uint32) + np.uint32(0x8000)) >> np.uint32(16)).astype(np.uint16)
    flat = (len(rows), -1) if len(rows) else (0, 0)
    return RadianceRecords(
        np.ascontiguousarray(rows[:, :RECORD]), np.ascontiguousarray(values).reshape(flat), halves.reshape(flat)
    )


def luminances(rows: Rows) -> NDArray[np.float64]:
    """Return the coefficients (N, n²) of the luminance of the light."""
    count = order_of(rows) ** 2
    values = rows[:, RECORD : RECORD + 3 * count].reshape(len(rows), 3, count).astype(np.float64)
    return np.asarray(np.einsum("c,nck->nk", [0.2126, 0.7152, 0.0722], values))


def turn_with_surfaces(rows: Rows, which: NDArray[np.bool_], posed: Posed, *, into_surface: bool) -> None:
    """Turn the coefficients of some rows, in place, from the frames around their normals into those of their surfaces, or
    back."""
    order = order_of(rows)
    if not order or not which.any():
        return
    around = _core.tangents_around(np.ascontiguousarray(rows[which, _NORMALS])).astype(np.float64)
    along, across = posed.frames[which, :, 0], posed.frames[which, :, 1]
    cosine, sine = (np.einsum("ni,ni->n", around, axis) for axis in (along, across))
    angle = np.arctan2(sine if into_surface else -sine, cosine)
    rows[which, RECORD:] = _turned(rows[which, RECORD:].astype(np.float64), order, angle)


def _turned(coefficients: Numbers, order: int, angle: Numbers) -> NDArray[np.float32]:
    """Turn coefficients (N, 9 n²) about the normal by angles (N,): of the functions, and of the directions of gradients."""
    parts = coefficients.reshape(len(coefficients), 9, order**2)
    out = parts.copy()
    for degree in range(1, order):
        for m in range(1, degree + 1):
            cosine, sine = np.cos(m * angle)[:, None], np.sin(m * angle)[:, None]
            middle = degree * (degree + 1)
            even, odd = parts[:, :, middle + m], parts[:, :, middle - m]
            out[:, :, middle + m] = cosine * even - sine * odd
            out[:, :, middle - m] = sine * even + cosine * odd
    cosine, sine = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
    u, v = out[:, 3:6].copy(), out[:, 6:9].copy()
    out[:, 3:6], out[:, 6:9] = cosine * u - sine * v, sine * u + cosine * v
    return np.asarray(out.reshape(len(out), -1), np.float32)
