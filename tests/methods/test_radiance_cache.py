# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Radiance caching against path tracing and closed forms. Bias is measured where records served a pixel's gloss."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError
from eclat.measure.error_estimate import error_text
from eclat.scene import Camera, Environment, Material, Scene, grey, look_at
from eclat.scenes import glossy_box
from eclat.scenes.geometry import box, mesh
from support.similarity import Similarity, rotation

SIZE = (48, 48)


@dataclass(frozen=True)
class Reference:
    """Indirect light by two independent path-traced pictures, and the floor of all light for relative errors."""

    first: np.ndarray
    second: np.ndarray
    floor: np.ndarray

    def error(self, indirect: np.ndarray, where: np.ndarray) -> float:
        """RMS relative to all light, over the pixels of `where`; noise of the references cancels."""
        product = (indirect - self.first) * (indirect - self.second) / self.floor
        return float(np.sqrt(max(0.0, product[where].mean())))

    def bias(self, indirect: np.ndarray, where: np.ndarray) -> float:
        mean = (self.first + self.second)[where].mean() / 2
        return float(indirect[where].mean() / mean - 1)


@cache
def reference(alpha: float) -> Reference:
    first, second = (
        eclat.render(glossy_box.build(alpha), eclat.Path(), samples=768, size=SIZE, seed=seed) for seed in (11, 12)
    )
    whole = (first.pixels + second.pixels) / 2
    return Reference(first.layers["indirect"], second.layers["indirect"], whole**2 + 0.01)


def picture(scene: Scene, options: eclat.RadianceCache, samples: int = 8) -> eclat.Image:
    return eclat.render(scene, eclat.solve(scene, options, size=SIZE, check=False), samples=samples, size=SIZE)


@pytest.mark.parametrize(("alpha", "served", "error", "bias"), [(0.4, 0.13, 0.02, 0.015), (0.6, 0.16, 0.012, 0.012)])
def test_rough_metal_in_the_box_is_cached_with_a_stated_bias(
    alpha: float, served: float, error: float, bias: float
) -> None:
    image = picture(glossy_box.build(alpha), eclat.RadianceCache())
    cached = image.layers["gloss_cached"] > 0.99
    assert cached.mean() > served
    assert reference(alpha).error(image.layers["indirect"], cached) < error
    assert abs(reference(alpha).bias(image.layers["indirect"], cached)) < bias


# RMS error with all lobes cached, whatever the order leaves of them, measured: 0.2 needs tracing, 0.6 needs no more than 4.
BY_ORDER = {
    0.2: {4: 0.06, 6: 0.045, 8: 0.038, 10: 0.036},
    0.4: {4: 0.021, 6: 0.018, 8: 0.017, 10: 0.017},
    0.6: {4: 0.0105, 6: 0.01, 8: 0.01, 10: 0.01},
}


@pytest.mark.parametrize("alpha", BY_ORDER)
def test_error_by_order(alpha: float) -> None:
    scene, errors = glossy_box.build(alpha), {}
    for order in BY_ORDER[alpha]:
        image = picture(scene, eclat.RadianceCache(order=order, gloss_error=1), samples=4)
        cached = image.layers["gloss_cached"] > 0.99
        assert cached.mean() > 0.12
        errors[order] = reference(alpha).error(image.layers["indirect"], cached)
    assert all(errors[order] < bound for order, bound in BY_ORDER[alpha].items()), errors
    if alpha < 0.6:
        assert errors[4] > 1.15 * errors[10], errors


def test_records_whose_reflection_disagrees_with_neighbours_shrink() -> None:
    """Too sparse a spacing is made up for where it matters."""
    scene, errors, counts = glossy_box.build(0.4), {}, {}
    for adaptive in (False, True):
        options = eclat.RadianceCache(gloss_spacing=2.0, gloss_rows=32, shrink_disagreeing=adaptive)
        solution = eclat.solve(scene, options, size=SIZE, check=False)
        assert solution.radiance is not None
        image = eclat.render(scene, solution, samples=8, size=SIZE)
        cached = image.layers["gloss_cached"] > 0.99
        errors[adaptive] = reference(0.4).error(image.layers["indirect"], cached)
        counts[adaptive] = len(solution.radiance)
    assert counts[True] < 2.5 * counts[False]
    assert errors[True] < 0.8 * errors[False], errors


