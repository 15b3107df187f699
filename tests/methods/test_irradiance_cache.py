# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Irradiance caching against closed forms, against `path`, and against itself on other threads."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import eclat
from eclat.scenes import build

SIZE = (96, 96)


@pytest.mark.parametrize("method", [eclat.Path(), eclat.IrradianceCache()], ids=["path", "irradiance-cache"])
@pytest.mark.parametrize("rho", [0.3, 0.8])
def test_furnace(method: object, rho: float) -> None:
    """A closed room of albedo ρ that emits L_e: L = L_e / (1 − ρ) everywhere."""
    scene = build("furnace", rho=rho, emission=1.0)
    image = eclat.render(scene, method, samples=64, size=(48, 48))
    assert image.pixels.mean() == pytest.approx(1 / (1 - rho), rel=0.005)


@pytest.fixture(scope="module")
def cornell() -> tuple[eclat.Scene, np.ndarray]:
    scene = build("cornell-box")
    return scene, eclat.render(scene, eclat.Path(), samples=1024, size=SIZE, seed=1).pixels


def test_agrees_with_path_on_the_cornell_box(cornell: tuple[eclat.Scene, np.ndarray]) -> None:
    scene, reference = cornell
    image = eclat.render(scene, eclat.IrradianceCache(), samples=256, size=SIZE).pixels
    assert image.mean() == pytest.approx(reference.mean(), rel=0.01)
    # Blocks average the noise of both away; what is left is the cache's bias.
    ours, theirs = (x.reshape(12, 8, 12, 8, 3).mean(axis=(1, 3)) for x in (image, reference))
    bias = np.sqrt(np.mean((ours - theirs) ** 2 / (theirs**2 + 0.01)))
    assert bias < 0.015


@pytest.mark.parametrize("gradients", [True, False])
@pytest.mark.parametrize("weight", ["tabellion", "ward"])
def test_variants_agree(cornell: tuple[eclat.Scene, np.ndarray], gradients: bool, weight: str) -> None:
    scene, reference = cornell
    options = eclat.IrradianceCache(weight=weight, rotation_gradient=gradients, translation_gradient=gradients)
    image = eclat.render(scene, options, samples=64, size=SIZE).pixels
    assert image.mean() == pytest.approx(reference.mean(), rel=0.02)


def test_same_bits_on_any_threads_and_tile_order() -> None:
    scene = build("cornell-box")
    first = eclat.render(scene, eclat.IrradianceCache(), samples=2, size=SIZE, threads=1)
    second = eclat.render(
        scene, eclat.IrradianceCache(), samples=2, size=SIZE, threads=2, tile_order=[8, 3, 1, 0, 7, 2, 6, 5, 4]
    )
    assert np.array_equal(first.pixels, second.pixels)
    one, *others = (eclat.solve(scene, size=SIZE, threads=t) for t in (1, 2, 8))
    assert all(np.array_equal(one.near, s.near) and np.array_equal(one.far, s.far) for s in others)


def test_same_bits_in_a_crop_and_in_parts() -> None:
    scene = build("cornell-box")
    whole = eclat.render(scene, eclat.Path(), samples=3, size=SIZE).pixels
    crop = eclat.render(scene, eclat.Path(), samples=3, size=SIZE, crop=(10, 20, 50, 60)).pixels
    assert np.array_equal(whole[20:60, 10:50], crop[20:60, 10:50])
    assert not crop[:20].any()


@pytest.mark.parametrize("scale", [2.0**10, 2.0**-10])
def test_scaling_by_a_power_of_two_scales_bits(scale: float) -> None:
    scene = build("cornell-box")
    meshes = tuple(dataclasses.replace(m, positions=np.asarray(m.positions) * scale) for m in scene.meshes)
    matrix = np.array(scene.cameras[0].to_world, dtype=np.float64)
    matrix[:3, 3] *= scale
    camera = dataclasses.replace(scene.cameras[0], to_world=matrix)
    scaled = dataclasses.replace(scene, meshes=meshes, cameras=(camera,))
    a = eclat.render(scene, eclat.Path(), samples=2, size=SIZE).pixels
    b = eclat.render(scaled, eclat.Path(), samples=2, size=SIZE).pixels
    assert np.array_equal(a, b)


