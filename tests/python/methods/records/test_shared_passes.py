# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Passes that processes share: what each finds is inserted everywhere in the order of one process."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import eclat
from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.farm.worker import Bench
from eclat.methods.records.laws import core_options
from eclat.methods.records.shared_passes import (
    JOINED,
    GatherRange,
    Pass,
    Passes,
    SharedSolve,
    end_sessions,
    gather_range,
)
from eclat.methods.work import View, Work

SIZE = (48, 32)


def filled(exchange: Any, threads: int = 1) -> tuple[np.ndarray, int]:
    """Solve records of the Cornell box with an exchange; return the rows of the near cache and the number of rays."""
    scene = eclat.load("cornell-box")
    settings = core_options(eclat.IrradianceCache(max_error=0.2), max_depth=-1, seed=3, threads=threads)
    if exchange is not None:
        settings.exchange_gathers(exchange)
    caches, progress, prepared = _core.SolvedCaches(), _core.Progress(), compiled(scene)
    _core.solve_for_cameras(prepared.core, [prepared.camera(scene.cameras[0], SIZE)], settings, caches, progress)
    return np.asarray(caches.near), int(progress.rays)


def test_gathers_in_ranges_are_those_of_one_process() -> None:
    def in_parts(count: int, compute: Any) -> Pass:
        return [compute(first, min(first + 7, count)) for first in range(0, count, 7)]

    alone, rays = filled(None)
    parted, parted_rays = filled(in_parts)
    assert np.array_equal(alone, parted) and len(alone) > 50
    assert rays == parted_rays


def test_sessions_gather_what_one_process_would_also_when_they_come_late() -> None:
    scene = eclat.load("cornell-box")
    solve = SharedSolve(
        scene, View(scene.cameras[0], SIZE), eclat.IrradianceCache(max_error=0.2), Work(max_depth=-1, seed=3)
    )
    passes = Passes()
    number = -1

    def by_session(count: int, compute: Any) -> Pass:
        nonlocal number
        number += 1
        if number % 5 == 4:
            end_sessions()  # as if the worker died; the next one inserts all passes so far
        before = passes.parcels()
        bench = Bench(1, lambda *_: None, before)
        middle = count // 2
        found = [
            gather_range(solve, GatherRange(number, first, end, tuple(before)), bench)
            for first, end in ((0, middle), (middle, count))
        ]
        passes.add(found)
        return found

    alone, rays = filled(None)
    shared, shared_rays = filled(by_session)
    end_sessions()
    assert np.array_equal(alone, shared)
    assert rays == shared_rays


@pytest.mark.parametrize("damage", [lambda found: found[:-1], lambda found: [found[0][:-1], *found[1:]]])
def test_damaged_gathers_are_refused(damage: Any) -> None:
    def damaged(count: int, compute: Any) -> Pass:
        return list(damage([compute(0, count // 2), compute(count // 2, count)]))

    with pytest.raises(ValueError, match="gathers: expected"):
        filled(damaged)


def test_an_error_of_the_exchange_ends_the_solve() -> None:
    def broken(count: int, compute: Any) -> Pass:
        raise KeyError("no worker")

    with pytest.raises(KeyError, match="no worker"):
        filled(broken)


def test_few_parcels_hold_many_passes() -> None:
    passes = Passes()
    found = [[f"{n // 2}".encode()] for n in range(100)]  # two passes may have found the same
    names: set[str] = set()
    for n, one in enumerate(found):
        passes.add(one)
        parcels = passes.parcels()
        names |= set(parcels)
        assert [p for content in parcels.values() for p in pickle.loads(content)] == found[: n + 1]
        assert len(parcels) < 2 * JOINED
    assert len(names) == 100  # one new parcel a pass, of which three hold the passes before as well
