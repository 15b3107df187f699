# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What is stated of light that gather rays and error probes find by chance only."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.errors import EclatWarning
from eclat.measure.error_estimate import LIGHT_BY_CHANCE, error_text
from eclat.scene import Material, Mesh, PointLight, Scene, grey


def quad(corners: list[tuple[float, float, float]], material: Material) -> Mesh:
    return Mesh(np.array(corners, float), np.array([(0, 1, 2), (0, 2, 3)]), material)


def lamp_beside(mirror: Material, half_width: float) -> Scene:
    """A lamp over a floor in the corner that the floor makes with an upright sheet."""
    h = half_width
    lamp = Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(1.0 / h**2))
    floor = Material("diffuse", {"reflectance": grey(0.8)})
    return Scene(
        meshes=(
            quad([(0.8 - h, 1.5, h), (0.8 - h, 1.5, -h), (0.8 + h, 1.5, -h), (0.8 + h, 1.5, h)], lamp),
            quad([(0, 0, 4), (4, 0, 4), (4, 0, -4), (0, 0, -4)], floor),
            quad([(0, 0, 4), (0, 0, -4), (0, 4, -4), (0, 4, 4)], mirror),
        )
    )


MIRROR = Material("conductor", {"specular_reflectance": grey(0.9)})
POINTS = np.column_stack([np.linspace(0.1, 2, 40), np.zeros(40), np.linspace(-0.9, 0.9, 40)])
NORMALS = np.tile((0.0, 1.0, 0.0), (40, 1))


def statistics(scene: Scene) -> dict[str, float]:
    return eclat.solve(scene, points=(POINTS, NORMALS)).statistics


def test_light_of_a_small_lamp_by_a_mirror_raises_the_stated_error() -> None:
    """The floor cannot see itself, so that all its indirect light is that of the lamp's image, a fifth of all; the cache
    misses it, and its probes said 0.00 %."""
    found = statistics(lamp_beside(MIRROR, 0.01))
    assert 0.1 < found[LIGHT_BY_CHANCE] < 0.4
    assert found["estimated_error"] >= found[LIGHT_BY_CHANCE]
    assert "by way of mirrors, metals or glass" in error_text(found)


@pytest.mark.parametrize(
    "scene",
    [lamp_beside(MIRROR, 0.5), lamp_beside(Material("diffuse", {"reflectance": grey(0.9)}), 0.01)],
    ids=["large lamp", "white wall"],
)
def test_light_that_gathers_find_does_not_raise_the_stated_error(scene: Scene) -> None:
    assert LIGHT_BY_CHANCE not in statistics(scene)


@pytest.mark.parametrize("half_width", [0.01, 0.5])
def test_light_through_a_pane_does_not_count_as_found_by_chance(half_width: float) -> None:
    """Light samples pass straight through panes; what this one reflects meets nothing."""
    lamp, floor, _ = lamp_beside(MIRROR, half_width).meshes
    pane = quad([(0, 1, 4), (4, 1, 4), (4, 1, -4), (0, 1, -4)], Material("thin_dielectric", {"ior": grey(1.5)}))
    assert LIGHT_BY_CHANCE not in statistics(Scene(meshes=(lamp, floor, pane)))


def test_path_warns_that_light_of_point_lights_by_mirrors_is_missing() -> None:
    floor, mirror = lamp_beside(MIRROR, 0.01).meshes[1:]
    scene = Scene(meshes=(floor, mirror), lights=(PointLight((0.8, 1.5, 0.0), (1.0, 1.0, 1.0)),))
    with pytest.warns(EclatWarning, match="no path can find this light"):
        eclat.irradiance(scene, POINTS, NORMALS, eclat.Path(), samples=1)
    assert statistics(scene)[LIGHT_BY_CHANCE] > 0.1