def test_dark_room_behind_a_thin_wall_stays_dark() -> None:
    """The wall is 1 cm thick; records of the lit side must not reach through it."""
    scene = build("two-rooms")
    lit = eclat.render(scene, samples=4, size=SIZE, camera=0)
    dark = eclat.render(scene, samples=4, size=SIZE, camera=1)
    assert dark.pixels.max() < 1e-3 * lit.pixels.mean()
    # The same with the records of both views, so that lit ones are there to leak.
    both = eclat.merge(eclat.solve(scene, size=SIZE, camera=0), eclat.solve(scene, size=SIZE, camera=1))
    assert eclat.render(scene, both, samples=4, size=SIZE, camera=1).pixels.max() < 1e-3 * lit.pixels.mean()


def test_neighbour_clamped_radii_are_lipschitz() -> None:
    scene = build("cornell-box")
    options = eclat.IrradianceCache(least_pixels=0.25, largest_pixels=1e5, gradient_limit=False, spacing=0.5)
    s = eclat.solve(scene, options, size=(48, 48))
    apart = np.linalg.norm(s.positions[:, None] - s.positions[None], axis=-1)
    # radius = spacing · R and R_i ≤ R_j + d, but for radii raised to the lower bound of a quarter of a pixel.
    excess = s.radii[:, None] - s.radii[None] - 0.5 * apart
    raised = s.radii < 0.005
    assert excess[~raised].max() < 1e-5 + 0.005


def test_save_load_merge(tmp_path) -> None:
    scene = build("cornell-box")
    solution = eclat.solve(scene, size=(48, 48))
    solution.save(tmp_path / "cache.npz")
    loaded = eclat.Solution.load(tmp_path / "cache.npz", scene)
    first = eclat.render(scene, solution, samples=2, size=(48, 48)).pixels
    assert np.array_equal(first, eclat.render(scene, loaded, samples=2, size=(48, 48)).pixels)
    with pytest.raises(eclat.EclatError, match="solved for another scene"):
        eclat.Solution.load(tmp_path / "cache.npz", build("furnace"))
    other = eclat.solve(scene, size=(48, 48), seed=5)
    ab, ba = eclat.merge(solution, other), eclat.merge(other, solution)
    assert np.array_equal(ab.near, ba.near) and len(ab) > len(solution)
    (tmp_path / "cache.npz").write_bytes((tmp_path / "cache.npz").read_bytes()[:1000])
    with pytest.raises(eclat.EclatError, match="damaged"):
        eclat.Solution.load(tmp_path / "cache.npz")


def test_irradiance_under_a_square_light() -> None:
    """Direct irradiance against Lambert's closed form for a rectangle parallel to the receiver, centred above it."""
    scene = build("cornell-box")
    light = next(m for m in scene.meshes if m.material.emission is not None)
    radiance = np.array(light.material.emission.constant)
    position = np.array([[0.0, 0.5, float(np.asarray(light.positions)[:, 2].mean())]])
    height = 0.99 - 0.5
    a, b = 0.23 / height, 0.19 / height
    # Form factor of a quarter of a parallel rectangle above its corner, times four: Lambert's formula for its four edges.
    quarter = (
        a / np.hypot(1, a) * np.arctan(b / np.hypot(1, a)) + b / np.hypot(1, b) * np.arctan(a / np.hypot(1, b))
    ) / (2 * np.pi)
    E = eclat.irradiance(scene, position, np.array([[0.0, 1.0, 0.0]]), component="direct", samples=4096)
    assert E[0] == pytest.approx(np.pi * radiance * 4 * quarter, rel=0.002)
