# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Where probes stand, which lie inside solids, and what replaces them."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat.probe_grid.placing import filled, grid_bounds, grid_counts, in_solids
from eclat.scene import Material, Mesh, Scene, grey
from eclat.scenes.geometry import Solid, box, icosphere, mesh

WHITE = Material("diffuse", {"reflectance": grey(0.5)})


@pytest.mark.parametrize("extent", [(1, 1, 1), (10, 3, 5), (100, 0, 100), (1e-6, 2e-6, 1e-6), (1e4, 0.1, 0.1)])
def test_cells_are_about_cubes_and_about_512(extent: tuple[float, float, float]) -> None:
    counts = grid_counts(np.array(extent, np.float64), None)
    assert 200 <= np.prod(counts) <= 512
    sides = [e / n for e, n in zip(extent, counts, strict=True) if n > 1]
    assert max(sides) < 1.5 * min(sides)


def test_bounds_are_those_of_the_scene_without_strays() -> None:
    room = mesh([box((-1, 0, -2), (1, 3, 2)).scaled(1, 1, 1)] * 50, WHITE, "room")
    stray = Mesh(np.array([(1e6, 0, 0), (1e6, 1, 0), (1e6, 0, 1)], np.float64), np.array([(0, 1, 2)]), WHITE)
    low, high = grid_bounds(Scene(meshes=(room, stray)), None)
    assert low.tolist() == [-1, 0, -2] and high.tolist() == [1, 3, 2]
    with pytest.raises(EclatError, match="this scene has none"):
        grid_bounds(Scene(), None)


def lone(solid: Solid, material: Material = WHITE) -> Scene:
    return Scene(meshes=(mesh([solid], material, "solid"),))


def test_a_solid_holds_what_is_inside_of_it() -> None:
    rng = np.random.default_rng(1)
    points = rng.uniform(-1.5, 1.5, (500, 3))
    distance = np.linalg.norm(points, axis=1)
    clear = np.abs(distance - 1) > 0.02  # the ball has facets
    found = in_solids(lone(icosphere(3)), points, 1)
    assert (found[clear] == (distance < 1)[clear]).all()
    # The inside of a room is not a solid, and neither is what lies behind a two-sided wall.
    room = lone(box((-1, -1, -1), (1, 1, 1)).inside_out())
    assert not in_solids(room, points, 1).any()
    assert not in_solids(Scene(), points, 1).any()
    assert len(in_solids(room, points[:0], 1)) == 0


def test_a_solid_in_a_solid_hides_neither() -> None:
    # A two-sided hull around something else counts as a room; a one-sided one is seen from outside only.
    hull = Material("diffuse", {"reflectance": grey(0.5)}, two_sided=False)
    both = Scene(meshes=(mesh([icosphere(2)], hull, "a"), mesh([icosphere(1).scaled(0.3, 0.3, 0.3)], WHITE, "b")))
    points = np.array([(0, 0, 0), (0.5, 0, 0), (0.35, 0, 0), (1.2, 0, 0)])
    assert in_solids(both, points, 1).tolist() == [True, True, True, False]


def test_filling_takes_the_mean_of_neighbours_by_their_distance() -> None:
    values = np.arange(27, dtype=np.float64).reshape(3, 3, 3, 1) * np.ones(4)
    inside = np.zeros((3, 3, 3), bool)
    inside[1, 1, 1] = True
    values[1, 1, 1] = -100
    # A linear function is its own mean.
    assert filled(values, inside, np.ones(3))[1, 1, 1] == pytest.approx(13)
    assert (filled(values, inside, np.ones(3))[~inside] == values[~inside]).all()
    # Cells ten times as tall as wide: neighbours beside count a hundred times as much as those above.
    row = np.array([0.0, 0, 0, 1, 9, 1, 0, 0, 0]).reshape(3, 3, 1)[..., None]
    flat = filled(row[..., 0, :], inside[:, :, :1] & False | (row[..., 0] == 9), np.array([10.0, 1.0, 0.0]))
    assert flat[1, 1, 0] == pytest.approx(2 / (2 + 2 / 100 + 4 / 101), rel=1e-9)


def test_deep_insides_are_filled_step_by_step() -> None:
    values, inside = np.zeros((7, 1, 1)), np.ones((7, 1, 1), bool)
    inside[0] = False
    values[0] = 5
    assert filled(values, inside, np.array([1.0, 0, 0])).ravel().tolist() == [5] * 7
    with pytest.raises(EclatError, match="all lie inside of solids"):
        filled(values, np.ones((7, 1, 1), bool), np.ones(3))
