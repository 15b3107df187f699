# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What a solved cache holds: bounces counted one by one, gradients that are those of the irradiance, calm placement."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.scene import FloatArray, Scene
from eclat.scenes import build

SIZE = (48, 48)


@pytest.mark.parametrize("depth", [1, 2, 3, 5])
@pytest.mark.parametrize("method", [eclat.Path(), eclat.IrradianceCache()], ids=["path", "irradiance-cache"])
def test_a_furnace_adds_one_power_of_its_albedo_with_each_bounce(method: object, depth: int) -> None:
    """Paths of n edges in a closed room that emits L_e: L = Σ_{i<n} ρⁱ L_e."""
    rho = 0.7
    image = eclat.render(build("furnace", rho=rho, emission=1.0), method, samples=64, size=(32, 32), max_depth=depth)
    expected = sum(rho**i for i in range(depth))
    assert image.pixels.mean() == pytest.approx(expected, rel=0.005)
    # A block reads some five records, each with the noise of its gather.
    blocks = image.pixels.reshape(4, 8, 4, 8, 3).mean(axis=(1, 3))
    assert blocks == pytest.approx(np.full_like(blocks, expected), rel=0.03)


@pytest.fixture(scope="module")
def box() -> tuple[Scene, eclat.Solution, np.ndarray]:
    """The Cornell box, records of many rays, and twelve of these, away from edges, whose gradients are strong."""
    scene = build("cornell-box")
    options = eclat.IrradianceCache(rows=64, far_records=0, gradient_limit=False, least_pixels=0.25, spacing=0.6)
    solution = eclat.solve(scene, options, size=(16, 16))
    # Bounds of radii shrink gradients: only records that they left alone.
    free = solution.radii > 0.1
    E = np.maximum(solution.irradiance[:, 1], 1e-3)
    both = solution.translation_gradients[:, 1], solution.rotation_gradients[:, 1]
    strength = sum(np.linalg.norm(g, axis=1) / E for g in both)
    chosen = np.argsort(np.where(free, -strength, np.inf))[:12]
    assert free[chosen].all()
    return scene, solution, chosen


def indirect(scene: Scene, points: FloatArray, normals: FloatArray) -> np.ndarray:
    return eclat.irradiance(scene, points, normals, component="indirect", samples=32768)


def test_records_hold_the_irradiance_of_their_points(box: tuple[Scene, eclat.Solution, np.ndarray]) -> None:
    scene, solution, chosen = box
    E = indirect(scene, solution.positions[chosen], solution.normals[chosen])
    # Both gathers are noisy, by a per cent or two each.
    ratio = (solution.irradiance + solution.excess)[chosen].sum(axis=1) / E.sum(axis=1)
    assert ratio == pytest.approx(np.ones_like(ratio), abs=0.1)
    assert ratio.mean() == pytest.approx(1, abs=0.015)


@pytest.mark.parametrize("kind", ["translation", "rotation"])
def test_gradients_of_records_are_finite_differences(box: tuple[Scene, eclat.Solution, np.ndarray], kind: str) -> None:
    scene, solution, chosen = box
    p, n = solution.positions[chosen], solution.normals[chosen].astype(np.float64)
    u = np.cross(n, np.array([0.3, 0.8, 0.5]))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    stored, differences = [], []
    for t in (u, np.cross(n, u)):
        if kind == "translation":
            step = 0.05
            high, low = indirect(scene, p + step * t, n), indirect(scene, p - step * t, n)
            stored.append(np.einsum("ijk,ik->ij", solution.translation_gradients[chosen], t))
        else:
            step = 0.1  # rad
            high, low = indirect(scene, p, n + np.tan(step) * t), indirect(scene, p, n - np.tan(step) * t)
            stored.append(np.einsum("ijk,ik->ij", solution.rotation_gradients[chosen], np.cross(n, t)))
        differences.append((high - low) / (2 * step))
    E = solution.irradiance[chosen][:, 1:2]
    ours, truth = (np.concatenate(x) / np.tile(E, (2, 1)) for x in (stored, differences))
    # One gather's gradient has some twenty per cent of noise; a wrong sign or factor shows in the regression.
    assert (ours * truth).sum() / (truth**2).sum() == pytest.approx(1, abs=0.25)
    assert np.sqrt(((ours - truth) ** 2).sum() / (truth**2).sum()) < 0.4


def test_noise_of_gathers_does_not_drive_placement() -> None:
    """Gathers of few rays, each of them a noisy path, place about as many records as gathers of many."""
    scene = build("cornell-box")
    counts = [
        sum(
            len(
                eclat.solve(scene, eclat.IrradianceCache(rows=rows, far_records=far), size=SIZE, seed=seed, check=False)
            )
            for seed in range(3)
        )
        for rows, far in ((8, 0), (40, 2000))
    ]
    # With more rays, more of the obstacles near a record are found.
    assert counts[0] == pytest.approx(counts[1], rel=0.25)
