# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records that grow view by view, against those of a solve for the view and against paths."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.measure.metrics import relative_rmse
from eclat.methods.records.laws import core_options, core_radiance_options
from eclat.methods.records.radiance_tables import radiance_tables
from eclat.methods.records.solution import solved_from_core
from eclat.scene import Camera, Environment, Material, Mesh, Scene, grey, look_at
from eclat.scenes import build, glossy_box

OPTIONS = eclat.IrradianceCache(max_error=0.05)
SIZE = (96, 72)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return build("cornell-box")


def growing(
    scene: Scene,
    threads: int = 0,
    caches: _core.SolvedCaches | None = None,
    method: eclat.IrradianceCache = OPTIONS,
) -> _core.GrowingCache:
    options = core_options(method, max_depth=-1, seed=0, threads=threads)
    return _core.GrowingCache(compiled(scene).core, options, caches or _core.SolvedCaches())


def grow(cache: _core.GrowingCache, scene: Scene, camera: Camera) -> int:
    """Make all passes for a view, and return how many records they added."""
    before = cache.caches.near_count
    cache.look(compiled(scene).camera(camera, SIZE))
    while cache.passes_left:
        cache.step(_core.Progress())
    return int(cache.caches.near_count - before)


def test_what_has_grown_serves_the_view_as_a_solve_does(scene: Scene) -> None:
    cache = growing(scene)
    added = grow(cache, scene, scene.cameras[0])
    solved = eclat.solve(scene, OPTIONS, size=SIZE, check=False)
    assert 0.7 * len(solved) < added < 1.4 * len(solved)
    grown = solved_from_core(scene, OPTIONS, cache.caches, {}, max_depth=-1, complete=True)
    a, b = (eclat.render(scene, eclat.Path(), size=SIZE, samples=64, seed=s).layers["indirect"] for s in (5, 6))
    errors = [
        relative_rmse(eclat.render(scene, s, size=SIZE, samples=64, seed=1).layers["indirect"], a, b)
        for s in (solved, grown)
    ]
    assert errors[1] < 1.3 * errors[0] + 0.01


def test_a_place_is_solved_once_and_another_view_adds_what_it_lacks(scene: Scene) -> None:
    cache = growing(scene)
    first = grow(cache, scene, scene.cameras[0])
    assert grow(cache, scene, scene.cameras[0]) < 0.03 * first
    before = np.asarray(cache.caches.near)
    other = Camera(look_at((0.0, 0.5, -0.9), (0, -0.3, 1.0)), fov=70)
    assert grow(cache, scene, other) > 20
    after = np.asarray(cache.caches.near)
    layout = {name: (begin, count) for name, begin, count in _core.record_layout()}
    begin, count = layout["positions"]
    # What was there stays where it was, in its order.
    assert (after[: len(before), begin : begin + count] == before[:, begin : begin + count]).all()


def test_growth_goes_on_from_a_solution(scene: Scene) -> None:
    solved = eclat.solve(scene, OPTIONS, size=SIZE, check=False)
    cache = growing(scene, caches=solved.core())
    assert grow(cache, scene, scene.cameras[0]) < 0.03 * len(solved)


def test_the_same_views_give_the_same_bits_on_one_thread_and_two(scene: Scene) -> None:
    found = []
    for threads in (1, 2):
        cache = growing(scene, threads)
        grow(cache, scene, scene.cameras[0])
        found.append(np.asarray(cache.caches.near))
    assert (found[0] == found[1]).all()


def test_a_cancelled_pass_is_made_again(scene: Scene) -> None:
    cache = growing(scene)
    cache.look(compiled(scene).camera(scene.cameras[0], SIZE))
    left = cache.passes_left
    progress = _core.Progress()
    progress.cancel()
    with pytest.raises(_core.Cancelled):
        cache.step(progress)
    assert cache.passes_left == left
    cache.step(_core.Progress())
    assert cache.passes_left == left - 1
    while cache.passes_left:
        cache.step(_core.Progress())
    plain = growing(scene)
    grow(plain, scene, scene.cameras[0])
    assert (np.asarray(cache.caches.near) == np.asarray(plain.caches.near)).all()


GLOSSY = eclat.RadianceCache(max_error=0.1)


@pytest.fixture(scope="module")
def glossy() -> Scene:
    return glossy_box.build(alpha=0.4)


def growing_gloss(
    scene: Scene,
    threads: int = 0,
    caches: _core.SolvedCaches | None = None,
    method: eclat.RadianceCache = GLOSSY,
) -> _core.GrowingCache:
    options = core_radiance_options(method, threads=threads)
    tables = radiance_tables(scene, method)
    return _core.GrowingCache(compiled(scene).core, options, tables, caches or _core.SolvedCaches())