def test_the_estimated_error_is_that_of_gloss_too() -> None:
    """With two bands, which hold little of a narrow lobe."""
    scene, truth = glossy_box.build(0.2), reference(0.2)
    solution = eclat.solve(scene, eclat.RadianceCache(order=2, gloss_error=1), size=SIZE)
    first, second = (eclat.render(scene, solution, samples=8, size=SIZE, seed=s) for s in (1, 2))
    squares = (first.layers["indirect"] - truth.first) * (second.layers["indirect"] - truth.second)
    whole = (truth.floor - 0.01).mean()
    exact = float(np.sqrt((squares / (truth.floor - 0.01 + 0.01 * whole)).mean()))
    estimate = solution.estimate
    assert estimate is not None and solution.statistics["gloss_estimated"] == 1
    assert exact > 0.03
    assert 0.65 * exact < estimate.quoted < 1.5 * exact


def test_records_everywhere_serve_a_view_that_nobody_chose() -> None:
    scene = glossy_box.build(0.6)
    options = eclat.RadianceCache(max_error=0.1, far_records=500, least_pixels=10)
    solution = eclat.solve(scene, options, view_independent=True)
    assert solution.radiance is not None and len(solution.radiance) > 200
    assert solution.statistics["gloss_estimated"] == 0
    assert error_text(solution.statistics).endswith("of irradiance, gloss not included")
    image = eclat.render(scene, solution, samples=4, size=SIZE)
    cached = image.layers["gloss_cached"] > 0.99
    assert cached.mean() > 0.14
    assert image.layers["gloss_traced"].mean() < 0.02
    assert reference(0.6).error(image.layers["indirect"], cached) < 0.05


def test_narrow_lobes_are_traced() -> None:
    image = picture(glossy_box.build(0.05), eclat.RadianceCache(), samples=1)
    assert image.layers["gloss_traced"].mean() > 0.15
    assert image.layers["gloss_cached"].mean() < 0.02


def under_a_sky(material: Material) -> Scene:
    """A floor under a sky of radiance 1."""
    shapes = mesh([box((-9, -1, -9), (9, 0, 9))], material, "floor")
    camera = Camera(look_at((0, 1.2, 3.2), (0, 0, 0)), fov=35, size=SIZE, name="camera")
    return Scene(
        meshes=(shapes,), cameras=(camera,), environment=Environment(np.ones((1, 1, 3), np.float32)), name="sky"
    )


LOBES = {
    "ggx": Material("conductor", {"eta": grey(0), "k": grey(1), "alpha_u": grey(0.5)}),
    "ward": Material("ward", {"diffuse_reflectance": grey(0), "specular_reflectance": grey(0.7), "alpha_u": grey(0.4)}),
    "phong": Material(
        "phong", {"diffuse_reflectance": grey(0), "specular_reflectance": grey(0.7), "exponent": grey(8)}
    ),
    "gltf": Material("metallic_roughness", {"base_color": grey(0.7), "metallic": grey(1), "roughness": grey(0.5)}),
}


@pytest.mark.parametrize("lobe", LOBES)
def test_even_light_is_reflected_by_the_directional_albedo(lobe: str) -> None:
    """Which `path` integrates by itself."""
    scene = under_a_sky(LOBES[lobe])
    image = picture(scene, eclat.RadianceCache(), samples=4)
    exact = eclat.render(scene, eclat.Path(), samples=256, size=SIZE, seed=5)
    cached = image.layers["gloss_cached"] > 0.99
    assert cached.mean() > 0.3
    assert image.pixels[cached].mean() == pytest.approx(exact.pixels[cached].mean(), rel=0.01)


@pytest.fixture(scope="module")
def solved() -> tuple[Scene, eclat.Solution]:
    scene = glossy_box.build(0.5)
    return scene, eclat.solve(scene, eclat.RadianceCache(), size=SIZE, check=False)


