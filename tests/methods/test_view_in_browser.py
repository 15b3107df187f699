# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The page of `eclat view` in headless Chromium, beside `eclat render` and the core: the same weights, the same light."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

import eclat
from eclat import _core, scenes
from eclat.measure.metrics import away_from_edges, relative_rmse
from eclat.methods.records.laws import core_options
from eclat.methods.records.solution import Solution
from eclat.scene import (
    Camera,
    DirectionalLight,
    Environment,
    FloatArray,
    Material,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
    look_at,
    rgb,
)
from eclat.scenes import glossy_box
from eclat.scenes.geometry import box as solid_box
from eclat.scenes.geometry import mesh
from eclat.viewer.contents import GLOSS, RECORDS
from eclat.viewer.messages import decode_message, encode_message
from support.browser import ViewedPage, keep_records, look_at_page, require_browser, require_node, require_page

SIZE = (160, 120)

SAMPLES = 64
"""Paths a pixel of each of two references, so that their noise cancels from the error."""

POINTS = 10_000

BRIGHTER = 1e5
"""Factor of light that half floats could not hold."""

LIGHT_OF_A_ROW = [*range(12, 36), 51]
"""The numbers of a row of a record that are proportional to its light."""

SWITCHED: tuple[dict[str, object], ...] = (
    {"weight": "ward"},
    {"weight": "split-sphere"},
    {"gradients": False},
    {"clamping": False},
)
"""What the page's switches do to weights and values is compared with the core, which has options for them."""


@dataclass(frozen=True)
class Shown:
    """A scene, its records, points near them, and what the page made of all."""

    scene: Scene
    solution: Solution
    points: FloatArray
    normals: FloatArray
    page: ViewedPage
    origin: str
    """The address of the server, without the token."""


