# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The light that probes hold, against closed forms and against irradiance at the same points."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat import _core, harmonics
from eclat.bridge.compiled import compiled
from eclat.measure.photometry import luminance
from eclat.methods.estimators import radiance_from
from eclat.scene import DirectionalLight, Environment, Material, Mesh, PointLight, Scene, SpotLight, grey
from eclat.scenes import build
from eclat.scenes.geometry import box, icosphere, mesh
from support.quick_methods import GLOBAL, QUICK

Y00 = 1 / np.sqrt(4 * np.pi)


def plate(y: float, half: float, material: Material, down: bool = False) -> Mesh:
    """A horizontal square of side 2 · half at the height y, facing up or down."""
    corners = np.array([(-half, y, -half), (-half, y, half), (half, y, half), (half, y, -half)], dtype=np.float64)
    triangles = np.array([(0, 1, 2), (0, 2, 3)])
    return Mesh(corners, triangles[:, ::-1] if down else triangles, material)


def at(scene: Scene, x: float, y: float, z: float, what: Any = None, **keywords: Any) -> eclat.ProbeGrid:
    """One probe at a point."""
    r = 1e-3
    bounds = (x - r, y - r, z - r, x + r, y + r, z + r)
    return eclat.probes(scene, what, grid=(1, 1, 1), bounds=bounds, **keywords)


@pytest.mark.parametrize("method", GLOBAL)
def test_in_the_furnace_only_the_mean_is_left(method: str) -> None:
    """Its radiance is 2 in all directions: c_00 = 2 √4π."""
    found = at(build("furnace"), 0.1, 0.2, -0.3, QUICK[method], samples=2048).coefficients[0, 0, 0]
    assert found[0] == pytest.approx(2 / Y00, rel=0.03)
    assert np.abs(found[1:]).max() < 0.03 * 2 / Y00


def test_lamps_that_are_points_have_the_harmonics_of_their_directions() -> None:
    """c_i = Σ I / r² · Y_i(ω) for point and spot lights, E · Y_i(ω) for parallel light, without noise."""
    lamps = (
        PointLight((1.0, 2.0, -2.0), (9.0, 18.0, 4.5)),
        SpotLight((0.0, 3.0, 0.0), (0.0, -1.0, 0.0), (9.0, 9.0, 9.0), 20, 30),
        SpotLight((0.0, 3.0, 0.0), (1.0, 0.0, 0.0), (9.0, 9.0, 9.0), 20, 30),
        DirectionalLight((-0.6, 0.0, -0.8), (1.0, 2.0, 3.0)),
    )
    scene = Scene(meshes=(plate(-5.0, 0.1, Material("diffuse", {"reflectance": grey(0.0)})),), lights=lamps)
    found = at(scene, 0, 0, 0, samples=8192, component="direct")
    Y = harmonics.evaluate("spherical", 3, [(1 / 3, 2 / 3, -2 / 3), (0, 1, 0), (0.6, 0, 0.8)])
    expected = np.einsum("lc,li->ic", [(1, 2, 0.5), (1, 1, 1), (1, 2, 3)], Y)
    # Which of the four lamps a sample takes is by chance, stratified.
    assert found.coefficients[0, 0, 0] == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("radius", [0.25, 10.0])
def test_suns_with_discs_are_sampled(radius: float) -> None:
    """A disc is a zonal function about its direction: band 0 is that of radiance · solid angle."""
    sun = DirectionalLight((0.0, -1.0, 0.0), (1.0, 1.0, 1.0), radius)
    scene = Scene(meshes=(plate(-5.0, 0.1, Material("diffuse", {"reflectance": grey(0.0)})),), lights=(sun,))
    found = at(scene, 0, 0, 0, samples=256, component="direct").coefficients[0, 0, 0]
    cosine = np.cos(np.radians(radius))
    # The irradiance of radiance L from a disc is π L sin²; its mean over the sphere 2π L (1 − cos).
    mean = 2 * (1 - cosine) / (1 - cosine**2) * Y00
    assert found[0] == pytest.approx(mean, rel=2e-3)
    assert found[1] == pytest.approx(np.sqrt(3) * Y00, rel=2e-3)  # ∫ L cos is the irradiance, 1
    assert np.abs(found[[3, 2, 4, 5, 7]]).max() < 5e-3


