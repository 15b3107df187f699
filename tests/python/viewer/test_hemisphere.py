# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What a record sees: closed forms of a sky, a plane and a lamp, and the same radiance as harmonics."""

from __future__ import annotations

import math

import numpy as np
import pytest

from eclat.bridge.compiled import compiled
from eclat.scene import Environment, FloatArray, Material, Mesh, Scene, rgb
from eclat.viewer.hemisphere import ORDER, SIDE, Hemisphere, look_around, texel_directions
from eclat.viewer.lamp_gloss import frames
from eclat.viewer.truth import by_paths

NORMAL = np.array([0.36, 0.48, 0.8])

TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def square(middle: FloatArray, normal: FloatArray, half: float, radiance: float = 0.0) -> Mesh:
    u, v = (axis[0] * half for axis in frames(normal[None]))
    corners = np.stack([middle - u - v, middle + u - v, middle + u + v, middle - u + v])
    emission = rgb(radiance, 0.5 * radiance, 0.25 * radiance) if radiance else None
    return Mesh(corners, TRIANGLES, Material("diffuse", {"reflectance": rgb(0, 0, 0)}, emission=emission))


def seen(scene: Scene, normal: FloatArray = NORMAL) -> Hemisphere:
    estimator = by_paths(scene, max_depth=-1, roulette_depth=4)
    return look_around(estimator, -compiled(scene).center, normal, lift=1e-4, threads=1)


def reconstructed(found: Hemisphere, order: int) -> np.ndarray:
    return (found.basis[:, : order**2] @ found.coefficients[: order**2]).reshape(SIDE, SIDE, 3)


def test_directions_cover_the_hemisphere() -> None:
    directions, solid_angles = texel_directions()
    assert solid_angles.sum() == pytest.approx(2 * math.pi, rel=0.01)
    assert (directions[:, 2] * solid_angles).sum() == pytest.approx(math.pi, rel=0.01)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1)


def test_an_even_sky_is_even_also_as_harmonics_of_order_1() -> None:
    ground = square(np.zeros(3), NORMAL, 1.0)
    sky = Environment(np.full((1, 1, 3), (0.5, 0.25, 0.75), np.float32))
    found = seen(Scene((ground,), environment=sky))
    disc = (texel_directions()[1] > 0).reshape(SIDE, SIDE)
    np.testing.assert_allclose(found.radiance[disc], np.tile((0.5, 0.25, 0.75), (disc.sum(), 1)), rtol=1e-5)
    assert (found.radiance[~disc] == 0).all() and (found.distances == 0).all()
    np.testing.assert_allclose(reconstructed(found, 1)[disc], found.radiance[disc], rtol=0.02)


def test_distances_to_a_plane_above() -> None:
    ceiling = square(2.0 * NORMAL, -NORMAL, 100.0)
    found = seen(Scene((square(np.zeros(3), NORMAL, 1.0), ceiling)))
    cosine = texel_directions()[0][:, 2].reshape(SIDE, SIDE)
    high = cosine > 0.3
    np.testing.assert_allclose(found.distances[high], 2 / cosine[high], rtol=0.1)
    assert found.distances[SIDE // 2, SIDE // 2] == pytest.approx(2, rel=0.01)


def test_a_lamp_lies_where_it_is_and_harmonics_of_higher_order_are_sharper() -> None:
    u = frames(NORMAL[None])[0][0]
    towards = (u + NORMAL) / math.sqrt(2)
    lamp = square(2.0 * towards, -towards, 0.4, 10.0)
    found = seen(Scene((square(np.zeros(3), NORMAL, 1.0), lamp)))
    row, column = np.argwhere(found.radiance[..., 0] > 9).mean(axis=0)
    # Halfway to the horizon along u: tan 22.5° of the radius.
    assert 2 * (column + 0.5) / SIDE - 1 == pytest.approx(math.tan(math.pi / 8), abs=0.1)
    assert 2 * (row + 0.5) / SIDE - 1 == pytest.approx(0, abs=0.1)
    np.testing.assert_allclose(found.radiance.max(axis=(0, 1)), (10, 5, 2.5), rtol=1e-3)
    errors = [np.square(reconstructed(found, order) - found.radiance).sum() for order in (1, 3, ORDER)]
    assert errors[0] > 1.1 * errors[1] > 1.2 * errors[2]
    peak = np.unravel_index(reconstructed(found, ORDER)[..., 0].argmax(), (SIDE, SIDE))
    assert abs(peak[0] - row) <= 3 and abs(peak[1] - column) <= 3
