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
from eclat.methods.records.laws import core_options
from eclat.methods.records.solution import solved_from_core
from eclat.scene import Camera, Scene, look_at
from eclat.scenes import build

OPTIONS = eclat.IrradianceCache(max_error=0.05)
SIZE = (96, 72)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return build("cornell-box")


def growing(scene: Scene, threads: int = 0, caches: _core.SolvedCaches | None = None) -> _core.GrowingCache:
    options = core_options(OPTIONS, max_depth=-1, seed=0, threads=threads)
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