@pytest.mark.parametrize("method", GLOBAL)
def test_a_uniform_sky_over_a_floor(method: str) -> None:
    """Above a wide floor of reflectance ρ, radiance is S above and ρ S below: c_00 = 2π S (1 + ρ) Y_00,
    c_1,−1 = π S (1 − ρ) √3 Y_00, and bands of even degree have nothing else."""
    sky, rho = 1.5, 0.4
    floor = plate(0.0, 500.0, Material("diffuse", {"reflectance": grey(rho)}))
    scene = Scene(meshes=(floor,), environment=Environment(np.full((1, 1, 3), sky, np.float32)))
    found = at(scene, 0, 1, 0, QUICK[method], samples=2048)
    expected = np.zeros((9, 3))
    expected[0] = 2 * np.pi * sky * (1 + rho) * Y00
    expected[1] = np.pi * sky * (1 - rho) * np.sqrt(3) * Y00
    assert found.coefficients[0, 0, 0] == pytest.approx(expected, abs=0.025 * expected[0, 0])
    # What faces the sky receives π S, and what faces the floor ρ π S.
    up = found.irradiance([(0, 1, 0), (0, 1, 0)], [(0.0, 1.0, 0.0), (0.0, -1.0, 0.0)])
    assert up[:, 0] == pytest.approx([np.pi * sky, rho * np.pi * sky], abs=0.02 * np.pi * sky)


@pytest.fixture(scope="module")
def cornell() -> Scene:
    return build("cornell-box")


def test_both_signs_of_normals_agree_with_irradiance(cornell: Scene) -> None:
    """Beside nine coefficients, what is left is what they cannot hold, which `order_error` states, and noise."""
    grid = eclat.probes(cornell, grid=(3, 3, 3), samples=8192)
    free = ~grid.inside.reshape(-1)
    points = np.repeat(grid.positions.reshape(-1, 3)[free], 6, axis=0)
    normals = np.tile(np.concatenate([np.eye(3), -np.eye(3)]), (int(free.sum()), 1))
    expected = eclat.irradiance(cornell, points, normals, eclat.Path(), samples=8192)
    found = grid.irradiance(points, normals)
    error = float(np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected**2)))
    stated = grid.statistics["estimated_error"]
    assert 0.4 * stated < error < 2.5 * stated
    # Light from all around, without the lamp, is smooth, and hardly errs.
    grid = eclat.probes(cornell, grid=(3, 3, 3), samples=8192, component="indirect")
    expected = eclat.irradiance(cornell, points, normals, eclat.Path(), samples=8192, component="indirect")
    found = grid.irradiance(points, normals)
    assert float(np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected**2))) < 0.03


@pytest.mark.parametrize("method", GLOBAL)
def test_methods_agree_with_path(cornell: Scene, method: str) -> None:
    reference = eclat.probes(cornell, grid=(3, 2, 3), samples=16384, seed=3)
    found = eclat.probes(cornell, QUICK[method], grid=(3, 2, 3), samples=2048)
    difference = np.linalg.norm(found.coefficients - reference.coefficients)
    assert difference < 0.05 * np.linalg.norm(reference.coefficients)
    assert found.method == method
    assert ("estimated_error" in found.statistics) == (method in ("path", "irradiance-cache", "radiance-cache"))


def test_components_add_up_and_depth_counts_edges_from_the_probe(cornell: Scene) -> None:
    parts = {
        component: eclat.probes(cornell, grid=(2, 2, 2), samples=2048, component=component).coefficients
        for component in ("total", "direct", "indirect")
    }
    assert parts["direct"] + parts["indirect"] == pytest.approx(parts["total"], abs=1e-5)
    first = eclat.probes(cornell, grid=(2, 2, 2), samples=2048, max_depth=1)
    assert (first.coefficients == parts["direct"]).all()
    second = eclat.probes(cornell, grid=(2, 2, 2), samples=2048, max_depth=2)
    assert (parts["direct"][..., 0, :] < second.coefficients[..., 0, :]).all()
    assert (second.coefficients[..., 0, :] < parts["total"][..., 0, :]).all()


@pytest.mark.parametrize("method", ["path", "photon-map", "radiosity", "irradiance-cache"])
def test_a_lamp_behind_a_pane_is_counted_once(method: str) -> None:
    """A small emitter behind a pane that passes 92 % is direct light, which no path may bring again."""
    lamp = plate(2.0, 0.05, Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(100.0)), down=True)
    pane = plate(1.0, 5.0, Material("thin_dielectric", {"ior": grey(1.5)}))
    black = plate(-1.0, 5.0, Material("diffuse", {"reflectance": grey(0.0)}))
    scene = Scene(meshes=(lamp, pane, black))
    found = at(scene, 0, 0, 0, QUICK[method], samples=4096).coefficients[0, 0, 0]
    R = 0.04
    passed = 1 - 2 * R / (1 + R)  # of all reflections between both sides
    expected = 100 * 0.01 / 4 * passed * Y00
    assert found[0] == pytest.approx(expected, rel=0.02)


