# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Direct light as coefficients of records of radiance: their dot product with those of a cosine is the irradiance."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat import harmonics
from eclat.scene import DirectionalLight, FloatArray, Material, Mesh, PointLight, Scene, SpotLight, rgb
from eclat.viewer.lamp_gloss import direct_coefficients, to_orthonormal

ORDER = 8
HERE = np.array([[0.0, 0.0, 0.0], [0.4, 0.0, -0.3]])
UP = np.array([[0.0, 1.0, 0.0], [0.0, 1.0, 0.0]])


def square(height: float, half: float, emission: tuple[float, float, float] | None, name: str) -> Mesh:
    """A square that faces down."""
    corners = np.array([(-half, height, -half), (half, height, -half), (half, height, half), (-half, height, half)])
    material = Material("diffuse", name=name, emission=None if emission is None else rgb(*emission))
    return Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), material, name=name)


FLOOR = square(0, 5, None, "floor")


def irradiance(scene: Scene) -> FloatArray:
    """(2, 3) by the coefficients."""
    found = direct_coefficients(scene, HERE, UP, np.full(2, 0.1), ORDER)[:, 0]
    directions, weights = harmonics.quadrature(2 * ORDER, "hemisphere")
    values = harmonics.evaluate("spherical", ORDER, directions)
    cosine = to_orthonormal(ORDER) @ (values * (weights * directions[:, 2])[:, None]).sum(axis=0)
    brought: FloatArray = np.einsum("i,nic->nc", cosine, found)
    return brought


@pytest.mark.parametrize(
    "scene",
    [
        Scene(meshes=(FLOOR, square(1.5, 0.4, (3, 2, 1), "lamp"))),
        Scene(meshes=(FLOOR,), lights=(PointLight((0.5, 1, 0.2), (3, 2, 1)),)),
        Scene(meshes=(FLOOR,), lights=(DirectionalLight((0.3, -1, 0.4), (3, 2, 1)),)),
        Scene(meshes=(FLOOR,), lights=(SpotLight((0, 2, 0), (0.1, -1, 0), (3, 2, 1), 5, 40, "smooth"),)),
        Scene(meshes=(FLOOR,), lights=(SpotLight((0, 2, 0), (0.1, -1, 0), (3, 2, 1), 5, 40, "linear"),)),
    ],
    ids=["surface", "point", "sun", "smooth spot", "linear spot"],
)
def test_the_cosine_lobe_reflects_the_irradiance(scene: Scene) -> None:
    expected = eclat.irradiance(scene, HERE, UP, eclat.Direct(), component="direct", samples=4096)
    np.testing.assert_allclose(irradiance(scene), expected, rtol=0.02)


def test_what_is_in_the_way_hides_a_lamp() -> None:
    lamp = PointLight((0, 2, 0), (1, 1, 1))
    panel = square(1, 0.1, None, "panel")
    hidden, free = irradiance(Scene(meshes=(FLOOR, panel), lights=(lamp,)))
    assert (hidden == 0).all() and (free > 0).all()


def test_derivatives_tell_what_moving_changes() -> None:
    scene = Scene(meshes=(FLOOR, square(1.5, 0.4, (3, 2, 1), "lamp")))
    step = 1e-3
    # The axes u and v of the frame around +y are x and -z.
    moved = np.array([(step, 0, 0), (0, 0, -step)])
    for axis in range(2):
        at = HERE[1] + np.outer([-1, 1], moved[axis])
        both = direct_coefficients(scene, at, UP, np.full(2, 0.1), ORDER)
        expected = (both[1, 0] - both[0, 0]) / (2 * step)
        found = direct_coefficients(scene, HERE, UP, np.full(2, 0.1), ORDER)[1, 1 + axis]
        np.testing.assert_allclose(found, expected, atol=0.01 * np.abs(expected).max())