def test_a_saved_cache_gives_the_same_bits(solved: tuple[Scene, eclat.Solution], tmp_path: Path) -> None:
    scene, solution = solved
    solution.save(tmp_path / "cache.npz")
    again = eclat.Solution.load(tmp_path / "cache.npz", scene)
    assert again.options == solution.options
    a, b = (eclat.render(scene, s, samples=2, size=SIZE) for s in (solution, again))
    assert np.array_equal(a.pixels, b.pixels)
    assert np.array_equal(a.layers["gloss_cached"], b.layers["gloss_cached"])
    assert a.layers["gloss_cached"].max() == 1


def test_a_damaged_file_is_refused(solved: tuple[Scene, eclat.Solution], tmp_path: Path) -> None:
    solved[1].save(tmp_path / "cache.npz")
    with np.load(tmp_path / "cache.npz") as data:
        arrays = dict(data)
    for name in ("radiance", "radiance_values", "radiance_gradients"):
        np.savez(tmp_path / "bad.npz", **(arrays | {name: arrays[name][:, :20]}))
        with pytest.raises(EclatError, match=f"'{name}' is damaged"):
            eclat.Solution.load(tmp_path / "bad.npz")


def test_merged_with_itself_nothing_changes(solved: tuple[Scene, eclat.Solution]) -> None:
    scene, solution = solved
    both = eclat.merge(solution, solution)
    assert both.radiance is not None and solution.radiance is not None
    assert len(both.radiance) == len(solution.radiance)
    a, b = (eclat.render(scene, s, samples=4, size=SIZE).pixels for s in (solution, both))
    assert a.mean() == pytest.approx(b.mean(), rel=1e-3)  # records come in another order


def test_results_do_not_depend_on_the_number_of_threads(solved: tuple[Scene, eclat.Solution]) -> None:
    scene, solution = solved
    single = eclat.solve(scene, eclat.RadianceCache(), size=SIZE, check=False, threads=1)
    assert single.radiance is not None and solution.radiance is not None
    assert np.array_equal(single.radiance.values, solution.radiance.values)
    assert np.array_equal(single.near, solution.near)


def test_scene_and_camera_turned_together_give_the_same_picture() -> None:
    scene = glossy_box.build(0.5)
    moved = Similarity(turn=rotation((1, 2, -0.5), 77)).scene(scene)
    a, b = (picture(s, eclat.RadianceCache(), samples=16) for s in (scene, moved))
    cached = (a.layers["gloss_cached"] > 0.99) & (b.layers["gloss_cached"] > 0.99)
    assert cached.mean() > 0.12
    x, y = a.layers["indirect"][cached], b.layers["indirect"][cached]
    assert y.mean() == pytest.approx(x.mean(), rel=0.01)
    assert np.sqrt(np.mean((x - y) ** 2) / np.mean(x**2)) < 0.05


def test_a_fly_through_needs_no_gathers_and_does_not_flicker() -> None:
    scene = glossy_box.build(0.5)
    solution = eclat.solve(scene, eclat.RadianceCache(), size=SIZE, check=False)
    first = scene.cameras[0]
    start = np.array(first.to_world)
    right, backward = (start[:3, k] / np.linalg.norm(start[:3, k]) for k in (0, 2))

    def frame(time: float) -> eclat.Image:
        matrix = start.copy()
        matrix[:3, 3] += time * (0.3 * right - 0.8 * backward)
        view = Camera(matrix, fov=first.fov, fov_axis=first.fov_axis, size=SIZE, name="flying")
        return eclat.render(scene, solution, camera=view, samples=1, size=SIZE, adaptive=False)

    for time in np.linspace(0, 1, 8):
        now, soon = frame(time), frame(time + 1e-3)
        assert now.layers["gloss_cached"].mean() > 0.12
        assert now.layers["gloss_traced"].mean() < 0.1 * now.layers["gloss_cached"].mean()
        cached = (now.layers["gloss_cached"] == 1) & (soon.layers["gloss_cached"] == 1)
        x, y = (image.layers["indirect"][cached] for image in (now, soon))
        # A record that began or ended to serve with a weight would be a jump; but for pixels at edges there is none.
        assert np.quantile(np.abs(y - x), 0.95) < 0.02 * x.mean()
