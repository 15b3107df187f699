# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records of radiance for the page, which makes a small image of each: what its surface reflects towards the directions of
a grid over the hemisphere.

The light that a record reflects towards ω is the dot product of its coefficients with the factors of the lobe towards ω. In the
frame around its normal these factors are the same for all records on a material, so each record is turned into an image
once, and a fragment only reads that image. The grid is GRID × GRID on the paraboloid: (x, y) = ω_xy / (1 + ω_z), from −1 to 1.

A message of the kind `gloss` has `first`, `count`, `reading` and `rows` as one of `records` (whose gradients are those of
irradiance, which are not read), `order` (0 for irradiance caching), `grid`, and the arrays

    lobe_of        (n,) index of the lobe of each record
    coefficients   (n, 3, order², 4) values, derivatives along u and along v of the frame around the normal; RGB and 0, in
                   W/m² and W/m³, of indirect and direct light (see `lamp_gloss`); the excess is apart, in the rows
    lobes          (lobes · GRID², order² + 1, 4) factors; RGB and 0; the last entry is the albedo and the width σ of the lobe,
                   which is 0 where it may not be cached; without entries if the page has them
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.methods.records.laws import core_radiance_options
from eclat.methods.records.options import RadianceOptions
from eclat.methods.records.radiance_tables import radiance_tables
from eclat.methods.records.solution import Solution
from eclat.scene import Scene
from eclat.viewer.lamp_gloss import direct_coefficients
from eclat.viewer.messages import encode_message
from eclat.viewer.record_rows import ROW, reading_of, rows_of

GRID = 16
"""Directions along a side of the image of a record. Lobes that order 8 can hold are wider than three of its texels."""


def grid_directions() -> np.ndarray:
    """Return the directions (GRID², 3) float32 of the texels, row by row. Those outside the disc are moved to its rim."""
    side = np.linspace(-1, 1, GRID)
    x, y = np.meshgrid(side, side)
    radius = np.hypot(x, y)
    shrink = np.where(radius > 0.999, 0.999 / np.maximum(radius, 1e-9), 1)
    x, y = x * shrink, y * shrink
    square = x**2 + y**2
    directions = np.stack([2 * x, 2 * y, 1 - square], axis=-1) / (1 + square[..., None])
    return np.ascontiguousarray(directions.reshape(-1, 3), np.float32)


@dataclass(frozen=True)
class GlossRecords:
    """Records of radiance for the page. Later ones have more rows; a row may change, what else there is of a record stays."""

    rows: np.ndarray  # (n, 52)
    lobe_of: np.ndarray  # (n,)
    coefficients: np.ndarray  # (n, 3, order², 4)
    lobes: np.ndarray  # (lobes · GRID², order² + 1, 4)


class GlossSource:
    """Makes the records of radiance of caches, which may grow, into those of the page."""

    def __init__(self, scene: Scene, solution: Solution) -> None:
        """Begin with the records of a solution; there are none, and never will be, if it is of irradiance caching."""
        options = solution.options
        self._scene, self._options = scene, options
        self.order = options.order if isinstance(options, RadianceOptions) else 0
        self.reading = reading_of(solution)
        if isinstance(options, RadianceOptions):
            self.reading["spacing"] = float(core_radiance_options(options).spacing)
        count = self.order**2
        self._coefficients = np.zeros((0, 3, count, 4), np.float32)  # with room for more
        self._numbers = np.zeros(0, np.intp)
        self.records = GlossRecords(
            np.zeros((0, ROW), np.float32),
            np.zeros(0, np.float32),
            self._coefficients,
            np.zeros((0, count + 1, 4), np.float32),
        )
        """The records of the last update."""
        if solution.radiance is not None and len(solution.radiance):
            self.update(solution.core())

    def update(self, caches: _core.SolvedCaches) -> GlossRecords:
        """Take in the records that are new in the caches, which must have those of the last update at their beginning."""
        options = self._options
        if not isinstance(options, RadianceOptions) or not len(caches.radiance_records):
            return self.records
        tables = radiance_tables(self._scene, options)
        found = _core.lobes_at_records(compiled(self._scene).core, caches, tables, grid_directions())
        lobe_of, factors, widths, albedos = (np.asarray(part) for part in found)
        rows, read = rows_of(
            np.asarray(caches.radiance_records),
            np.asarray(caches.radiance_shared_excess),
            float(self.reading["spacing"]),
        )
        kept = lobe_of[read] >= 0
        rows, numbers = rows[kept], np.flatnonzero(read)[kept]
        known = len(self._numbers)
        assert np.array_equal(numbers[:known], self._numbers)
        if len(numbers) > known:
            new = coefficients_of(caches, options.order)[numbers[known:]]
            places = rows[known:, :3], rows[known:, 4:7], rows[known:, 3]
            new[..., :3] += direct_coefficients(self._scene, *places, options.order)
            self._append(new, known)
        self._numbers = numbers
        lobes = _lobes(factors, widths, albedos)
        self.records = GlossRecords(rows, lobe_of[numbers], self._coefficients[: len(numbers)], lobes)
        return self.records

    def message(self, records: GlossRecords, first: int, end: int, count: int, *, with_lobes: bool) -> bytes:
        """Encode the records [first, end), after which the page has `count`; the lobes need not be sent again."""
        content = {"first": first, "count": count, "reading": self.reading, "order": self.order, "grid": GRID}
        part = slice(first, end)
        arrays = {
            "rows": records.rows[part],
            "lobe_of": records.lobe_of[part],
            "coefficients": records.coefficients[part],
            "lobes": records.lobes if with_lobes else records.lobes[:0],
        }
        return encode_message("gloss", content, arrays)

    def whole_message(self) -> bytes:
        """Encode all records of the last update."""
        count = len(self.records.rows)
        return self.message(self.records, 0, count, count, with_lobes=True)

    def _append(self, new: np.ndarray, known: int) -> None:
        """Add coefficients after the known ones; arrays that were given away are left as they are."""
        count = known + len(new)
        if count > len(self._coefficients):
            grown = np.zeros((2 * count, *new.shape[1:]), np.float32)
            grown[:known] = self._coefficients[:known]
            self._coefficients = grown
        self._coefficients[known:count] = new


def coefficients_of(caches: _core.SolvedCaches, order: int) -> np.ndarray:
    """Return the coefficients (N, 3, order², 4) of the records of radiance: values, derivatives along u and v."""
    count = order**2
    stride = -(-count // 8) * 8
    values = np.asarray(caches.radiance_values).reshape(-1, 1, 3, stride)
    # The derivatives are the upper halves of floats.
    upper = np.asarray(caches.radiance_gradients).astype(np.uint32) << 16
    derivatives = upper.view(np.float32).reshape(-1, 2, 3, stride)
    both = np.concatenate([values, derivatives], axis=1)[..., :count]
    out = np.zeros((len(both), 3, count, 4), np.float32)
    out[..., :3] = np.moveaxis(both, 2, 3)
    return out


def _lobes(factors: np.ndarray, widths: np.ndarray, albedos: np.ndarray) -> np.ndarray:
    lobes, directions, _, count = factors.shape
    out = np.zeros((lobes * directions, count + 1, 4), np.float32)
    out[:, :count, :3] = np.moveaxis(factors, 2, 3).reshape(-1, count, 3)
    out[:, count, :3] = albedos.reshape(-1, 3)
    out[:, count, 3] = widths.ravel()
    return out
