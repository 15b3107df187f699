# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What a record sees: radiance and distances over its hemisphere, and the same radiance as harmonics.

The maps are SIDE × SIDE on the paraboloid, as the images of `gloss`: (x, y) = ω_xy / (1 + ω_z) from −1 to 1 in the frame
around the normal that `Frame::around` of the core makes. A message of the kind `hemisphere` has the `number` of the request,
`order`, and the arrays

    radiance       (SIDE, SIDE, 3) W·m⁻²·sr⁻¹, by paths, lamps included; 0 outside the disc
    distances      (SIDE, SIDE) m to what is seen; 0 where nothing is, and outside the disc
    coefficients   (order², 3) ∫ L B_i dω with the basis of records of radiance
    basis          (SIDE · SIDE, order²) values of that basis at the texels
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eclat import _core, harmonics
from eclat.scene import FloatArray
from eclat.viewer.lamp_gloss import frames, to_orthonormal

SIDE = 48
"""Texels along a side of the maps."""

FACE = 48
"""Pixels along a side of the pictures from which the maps are read: five sides of a cube, as wide as the texels of the middle."""

SAMPLES = 32
"""Paths of a pixel, which take about a quarter of a million for a hemisphere: a fraction of a second."""

ORDER = 8
"""Order of the harmonics."""


@dataclass(frozen=True)
class Hemisphere:
    """What a point sees; the arrays are those of the message."""

    radiance: np.ndarray
    distances: np.ndarray
    coefficients: np.ndarray
    basis: np.ndarray

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays of the message."""
        names = ("radiance", "distances", "coefficients", "basis")
        return {name: np.ascontiguousarray(getattr(self, name), np.float32) for name in names}


def texel_directions() -> tuple[FloatArray, FloatArray]:
    """Return the directions (SIDE², 3) of the texels, row by row, and their solid angles (SIDE²,), 0 outside the disc."""
    side = (np.arange(SIDE) + 0.5) * (2 / SIDE) - 1
    x, y = (part.ravel() for part in np.meshgrid(side, side))
    square = x**2 + y**2
    directions = np.stack([2 * x, 2 * y, 1 - square], axis=1) / (1 + square)[:, None]
    solid_angles = np.where(square < 1, 4 / (1 + square) ** 2 * (2 / SIDE) ** 2, 0)
    return directions, solid_angles


def look_around(
    estimator: _core.Estimator, place: FloatArray, normal: FloatArray, *, lift: float, threads: int = 0
) -> Hemisphere:
    """Render the hemisphere of a point.

    Parameters
    ----------
    estimator : of radiance along rays.
    place, normal : (3,) relative to the center of the scene; the normal has length 1.
    lift : the distance in metres from the surface at which the rays start, so that they leave it.
    """
    u, v = (axis[0] for axis in frames(normal[None]))
    world = np.stack([u, v, normal])  # rows: axes of the frame
    local, solid_angles = texel_directions()
    radiance, distances = np.zeros((SIDE**2, 3)), np.zeros(SIDE**2)
    directions = np.array([(0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)], float)
    faces = (local @ directions.T).argmax(axis=1)
    for face, ahead in enumerate(directions):
        up = np.array([0, 1, 0]) if face == 0 else np.array([0, 0, 1])
        axes = np.stack([np.cross(ahead, up), up, -ahead])  # right, up, backward, in the frame
        mine = np.flatnonzero(faces == face)
        film = _face(estimator, place + lift * normal, axes @ world, threads)
        across = local[mine] @ axes.T  # along right, up and backward
        at = np.clip((0.5 + 0.5 * across[:, :2] / -across[:, 2:] * (1, -1)) * FACE, 0, FACE - 1).astype(int)
        radiance[mine] = np.asarray(film.radiance)[at[:, 1], at[:, 0]]
        depth = np.asarray(film.depth)[at[:, 1], at[:, 0]]
        distances[mine] = np.where(np.isfinite(depth), depth, 0)
    inside = solid_angles > 0
    radiance[~inside], distances[~inside] = 0, 0
    # Directions below the horizon are turned to it: nothing of them is shown.
    upper = np.where(inside[:, None], local, (0, 0, 1))
    basis = harmonics.evaluate("spherical", ORDER, upper) @ to_orthonormal(ORDER).T
    basis[~inside] = 0
    coefficients = basis.T @ (radiance * solid_angles[:, None])
    return Hemisphere(radiance.reshape(SIDE, SIDE, 3), distances.reshape(SIDE, SIDE), coefficients, basis)


def _face(estimator: _core.Estimator, place: FloatArray, axes: FloatArray, threads: int) -> _core.Film:
    camera = _core.Camera(
        axes=tuple(tuple(map(float, axis)) for axis in axes),
        position=tuple(map(float, place)),
        size=(FACE, FACE),
        half_extent=(1.0, 1.0),
        shift=(0.0, 0.0),
        lens=(0.0, 1.0),
        orthographic=False,
    )
    film = _core.Film(FACE, FACE)
    pixels = _core.RenderRange(crop=(0, 0, FACE, FACE), seed=0, threads=threads, filter=_core.Filter.box, tile_order=[])
    begins, ends = (np.array([n], np.uint32) for n in (0, SAMPLES))
    _core.render(camera, film, estimator, pixels, begins, ends, _core.Progress())
    return film
