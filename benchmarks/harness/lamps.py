# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The flat faces of an emitting mesh, for renderers whose area lights are rectangles and discs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eclat.scene import Mesh
from harness.unavailable import UnavailableError

Float64 = NDArray[np.float64]
SAME = 1e-4
"""Relative tolerance of "the same plane" and "the same distance"."""


@dataclass(frozen=True, eq=False)
class Lamp:
    """A parallelogram that two edges span about its centre, or a disc (`circular`) that touches its four sides."""

    centre: Float64
    normal: Float64
    across: Float64
    along: Float64
    area: float
    circular: bool

    def corners(self) -> Float64:
        """(4, 3), counter-clockwise about the normal."""
        signs = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
        if np.dot(np.cross(self.across, self.along), self.normal) < 0:
            signs = signs[::-1]
        return np.asarray(self.centre + signs[:, :1] * self.across + signs[:, 1:] * self.along)


def lamps(mesh: Mesh) -> list[Lamp]:
    """Raises UnavailableError where a face is neither a parallelogram nor a disc."""
    corners = np.asarray(mesh.positions, np.float64)[mesh.triangles]
    products = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(products, axis=1)
    corners, products, lengths = (array[lengths > 0] for array in (corners, products, lengths))
    normals = products / lengths[:, None]
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    heights = (normals * corners[:, 0]).sum(axis=1)
    faces: list[Lamp] = []
    left = np.ones(len(corners), bool)
    while left.any():
        first = int(np.argmax(left))
        flat = left & (normals @ normals[first] > 1 - SAME) & (np.abs(heights - heights[first]) < SAME * size)
        faces.append(_lamp(mesh, corners[flat].reshape(-1, 3), normals[first], float(lengths[flat].sum()) / 2))
        left &= ~flat
    return faces


def _lamp(mesh: Mesh, points: Float64, normal: Float64, area: float) -> Lamp:
    distinct = np.unique(points.round(9), axis=0)
    if len(distinct) == 4:
        order = np.argsort(np.linalg.norm(distinct - distinct[0], axis=1))
        across, along = distinct[order[1]] - distinct[0], distinct[order[2]] - distinct[0]
        if abs(float(np.linalg.norm(np.cross(across, along))) - area) < SAME * area:
            return Lamp(distinct.mean(axis=0), normal, across, along, area, False)
    centre = (distinct.max(axis=0) + distinct.min(axis=0)) / 2
    radius = float(np.linalg.norm(distinct - centre, axis=1).max())
    if len(distinct) > 12 and abs(area / (np.pi * radius**2) - 1) < 0.05:
        radius = float(np.sqrt(area / np.pi))
        across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
        across *= 2 * radius / np.linalg.norm(across)
        return Lamp(centre, normal, across, np.cross(normal, across), area, True)
    raise UnavailableError(f"emitter {mesh.name!r} is neither a parallelogram nor a disc")
