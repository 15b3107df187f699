# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records of irradiance as rows of floats, from which the page draws a splat each.

A row has 13 groups of four numbers, which are texels of a texture in the page (`web/view/src/shaders/records.ts`):

    0        position (relative to the center of the scene), radius R
    1        normal n, least clearance of all sectors
    2        stretch: a vector along the long axis, of length √(1 − 1/elongation²); elongation
    3        irradiance E, first channel of the excess X (shared with the records around)
    4        the other two channels of X, then y and z of the third channel of ∇_t E
    5, 6, 7  ∇_r E of a channel; x, y or z of the first channel of ∇_t E
    8        the second channel of ∇_t E, x of the third
    9..11    clearance in each of the twelve sectors around n
    12       length ℓ that the radius follows, relative noise of the value, radius before neighbours bound it (with the sign
             of the z of n, for −0), curvature λ

Radii and excess are those of the core, which clamps a radius to those of the neighbours, and shares the excess with
them, whenever it takes records in.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eclat import _core
from eclat.methods.records.laws import core_options
from eclat.methods.records.solution import Solution
from eclat.viewer.messages import encode_message

ROW = 52
"""Number of floats of a record."""

_COLUMNS = {name: slice(first, first + count) for name, first, count in _core.record_layout()}

_FARTHEST = np.float32(1e30)
"""Stands for infinite lengths, because not all graphics drivers compare infinities as the standard asks."""


def records_message(solution: Solution, *, first: int = 0) -> bytes:
    """Encode the records of a solution from the record `first` on, without those inside solids, which are not read."""
    rows = record_rows(solution.core(), core_options(solution.options).spacing)
    content = {"first": first, "count": len(rows), "reading": reading_of(solution)}
    return encode_message("records", content, {"rows": rows[first:]})


def reading_of(solution: Solution) -> dict[str, Any]:
    """Return how the records are read: their weight, relaxation, gradients and spacing."""
    options = core_options(solution.options)
    return {
        "weight": solution.options.weight,
        "relaxation": float(options.relaxation),
        "rotation_gradient": bool(options.rotation_gradient),
        "translation_gradient": bool(options.translation_gradient),
        "spacing": float(options.spacing),
        "method": solution.options.name,
    }


def record_rows(caches: _core.SolvedCaches, spacing: float) -> np.ndarray:
    """Return the rows (N, 52) float32 of the near records that are read, in their order; `spacing` is as for `rows_of`."""
    return rows_of(np.asarray(caches.near), np.asarray(caches.near_shared_excess), spacing)[0]


def rows_of(records: np.ndarray, shared_excess: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the rows (M, 52) float32 of the records that are read, and which of all (N,) these are.

    Parameters
    ----------
    records : (N, floats) as the core gives them.
    shared_excess : (N, 3) the excess of each, averaged over the records around it.
    spacing : the radius of a record whose radius follows a length of 1 m.
    """
    read = records[:, _COLUMNS["enclosed"]][:, 0] == 0
    near, shared = records[read], shared_excess[read]
    field = {name: near[:, columns] for name, columns in _COLUMNS.items()}
    normal = field["normals"]
    elongation = field["elongations"]
    turning = field["rotation_gradients"].reshape(-1, 3, 3)
    moving = field["translation_gradients"].reshape(-1, 3, 3)
    clearance = field["clearances"]
    alone = np.clip(spacing * field["distances"], field["least_radii"], field["largest_radii"])
    rows = np.concatenate(
        [
            field["positions"], field["radii"],
            normal, clearance.min(axis=1, keepdims=True, initial=np.inf),
            stretches(normal, field["axes"][:, 0], elongation[:, 0]), elongation,
            field["irradiance"], shared[:, :1],
            shared[:, 1:], moving[:, 2, 1:],
            turning[:, 0], moving[:, 0, :1],
            turning[:, 1], moving[:, 0, 1:2],
            turning[:, 2], moving[:, 0, 2:],
            moving[:, 1], moving[:, 2, :1],
            clearance,
            field["distances"], field["noises"], np.copysign(alone, normal[:, 2:]), field["curvatures"],
        ],
        axis=1,
    ).astype(np.float32)  # fmt: skip
    return np.clip(rows, -_FARTHEST, _FARTHEST), read


def stretches(normal: np.ndarray, axis: np.ndarray, elongation: np.ndarray) -> np.ndarray:
    """Return the vectors (N, 3) by which distances along the long axes are reduced, as in `records/weight.h`.

    `normal` is (N, 3); `axis`, the angle of the long axis in radians, and `elongation` are (N,).
    """
    sign = np.copysign(np.float32(1), normal[:, 2])
    x, y, z = normal.T
    a = -1 / (sign + z)
    b = x * y * a
    u = np.stack([1 + sign * x * x * a, sign * b, -sign * x], axis=1)
    v = np.stack([b, sign + y * y * a, -y], axis=1)
    along = u * np.cos(axis)[:, None] + v * np.sin(axis)[:, None]
    length = np.sqrt(np.maximum(0, 1 - 1 / np.square(elongation)))[:, None]
    found: np.ndarray = along * length
    return found
