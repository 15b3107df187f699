# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records of radiance for the page, which makes a small image of each: what its surface reflects towards the directions of
a grid over the hemisphere.

The light that a record reflects towards ω is the dot product of its coefficients with the factors of the lobe towards ω. In the
frame around its normal these factors are the same for all records on a material, so each record is turned into an image
once, and a fragment only reads that image. The grid is GRID × GRID on the paraboloid: (x, y) = ω_xy / (1 + ω_z), from −1 to 1.

A message of the kind `gloss` has `first`, `count`, `reading` and `rows` as one of `records` (without excess and gradients in
the rows), `order`, `grid`, and the arrays

    lobe_of        (n,) index of the lobe of each record
    coefficients   (n, 3, order², 4) values, derivatives along u and along v of the frame around the normal; RGB and 0, in
                   W/m² and W/m³, of indirect and direct light (see `lamp_gloss`); the excess is apart, in the rows
    lobes          (lobes · GRID², order² + 1, 4) factors; RGB and 0; the last entry is the albedo and the width σ of the lobe,
                   which is 0 where it may not be cached
"""

from __future__ import annotations

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


def gloss_message(scene: Scene, solution: Solution) -> bytes:
    """Encode the records of radiance of a solution; there are none if it is of irradiance caching."""
    options = solution.options
    order = options.order if isinstance(options, RadianceOptions) else 1
    arrays = {
        "rows": np.zeros((0, ROW), np.float32),
        "lobe_of": np.zeros(0, np.float32),
        "coefficients": np.zeros((0, 3, order**2, 4), np.float32),
        "lobes": np.zeros((0, order**2 + 1, 4), np.float32),
    }
    if isinstance(options, RadianceOptions) and solution.radiance is not None and len(solution.radiance):
        arrays = _arrays(scene, solution, options)
    reading = reading_of(solution)
    if isinstance(options, RadianceOptions):
        reading["spacing"] = float(core_radiance_options(options).spacing)
    content = {"first": 0, "count": len(arrays["rows"]), "reading": reading}
    return encode_message("gloss", content | {"order": order, "grid": GRID}, arrays)


def _arrays(scene: Scene, solution: Solution, options: RadianceOptions) -> dict[str, np.ndarray]:
    caches = solution.core()
    tables = radiance_tables(scene, options)
    found = _core.lobes_at_records(compiled(scene).core, caches, tables, grid_directions())
    lobe_of, factors, widths, albedos = (np.asarray(part) for part in found)
    spacing = core_radiance_options(options).spacing
    rows, read = rows_of(np.asarray(caches.radiance_records), np.asarray(caches.radiance_shared_excess), spacing)
    kept = lobe_of[read] >= 0
    numbers = np.flatnonzero(read)[kept]
    coefficients = coefficients_of(caches, options.order)[numbers]
    positions, radii, normals = rows[kept, :3], rows[kept, 3], rows[kept, 4:7]
    coefficients[..., :3] += direct_coefficients(scene, positions, normals, radii, options.order)
    return {
        "rows": rows[kept],
        "lobe_of": lobe_of[numbers],
        "coefficients": coefficients,
        "lobes": _lobes(factors, widths, albedos),
    }


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