def test_an_estimator_in_python_counts_light_of_lamps_once(cornell: Scene) -> None:
    """Its radiance along rays is all light, of which probes sample the part of lights themselves."""
    estimator = radiance_from(cornell, lambda origins, directions, numbers: np.full((len(origins), 3), 0.5))
    options = _core.ProbeOptions(component=_core.Component.indirect, order=3, samples=256, seed=0, threads=1)
    places = compiled(cornell).to_core(np.array([(0.0, -0.5, 0.6)])).astype(np.float32)
    values, _, dropped = _core.probes(compiled(cornell).core, places, estimator, options, _core.Progress())
    # 0.5 everywhere, less what the lamp emits where rays meet it.
    direct = at(cornell, 0.0, -0.5, 0.6, samples=4096, component="direct").coefficients[0, 0, 0, 0]
    assert dropped == 0
    assert np.asarray(values)[0, 0] == pytest.approx(0.5 / Y00 - direct, abs=0.15)


def test_probes_in_solids_are_found_and_filled() -> None:
    """A room with a solid block in its middle: the probe in the block is known, and gets the mean of what is around it."""
    white = Material("diffuse", {"reflectance": grey(0.5)})
    lamp = Material("diffuse", {"reflectance": grey(0.5)}, emission=grey(1.0))
    room = mesh([box((-1, -1, -1), (1, 1, 1)).inside_out()], lamp, "room")
    block = mesh([box((-0.3, -0.3, -0.3), (0.3, 0.3, 0.3))], white, "block")
    ball = mesh([icosphere(2).scaled(0.15, 0.15, 0.15).moved(0.6667, 0.6667, 0.6667)], white, "ball")
    grid = eclat.probes(Scene(meshes=(room, block, ball)), grid=(3, 3, 3), samples=512)
    assert [tuple(i) for i in np.argwhere(grid.inside)] == [(1, 1, 1), (2, 2, 2)]
    assert grid.statistics["inside"] == 2
    around = grid.coefficients[~grid.inside][:, 0, 0]
    assert around.min() < grid.coefficients[1, 1, 1, 0, 0] < around.max()
    assert (grid.coefficients[2, 2, 2, 0] > 0.5 * around.min()).all()


def test_a_one_sided_room_has_no_probes_behind_its_walls() -> None:
    """Seen from behind, the walls of a room that is drawn from one side only are not there; probes beside them would be
    lit by whatever is outside."""
    inside = Material("diffuse", {"reflectance": grey(0.5)}, emission=grey(1.0), two_sided=False)
    room = mesh([box((-1, -1, -1), (1, 1, 1)).inside_out()], inside, "room")
    grid = eclat.probes(Scene(meshes=(room,)), bounds=(-1.5, -1, -1, 1.5, 1, 1), grid=(6, 2, 2), samples=256)
    assert (grid.inside == (np.abs(grid.positions[..., 0]) > 1)).all()
    # The light inside is 2 everywhere, and so it is in what replaces the others.
    assert grid.coefficients[..., 0, :] == pytest.approx(2 / Y00, rel=0.1)


def test_the_same_bits_for_any_number_of_threads_and_another_seed_differs(cornell: Scene) -> None:
    one, two, other = (
        eclat.probes(cornell, eclat.PhotonMap(photons=5000), grid=(2, 2, 3), samples=64, threads=threads, seed=seed)
        for threads, seed in ((1, 0), (2, 0), (2, 1))
    )
    assert (one.coefficients == two.coefficients).all()
    assert (one.coefficients != other.coefficients).any()


def test_the_stated_noise_is_that_of_the_coefficients(cornell: Scene) -> None:
    reference = eclat.probes(cornell, grid=(4, 4, 4), samples=16384, seed=9)
    found = eclat.probes(cornell, grid=(4, 4, 4), samples=256)
    normals = np.random.default_rng(4).normal(size=(200, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    free = ~found.inside.reshape(-1)
    points = np.repeat(found.positions.reshape(-1, 3)[free], 200, axis=0)
    many = np.tile(normals, (int(free.sum()), 1))
    a, b = (luminance(g.irradiance(points, many)) for g in (found, reference))
    actual = float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)))
    assert actual < 2 * found.statistics["noise_error"] and found.statistics["noise_error"] < 3 * max(actual, 0.01)
    assert reference.statistics["noise_error"] < 0.5 * found.statistics["noise_error"]


