# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Steps that processes share: what each finds is used everywhere in the order of one process."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import eclat
from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.farm.shared_work import JOINED, Digests, StepRange, compute_range, end_sessions
from eclat.farm.worker import Bench
from eclat.methods.photon_tracing import PhotonRequest, SharedTracing
from eclat.methods.records.laws import core_options
from eclat.methods.records.solving import Job, SharedCheck, SharedSolve
from eclat.methods.work import View, Work

SIZE = (48, 32)
WORK = Work(max_depth=-1, seed=3)


@pytest.fixture(autouse=True)
def no_sessions_are_left() -> Iterator[None]:
    yield
    end_sessions()


def view() -> tuple[eclat.Scene, View]:
    scene = eclat.load("cornell-box")
    return scene, View(scene.cameras[0], SIZE)


def filled(share: Any = None, tell: Any = None) -> tuple[np.ndarray, int]:
    """Solve records of the Cornell box with an exchange; return the rows of the near cache and the number of rays."""
    scene, seen = view()
    settings = core_options(
        eclat.IrradianceCache(max_error=0.2, least_pixels=1, rows=8), max_depth=-1, seed=3, threads=1
    )
    if share is not None:
        settings.share_work(share, tell or (lambda _: None))
    caches, progress, prepared = _core.SolvedCaches(), _core.Progress(), compiled(scene)
    _core.solve_for_cameras(prepared.core, [prepared.camera(seen.camera, SIZE)], settings, caches, progress)
    return np.asarray(caches.near), int(progress.rays)


class Followed:
    """An exchange whose ranges a session computes, which starts anew in every fifth step, as if the worker had died."""

    def __init__(self, work: Any) -> None:
        self.work = work
        self.digests, self.number = Digests(), -1
        self.told = self.found = 0

    def share(self, count: int, rays_of_item: int, compute: Any) -> list[bytes]:
        assert count >= 0 and rays_of_item >= 1
        self.number += 1
        if self.number % 5 == 4:
            end_sessions()  # the next one takes all digests so far
        before = self.digests.parcels()
        bench, middle = Bench(1, lambda *_: None, before), count // 2
        ranges = [StepRange(self.number, first, end, tuple(before)) for first, end in ((0, middle), (middle, count))]
        found = [compute_range(self.work, one, bench) for one in ranges]
        self.found += sum(map(len, found))
        return found

    def tell(self, digest: bytes) -> None:
        self.told += len(digest)
        self.digests.add(digest)


def test_gathers_in_ranges_are_those_of_one_process() -> None:
    def in_parts(count: int, rays_of_item: int, compute: Any) -> list[bytes]:
        return [compute(first, min(first + 7, count)) for first in range(0, count, 7)]

    alone, rays = filled()
    parted, parted_rays = filled(in_parts)
    assert np.array_equal(alone, parted) and len(alone) > 50
    assert rays == parted_rays


def test_sessions_gather_what_one_process_would_also_when_they_come_late() -> None:
    scene, seen = view()
    followed = Followed(SharedSolve(scene, seen, eclat.IrradianceCache(max_error=0.2, least_pixels=1, rows=8), WORK))
    alone, rays = filled()
    shared, shared_rays = filled(followed.share, followed.tell)
    assert np.array_equal(alone, shared)
    assert rays == shared_rays
    assert followed.number > 5
    # Most of what gathers find is not what the next step needs.
    assert followed.told < 0.8 * followed.found


def test_records_of_radiance_are_shared() -> None:
    scene = eclat.load("glossy-box")
    seen = View(scene.cameras[0], SIZE)
    options = eclat.RadianceCache(max_error=0.3, least_pixels=1)
    followed = Followed(SharedSolve(scene, seen, options, WORK))
    found = []
    for exchange in (None, (followed.share, followed.tell)):
        caches, counted = _core.SolvedCaches(), _core.Progress()
        Job(scene, seen, replace(WORK, threads=1)).fill(options, caches, None, exchange)(counted)
        found.append((np.asarray(caches.near), np.asarray(caches.radiance_values), int(counted.rays)))
    assert len(found[0][1]) > 20
    for one, other in zip(*found, strict=True):
        assert np.array_equal(one, other)


def test_probes_of_errors_are_shared() -> None:
    scene, seen = view()
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.2, least_pixels=1, rows=8), size=SIZE, check=False)
    followed = Followed(SharedCheck(scene, seen, solution, WORK, 200_000, 0.01))
    found = []
    for exchange in (None, (followed.share, followed.tell)):
        check, counted = _core.ErrorCheck(), _core.Progress()
        check.rays, check.wanted, check.max_depth, check.seed, check.threads = 200_000, 0.01, -1, 3, 1
        if exchange is not None:
            check.share_work(*exchange)
        prepared = compiled(scene)
        camera = prepared.camera(seen.camera, SIZE)
        estimate = _core.estimate_error_for_camera(prepared.core, camera, solution.core(), check, counted)
        found.append((estimate.squared, estimate.deviation, estimate.missed, int(counted.rays)))
    assert found[0] == found[1] and followed.number >= 3


@pytest.mark.parametrize("caustic", [False, True])
def test_paths_of_photons_are_shared_and_only_their_numbers_are_told(caustic: bool) -> None:
    scene = eclat.load("glossy-box")
    request = PhotonRequest(caustic, 30_000, -1, True)
    followed = Followed(SharedTracing(scene, request, WORK))
    found = []
    for exchange in (None, (followed.share, followed.tell)):
        tracing, counted = request.core_options(replace(WORK, threads=1)), _core.Progress()
        if exchange is not None:
            tracing.share_work(*exchange)
        photons, paths = _core.trace_photons(compiled(scene).core, tracing, counted)
        found.append((photons, paths, int(counted.rays)))
    assert len(found[0][0]) >= 30_000
    for one, other in zip(*found, strict=True):
        assert np.array_equal(one, other)
    assert followed.told < 0.05 * followed.found


@pytest.mark.parametrize("damage", [lambda found: found[:-1], lambda found: [found[0][:-1], *found[1:]]])
def test_damaged_gathers_are_refused(damage: Callable[[list[bytes]], list[bytes]]) -> None:
    def damaged(count: int, rays_of_item: int, compute: Any) -> list[bytes]:
        return list(damage([compute(0, count // 2), compute(count // 2, count)]))

    with pytest.raises(ValueError, match="expected"):
        filled(damaged)


def test_an_error_of_the_exchange_ends_the_solve() -> None:
    def broken(count: int, rays_of_item: int, compute: Any) -> list[bytes]:
        raise KeyError("no worker")

    with pytest.raises(KeyError, match="no worker"):
        filled(broken)


def test_few_parcels_hold_many_digests() -> None:
    digests = Digests()
    found = [f"{n // 2}".encode() for n in range(100)]  # two steps may have found the same
    names: set[str] = set()
    for n, one in enumerate(found):
        digests.add(one)
        parcels = digests.parcels()
        names |= set(parcels)
        assert [p for content in parcels.values() for p in pickle.loads(content)] == found[: n + 1]
        assert len(parcels) < 2 * JOINED
    assert len(names) == 100  # one new parcel a step, of which three hold the steps before as well
