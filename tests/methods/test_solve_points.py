# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Solving for points and for whole scenes, and irradiance read from records, against unbiased gathers."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.measure.metrics import relative_rmse
from eclat.scene import Environment, SpotLight
from eclat.scenes import build

TOLERANCE = 0.03
"""Relative RMSE over points of indirect irradiance from records of max_error 0.01; measured 0.014 to 0.016."""


@pytest.fixture(scope="module")
def cornell() -> eclat.Scene:
    return build("cornell-box")


def wall_points(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points on floor, ceiling, back and side walls, some of them under boxes and behind the light."""
    rng = np.random.default_rng(1)
    points, normals = [], []
    for axis, side in ((1, -1), (0, -1), (0, 1), (2, -1), (1, 1)):
        p, n = rng.uniform(-0.97, 0.97, (count, 3)), np.zeros((count, 3))
        p[:, axis], n[:, axis] = side, -side
        points.append(p)
        normals.append(n)
    return np.concatenate(points), np.concatenate(normals)


@pytest.fixture(scope="module")
def gathered(cornell: eclat.Scene) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """Points, normals, and two unbiased answers."""
    points, normals = wall_points(24)
    answers = [
        eclat.irradiance(cornell, points, normals, eclat.Path(), component="indirect", samples=4096, seed=seed)
        for seed in (7, 8)
    ]
    return points, normals, answers


def error(values: np.ndarray, answers: list[np.ndarray]) -> float:
    return relative_rmse(values[None], answers[0][None], answers[1][None])


@pytest.mark.parametrize("how", ["points", "everywhere", "on the fly"])
def test_indirect_irradiance_agrees_with_gathers(cornell: eclat.Scene, gathered: Any, how: str) -> None:
    points, normals, answers = gathered
    what: Any = None
    if how == "points":
        what = eclat.solve(cornell, points=(points, normals))
    elif how == "everywhere":
        what = eclat.solve(cornell, eclat.IrradianceCache(max_error=0.02), view_independent=True)
    statistics: dict[str, float] = {}
    values = eclat.irradiance(cornell, points, normals, what, component="indirect", statistics=statistics)
    assert error(values, answers) < (TOLERANCE if how != "everywhere" else 2 * TOLERANCE)
    assert values.mean() == pytest.approx(np.mean(answers), rel=0.02)
    assert statistics["served"] + statistics["gathered"] == len(points)
    assert statistics["served"] >= 0.95 * len(points)


def test_points_off_the_records_are_gathered(cornell: eclat.Scene) -> None:
    """Records of the floor do not serve points in the air, which are gathered as well as they."""
    floor, up = wall_points(24)[0][:24], np.tile([0.0, 1, 0], (24, 1))
    solution = eclat.solve(cornell, points=(floor, up))
    rng = np.random.default_rng(2)
    air = rng.uniform(-0.9, 0.9, (24, 3))
    sides = rng.normal(size=(24, 3))
    statistics: dict[str, float] = {}
    values = eclat.irradiance(cornell, air, sides, solution, component="indirect", statistics=statistics)
    assert (statistics["served"], statistics["gathered"]) == (0, 24)
    answers = [
        eclat.irradiance(cornell, air, sides, eclat.Path(), component="indirect", samples=4096, seed=s) for s in (7, 8)
    ]
    assert error(values, answers) < TOLERANCE


def test_gathers_keep_what_few_bright_rays_bring(cornell: eclat.Scene) -> None:
    """All light comes from a spot on the back wall that a gather meets with a few rays: no record may judge it alone,
    but nobody shares what a single gather found."""
    light = SpotLight((0.0, 0.0, 0.5), (0.0, 0.0, -1.0), (50.0,) * 3, inner_angle=4.0, outer_angle=5.0)
    unlit = tuple(m for m in cornell.meshes if m.material.emission is None)
    scene = dataclasses.replace(cornell, meshes=unlit, lights=(light,))
    solution = eclat.solve(scene, eclat.IrradianceCache(rows=16), points=([[0.0, -1, 0]], [[0.0, 1, 0]]), max_depth=3)
    # Away from the wall and towards it, so that no point dominates the mean.
    air = np.random.default_rng(3).uniform((-0.8, -0.8, 0), (0.8, 0.8, 0.8), (200, 3))
    sides = np.tile([0.0, 0, -1], (200, 1))
    statistics: dict[str, float] = {}
    common: dict[str, Any] = {"component": "indirect", "max_depth": 3}
    values = eclat.irradiance(scene, air, sides, solution, statistics=statistics, **common)
    assert statistics["gathered"] == 200
    truth = eclat.irradiance(scene, air, sides, eclat.Path(), samples=4096, **common)
    # The standard deviation of the mean is 3 %; without the excess nearly all is missing.
    assert values.mean() == pytest.approx(truth.mean(), rel=0.15)


def test_components_add_up_and_mean_the_same_for_every_method(cornell: eclat.Scene) -> None:
    """An environment's image is in the records, but it is direct light: both methods must call it so."""
    image = np.full((8, 16, 3), 0.4, np.float32)
    image[1, 3] = 30.0
    scene = dataclasses.replace(cornell, environment=Environment(image))
    points, normals = wall_points(6)
    solution = eclat.solve(scene, points=(points, normals))
    parts = {}
    for name, what in (("cache", solution), ("path", eclat.Path())):
        for component in ("total", "direct", "indirect"):
            parts[name, component] = eclat.irradiance(scene, points, normals, what, component=component, samples=8192)
    for component in ("total", "direct", "indirect"):
        cached, traced = parts["cache", component], parts["path", component]
        assert error(cached, [traced, traced]) < 2 * TOLERANCE, component
    np.testing.assert_allclose(
        parts["cache", "total"].mean(), (parts["cache", "direct"] + parts["cache", "indirect"]).mean(), rtol=0.01
    )
    assert parts["path", "direct"].mean() > 1.2 * eclat.irradiance(cornell, points, normals, component="direct").mean()


def test_same_bits_on_any_threads(cornell: eclat.Scene) -> None:
    points, normals = wall_points(40)
    options = eclat.IrradianceCache(max_error=0.1)
    for keywords in ({"points": (points, normals)}, {"view_independent": True}):
        a, b = (eclat.solve(cornell, options, threads=t, **keywords) for t in (1, 2))
        assert np.array_equal(a.near, b.near) and np.array_equal(a.far, b.far) and len(a) and len(a.far)
    one, two = (eclat.irradiance(cornell, points, normals, a, samples=16, threads=t) for t in (1, 2))
    assert np.array_equal(one, two)


def test_a_view_independent_solution_serves_any_view(cornell: eclat.Scene) -> None:
    solution = eclat.solve(cornell, eclat.IrradianceCache(max_error=0.1), view_independent=True)
    statistics = eclat.render(cornell, solution, samples=4, size=(64, 64)).metadata["statistics"]
    assert statistics["cache_misses"] < 0.01 * 4 * 64 * 64


def test_records_lie_on_surfaces_and_on_both_sides_where_both_reflect() -> None:
    """Of a square that is two-sided; as a one-sided one it gets records on its front only."""
    scene = build("cornell-box")
    floor = next(m for m in scene.meshes if m.name == "floor")
    both = dataclasses.replace(floor, material=dataclasses.replace(floor.material, two_sided=True))
    for mesh, sides in ((floor, {1}), (both, {1, -1})):
        alone = dataclasses.replace(scene, meshes=(mesh,), environment=Environment(np.ones((1, 1, 3), np.float32)))
        solution = eclat.solve(alone, view_independent=True)
        assert np.abs(solution.positions[:, 1] + 1).max() < 1e-5
        assert set(np.sign(solution.normals[:, 1]).astype(int)) == sides
        # Under a sky of radiance 1 that nothing hides, E is π.
        assert solution.irradiance == pytest.approx(np.full_like(solution.irradiance, np.pi), rel=1e-5)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"points": ([[0, 0, 0]], [[0, 1, 0]]), "view_independent": True}, "at most one of camera"),
        ({"camera": 0, "view_independent": True}, "at most one of camera"),
        ({"points": ([[0, 0, 0]], [[0, 0, 0]])}, "normals must not be zero; got .* at index 0"),
        ({"points": ([[0, 0]], [[0, 1]])}, r"must both be \(N, 3\)"),
        ({"max_depth": 0}, "max_depth must be -1"),
        ({"size": (0, 5)}, "expected a width and a height between 1 and 65,536 pixels, got 0x5"),
    ],
)
def test_bad_arguments(cornell: eclat.Scene, keywords: dict[str, Any], message: str) -> None:
    with pytest.raises(eclat.EclatError, match=message):
        eclat.solve(cornell, **keywords)


def test_a_solution_of_another_depth_is_refused(cornell: eclat.Scene) -> None:
    points = np.array([[0.0, -1, 0]]), np.array([[0.0, 1, 0]])
    solution = eclat.solve(cornell, points=points, max_depth=3)
    for call in (
        lambda: eclat.render(cornell, solution, samples=1),
        lambda: eclat.irradiance(cornell, *points, solution),
    ):
        with pytest.raises(eclat.EclatError, match="expected 3, with which this cache was solved, got -1"):
            call()
    one_bounce = eclat.irradiance(cornell, *points, solution, component="indirect", max_depth=3)
    truth = eclat.irradiance(cornell, *points, eclat.Path(), component="indirect", max_depth=3, samples=8192)
    assert one_bounce == pytest.approx(truth, rel=0.1)
    assert not eclat.irradiance(cornell, *points, component="indirect", max_depth=2).any()


def test_an_empty_set_of_points_is_allowed(cornell: eclat.Scene) -> None:
    nothing = np.zeros((0, 3))
    assert len(eclat.solve(cornell, points=(nothing, nothing))) == 0
    for what in (None, eclat.Path()):
        assert eclat.irradiance(cornell, nothing, nothing, what).shape == (0, 3)