def test_windows_leave_no_negative_light(cornell: Scene) -> None:
    plain = eclat.probes(cornell, grid=(4, 4, 4), samples=1024, component="direct")
    normals = np.random.default_rng(4).normal(size=(500, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    points = np.repeat(plain.positions.reshape(-1, 3), 500, axis=0)
    many = np.tile(normals, (64, 1))
    assert plain.irradiance(points, many).min() < -0.01
    errors = {}
    for window in ("nonnegative", "sloan"):
        grid = eclat.probes(cornell, grid=(4, 4, 4), samples=1024, component="direct", window=window)  # type: ignore[arg-type]
        found = grid.irradiance(points, many)
        assert found.min() > -1e-6 * found.max()
        assert grid.statistics["windowed"] > 10
        # The mean over all normals, band 0, stays.
        assert (grid.coefficients[~grid.inside][:, 0] == plain.coefficients[~grid.inside][:, 0]).all()
        errors[window] = grid.statistics["window_error"]
    assert 0 < errors["nonnegative"] < errors["sloan"]


def test_a_solution_serves_probes_and_must_fit(cornell: Scene, tmp_path: Path) -> None:
    solution = eclat.solve(cornell, eclat.IrradianceCache(max_error=0.1))
    grid = eclat.probes(cornell, solution, grid=(2, 2, 2), samples=256)
    assert grid.method == "irradiance-cache"
    # Rays end in the records; those of paths go on.
    paths = eclat.probes(cornell, grid=(2, 2, 2), samples=256)
    assert grid.statistics["rays"] < 0.7 * paths.statistics["rays"]
    with pytest.raises(eclat.EclatError, match="solved for another scene"):
        eclat.probes(build("furnace"), solution)
    with pytest.raises(eclat.EclatError, match="max_depth: expected -1"):
        eclat.probes(cornell, solution, max_depth=3)


def test_a_photometric_scene_gives_lux(cornell: Scene) -> None:
    from dataclasses import replace

    assert at(cornell, 0, 0, 0.5, samples=4).unit == "W/m2"
    assert at(replace(cornell, photometric=True), 0, 0, 0.5, samples=4).unit == "lux"


def test_an_interrupt_stops_the_probes(cornell: Scene) -> None:
    def stop(phase: str, fraction: float, statistics: dict[str, float]) -> None:
        if phase == "probes":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        eclat.probes(cornell, samples=1 << 20, progress=stop)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"grid": (0, 1, 1)}, "grid: expected 3 numbers of at least 1"),
        ({"grid": (10**6, 10**6, 10**6)}, "with a product of at most"),
        ({"bounds": (0, 0, 0, 0, 0, 0)}, "bounds: expected finite x0, y0, z0, x1, y1, z1"),
        ({"bounds": (1, 0, 0, 0, 1, 1)}, "bounds: expected finite"),
        ({"bounds": (0, 0, 0, float("nan"), 1, 1)}, "bounds: expected finite"),
        ({"bounds": (0, 0, 0, 1e30, 1, 1)}, "bounds: expected a box within"),
        ({"window": "hann"}, "did you mean 'hanning'"),
        ({"component": "all"}, "component must be one of"),
        ({"samples": 0}, "samples must be between"),
        ({"max_depth": 0}, "max_depth must be"),
        ({"what": "paths"}, "unknown method 'paths'"),
        ({"bounds": (-0.4, -0.5, -0.4, -0.3, -0.3, -0.3)}, "all lie inside of solids"),
    ],
)
def test_mistakes(cornell: Scene, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(eclat.EclatError, match=message):
        eclat.probes(cornell, **arguments)


def test_a_scene_without_surfaces_needs_bounds() -> None:
    empty = Scene(environment=Environment(np.ones((1, 1, 3), np.float32)))
    with pytest.raises(eclat.EclatError, match="expected a scene with surfaces"):
        eclat.probes(empty)
    found = at(empty, 0, 0, 0, samples=256).coefficients[0, 0, 0]
    assert found[0] == pytest.approx(1 / Y00, rel=1e-3)