def supersampled(pixels: FloatArray, times: int) -> FloatArray:
    """Average blocks of pixels, because the page takes one sample of a pixel and `render` averages over it."""
    height, width, channels = pixels.shape
    return pixels.reshape(height // times, times, width // times, times, channels).mean(axis=(1, 3))


def points_near(solution: Solution, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Points off the records by up to twice their radii, most in their planes, with normals turned by up to some degrees."""
    chosen = rng.choice(np.flatnonzero(~solution.enclosed), POINTS)
    normals = solution.normals[chosen].astype(np.float64)
    away = rng.normal(size=(POINTS, 3))
    away -= (1 - 0.01 * rng.random((POINTS, 1))) * (away * normals).sum(axis=1, keepdims=True) * normals
    away *= (2 * rng.random(POINTS) * solution.radii[chosen] / np.linalg.norm(away, axis=1))[:, None]
    turned = normals + rng.normal(size=(POINTS, 3)) * (rng.random(POINTS) < 0.5)[:, None] * 0.05
    turned /= np.linalg.norm(turned, axis=1, keepdims=True)
    local = solution.positions[chosen] - solution.center + away
    return local.astype(np.float32), turned.astype(np.float32)


@pytest.fixture(scope="module")
def cornell_box() -> Shown:
    require_node(), require_browser(), require_page()
    scene = scenes.build("cornell-box")
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.02), size=SIZE, check=False)
    points, normals = points_near(solution, np.random.default_rng(1))
    picture = {"camera": 0, "width": SIZE[0], "height": SIZE[1]}
    with eclat.view(scene, solution, texel_size=0.03, samples=64) as viewer:
        keep_records(viewer)
        pictures = [picture, {**picture, "look": {"direct": False}}]
        page = look_at_page(viewer.url, pictures, points, normals, looks=[{}, *SWITCHED])
        origin = viewer.url.rsplit("/", 2)[0]
    return Shown(scene, solution, points, normals, page, origin)


def test_the_page_says_nothing_wrong_and_asks_this_server_only(cornell_box: Shown) -> None:
    page = cornell_box.page
    assert page.message == "" and page.messages == []
    assert page.requests and all(request.startswith(cornell_box.origin) for request in page.requests)


def test_weights_and_values_are_those_of_the_core(cornell_box: Shown) -> None:
    expected, weights = cornell_box.solution.core().read_near(cornell_box.points, cornell_box.normals)
    sums = cornell_box.page.sums[:POINTS]
    assert len(sums) == POINTS and 0.5 < (weights > 0).mean() < 1
    # Where a weight vanishes, at its border, rounding decides whether it does.
    clear = weights > 0.02
    np.testing.assert_allclose(sums[clear, 3], weights[clear], rtol=1e-4)
    np.testing.assert_allclose(sums[clear, :3] / sums[clear, 3:], expected[clear], rtol=1e-4)
    assert (sums[weights == 0, 3] < 1e-5).all()


def test_estimated_errors_are_those_of_the_core(cornell_box: Shown) -> None:
    caches, errors = cornell_box.solution.core(), cornell_box.page.errors
    points, normals = cornell_box.points[: len(errors)], cornell_box.normals[: len(errors)]
    expected, weights = caches.estimated_errors(points, normals), caches.read_near(points, normals)[1]
    assert len(errors) == 2000 and ((expected >= 0) == (weights > 0)).all()
    clear = weights > 0.02
    assert (errors[clear, 3] == 1).all() and (errors[weights == 0, 3] == 0).mean() > 0.99
    assert np.quantile(expected[clear], 0.1) < 0.7 * np.quantile(expected[clear], 0.9)
    np.testing.assert_allclose(errors[clear, 0], expected[clear], rtol=3e-4)


def switched_core(solution: Solution, look: dict[str, object]) -> _core.SolvedCaches:
    """The records of the core, read as a page with that look reads them."""
    options = core_options(solution.options)
    near = np.array(solution.near)
    match look:
        case {"weight": weight}:
            options = core_options(replace(solution.options, weight=str(weight)))
        case {"gradients": _}:
            options = core_options(replace(solution.options, rotation_gradient=False, translation_gradient=False))
        case {"clamping": _}:
            columns = {name: first for name, first, _ in _core.record_layout()}
            length, least, largest = (near[:, columns[k]] for k in ("distances", "least_radii", "largest_radii"))
            near[:, columns["radii"]] = np.clip(options.spacing * length, least, largest)
            options = core_options(replace(solution.options, neighbor_clamping=False))
    return _core.SolvedCaches(near, np.ascontiguousarray(solution.far), options)


@pytest.mark.parametrize("number", range(len(SWITCHED)), ids=[next(iter(look)) for look in SWITCHED])
def test_switches_do_what_options_of_the_core_do(cornell_box: Shown, number: int) -> None:
    usual, sums = (cornell_box.page.sums[k * POINTS : (k + 1) * POINTS] for k in (0, number + 1))
    assert not np.allclose(usual, sums, rtol=1e-3)
    core = switched_core(cornell_box.solution, SWITCHED[number])
    expected, weights = core.read_near(cornell_box.points, cornell_box.normals)
    clear = weights > 0.02
    assert clear.mean() > 0.5
    np.testing.assert_allclose(sums[clear, 3], weights[clear], rtol=3e-4)
    # The excess that records share depends on the weights, and the page keeps that of the core.
    shared = "weight" in SWITCHED[number] or "clamping" in SWITCHED[number]
    values, exact = sums[clear, :3] / sums[clear, 3:], expected[clear]
    off = np.abs(values - exact) / np.maximum(exact, 1e-6 * exact.max())
    assert np.quantile(off, 0.99) < (3e-2 if shared else 1e-4)


def test_the_picture_is_that_of_render(cornell_box: Shown) -> None:
    a, b = (
        eclat.render(cornell_box.scene, cornell_box.solution, size=SIZE, samples=SAMPLES, seed=seed) for seed in (1, 2)
    )
    inside = away_from_edges(a.layers["depth"], a.layers["normal"])
    assert inside.mean() > 0.5
    error = relative_rmse(cornell_box.page.pictures[0], a.pixels, b.pixels, mask=inside)
    assert error < 0.02, f"{error:.4f}"


def test_half_floats_cost_little_whatever_the_unit_of_light(cornell_box: Shown) -> None:
    picture = {"camera": 0, "width": SIZE[0], "height": SIZE[1], "look": {"direct": False}}
    with eclat.view(cornell_box.scene, cornell_box.solution, texel_size=0.3, samples=4) as viewer:
        keep_records(viewer)
        header, arrays = decode_message(viewer._files[RECORDS])
        rows = arrays["rows"].copy()
        rows[:, LIGHT_OF_A_ROW] *= BRIGHTER
        viewer._files[RECORDS] = encode_message(header.pop("kind"), header, {"rows": rows})
        page = look_at_page(viewer.url, [picture], halves=True)
    assert page.message == "" and page.messages == []
    halves, floats = page.pictures[0] / BRIGHTER, cornell_box.page.pictures[1]
    assert 0 < np.sqrt(np.square(halves - floats).mean() / np.square(floats).mean()) < 0.003


def lamps_over_a_table() -> Scene:
    """A point, two spots, a sun and a sky that is alike everywhere, above a floor and a box."""
    floor = Material("diffuse", {"reflectance": rgb(0.5, 0.45, 0.4)}, name="floor")
    box = Material("diffuse", {"reflectance": rgb(0.2, 0.4, 0.7)}, name="box")
    ground = [(-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)]
    meshes = (
        Mesh(np.array(ground, float), np.array([[0, 1, 2], [0, 2, 3]]), floor, name="floor"),
        mesh([solid_box((-0.5, 0, -0.4), (0.5, 0.8, 0.4))], box, "box"),
    )
    lights = (
        PointLight((-1.2, 1.5, 0.8), (1.5, 1.2, 1.0)),
        SpotLight((1.5, 2, 1), (-0.4, -1, -0.5), (3, 3, 4), 15, 35, "smooth"),
        SpotLight((0.5, 2.5, -1.5), (-0.2, -1, 0.3), (3, 4, 2), 10, 30, "linear"),
        DirectionalLight((0.6, -1, -0.3), (1, 0.9, 0.8), 1.5),
    )
    sky = Environment(np.full((1, 1, 3), 0.15, np.float32))
    camera = Camera(look_at((2, 3, 4), (0, 0.2, 0)), fov=40, name="camera")
    return Scene(meshes=meshes, lights=lights, environment=sky, cameras=(camera,), name="lamps")


def test_lamps_and_sky_are_those_of_render() -> None:
    require_node(), require_browser(), require_page()
    scene = lamps_over_a_table()
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.02), size=SIZE, check=False)
    asked = {"camera": 0, "width": 3 * SIZE[0], "height": 3 * SIZE[1]}
    with eclat.view(scene, solution) as viewer:
        keep_records(viewer)
        page = look_at_page(viewer.url, [asked])
    assert page.message == "" and page.messages == []
    a, b = (eclat.render(scene, solution, size=SIZE, samples=SAMPLES, seed=seed) for seed in (1, 2))
    inside = away_from_edges(a.layers["depth"], a.layers["normal"])
    error = relative_rmse(supersampled(page.pictures[0], 3), a.pixels, b.pixels, mask=inside)
    assert error < 0.02, f"{error:.4f}"


def keep_orders(files: dict[str, bytes], order: int) -> None:
    """Take from the records of radiance that a viewer serves what is above an order."""
    header, arrays = decode_message(files[GLOSS])
    coefficients = arrays["coefficients"].copy()
    coefficients[:, :, order**2 :] = 0
    files[GLOSS] = encode_message(header.pop("kind"), header, arrays | {"coefficients": coefficients})


def test_gloss_is_that_of_render() -> None:
    require_node(), require_browser(), require_page()
    scene = glossy_box.build(alpha=0.4)
    solution = eclat.solve(scene, eclat.RadianceCache(max_error=0.02), size=SIZE, check=False)
    asked = {"camera": 0, "width": SIZE[0], "height": SIZE[1]}
    with eclat.view(scene, solution, texel_size=0.03, samples=64) as viewer:
        keep_records(viewer)
        page = look_at_page(viewer.url, [asked, {**asked, "look": {"order": 3}}])
        keep_orders(viewer._files, 3)
        lower = look_at_page(viewer.url, [asked])
    assert page.message == "" and page.messages == []
    # The switch for the order leaves out what is above it.
    np.testing.assert_allclose(page.pictures[1], lower.pictures[0], rtol=1e-3, atol=1e-4)
    assert np.abs(page.pictures[0] - page.pictures[1]).max() > 0.01
    a, b = (eclat.render(scene, solution, size=SIZE, samples=SAMPLES, seed=seed) for seed in (1, 2))
    # What is too sharp for the records is traced by `render` and left out by the page.
    cached = a.layers["gloss_cached"] > 0.99
    inside = away_from_edges(a.layers["depth"], a.layers["normal"]) & cached
    assert inside.mean() > 0.05
    error = relative_rmse(page.pictures[0], a.pixels, b.pixels, mask=inside)
    assert error < 0.04, f"{error:.4f}"