def test_radiance_that_has_grown_serves_the_view_as_a_solve_does(glossy: Scene) -> None:
    cache = growing_gloss(glossy)
    grow(cache, glossy, glossy.cameras[0])
    solved = eclat.solve(glossy, GLOSSY, size=SIZE, check=False)
    grown = solved_from_core(glossy, GLOSSY, cache.caches, {}, max_depth=-1, complete=True)
    assert grown.radiance is not None and solved.radiance is not None
    assert 0.6 * len(solved.radiance) < len(grown.radiance) < 1.5 * len(solved.radiance)
    a, b = (eclat.render(glossy, eclat.Path(), size=SIZE, samples=64, seed=s).layers["indirect"] for s in (5, 6))
    pictures = [eclat.render(glossy, s, size=SIZE, samples=64, seed=1) for s in (solved, grown)]
    cached = [picture.layers["gloss_cached"] for picture in pictures]
    assert cached[1].mean() > 0.95 * cached[0].mean() > 0.05
    both = (cached[0] > 0.99) & (cached[1] > 0.99)
    errors = [relative_rmse(picture.layers["indirect"], a, b, mask=both) for picture in pictures]
    assert errors[1] < 1.3 * errors[0] + 0.01
    # The same view adds nothing, and another one what it lacks, behind what there was.
    before = np.array(cache.caches.radiance_records)
    grow(cache, glossy, glossy.cameras[0])
    assert len(cache.caches.radiance_records) < 1.03 * len(before)
    grow(cache, glossy, Camera(look_at((0.4, 0.6, 0.9), (-0.2, -0.9, -0.4)), fov=60))
    after = np.asarray(cache.caches.radiance_records)
    assert len(after) > 1.1 * len(before)
    assert (after[: len(before), :3] == before[:, :3]).all()


def test_radiance_grows_on_from_a_file(glossy: Scene) -> None:
    solved = eclat.solve(glossy, GLOSSY, size=SIZE, check=False)
    cache = growing_gloss(glossy, caches=solved.core())
    grow(cache, glossy, Camera(look_at((0.4, 0.6, 0.9), (-0.2, -0.9, -0.4)), fov=60))
    assert solved.radiance is not None
    assert len(cache.caches.radiance_records) > 1.1 * len(solved.radiance)


def test_radiance_grows_to_the_same_bits_on_one_thread_and_two(glossy: Scene) -> None:
    found = []
    for threads in (1, 2):
        cache = growing_gloss(glossy, threads)
        cache.look_everywhere()
        grow(cache, glossy, glossy.cameras[0])
        for _ in range(8):
            cache.step(_core.Progress())
        found.append(cache.caches)
    for name in ("near", "radiance_records", "radiance_values"):
        assert (np.asarray(getattr(found[0], name)) == np.asarray(getattr(found[1], name))).all()


def two_walls(gloss: bool = False) -> Scene:
    """Two walls that face each other under a sky, of which the camera sees one."""
    rough = {"eta": grey(0.2), "k": grey(3.0), "alpha_u": grey(0.5), "alpha_v": grey(0.5)}
    material = Material("conductor", rough) if gloss else Material("diffuse", {"reflectance": grey(0.5)})
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    front = Mesh(corners, triangles, material)
    behind = Mesh(corners + np.array([0, 0, 5]), triangles[:, ::-1], material)
    sky = Environment(np.full((1, 1, 3), 0.5, np.float32))
    return Scene((front, behind), environment=sky, cameras=(Camera(look_at((0, 0, 2.5), (0, 0, 0)), fov=50),))


@pytest.mark.parametrize("gloss", [False, True], ids=["irradiance", "radiance"])
def test_all_surfaces_are_solved_behind_the_views(gloss: bool) -> None:
    scene = two_walls(gloss)
    cache = growing_gloss(scene) if gloss else growing(scene)
    cache.look_everywhere()
    cache.look(compiled(scene).camera(scene.cameras[0], SIZE))
    while cache.passes_left:  # the view comes first
        cache.step(_core.Progress())
    middle = 2.5 - compiled(scene).center[2]
    records = np.asarray(cache.caches.radiance_records if gloss else cache.caches.near)
    assert cache.surfaces_left and len(records) and (records[:, 2] < middle).all()
    while cache.surfaces_left:
        cache.step(_core.Progress())
    cache.step(_core.Progress())  # there is nothing to do
    after = np.asarray(cache.caches.radiance_records if gloss else cache.caches.near)
    assert (after[:, 2] > middle).sum() >= 0.3 * len(records)
    if not gloss:
        points = np.random.default_rng(1).uniform(-0.95, 0.95, (500, 3)).astype(np.float32)
        points[:, 2] = middle + 2.5
        weights = cache.caches.read_near(points, np.tile(np.float32([0, 0, -1]), (500, 1)))[1]
        assert (np.asarray(weights) > 0).mean() > 0.99
