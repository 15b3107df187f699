# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures, points and light maps on workers have the bits of one process, also when workers are killed meanwhile."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import eclat
from eclat import _core
from eclat.farm.farm import Farm
from eclat.images.image import Image
from support.clusters import local_client


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    with local_client(2) as client:
        yield client


def same(a: Image, b: Image) -> bool:
    """Compare pixels, layers and all statistics but the time."""
    layers = all(np.array_equal(a.layers[name], b.layers[name], equal_nan=True) for name in a.layers)
    statistics = [{k: v for k, v in image.metadata["statistics"].items() if k != "seconds"} for image in (a, b)]
    return (
        np.array_equal(a.pixels, b.pixels)
        and layers
        and set(a.layers) == set(b.layers)
        and statistics[0] == statistics[1]
    )


@pytest.mark.parametrize(
    ("method", "settings"),
    [
        ("path", {"samples": 3}),
        ("path", {"samples": 4, "filter": "tent", "crop": (5, 7, 60, 38)}),
        ("path", {"max_error": 0.3, "denoise": True}),
        ("path", {"samples": 8, "adaptive": True, "halves": True}),
        ("irradiance-cache", {"max_error": 0.2, "denoise": False}),
        ("radiance-cache", {"samples": 2}),
    ],
)
def test_pictures_are_the_same(client: Any, method: str, settings: dict[str, Any]) -> None:
    here = eclat.render("cornell-box", method, size=(72, 40), threads=1, **settings)
    with Farm(client) as farm:
        there = eclat.render("cornell-box", method, size=(72, 40), threads=1, **settings)
        assert farm.ranges_sent >= 4
    assert same(here, there)


def test_a_picture_with_new_photons_for_each_sample_is_the_same(client: Any) -> None:
    method = eclat.PhotonMap(photons=2000)
    here = eclat.render("furnace", method, size=(40, 40), samples=2, threads=1)
    with Farm(client):
        assert same(here, eclat.render("furnace", method, size=(40, 40), samples=2, threads=1))


def test_a_picture_is_continued(client: Any) -> None:
    begun = eclat.render("cornell-box", "path", size=(40, 40), samples=2, continuable=True)
    with Farm(client):
        continued = eclat.render("cornell-box", "path", samples=4, continued=begun)
    assert np.array_equal(continued.pixels, eclat.render("cornell-box", "path", size=(40, 40), samples=4).pixels)


@pytest.mark.parametrize(
    ("method", "for_view"),
    [
        (eclat.PhotonMap(photons=20_000), {}),
        (eclat.IrradianceCache(max_error=0.2), {"size": (48, 32)}),
        (eclat.RadianceCache(max_error=0.2), {"size": (48, 32)}),
    ],
)
def test_solutions_and_their_stated_errors_are_the_same(
    client: Any, method: eclat.Method, for_view: dict[str, Any]
) -> None:
    common: dict[str, Any] = {"seed": 2, **for_view}
    here = eclat.solve("glossy-box", method, **common)
    with Farm(client) as farm:
        there = eclat.solve("glossy-box", method, **common)
        assert farm.ranges_sent >= 4
    for name, values in here.arrays().items():
        assert np.array_equal(values, there.arrays()[name]), name
    statistics = [{k: v for k, v in one.statistics.items() if k != "seconds"} for one in (here, there)]
    assert statistics[0] == statistics[1]


def test_samples_that_are_not_finite_are_counted_once_and_the_first_are_kept() -> None:
    film = _core.Film(4, 2)
    film.add_bad(2, [(3, 1, 7), (0, 0, 9)])
    film.add_bad(1, [(2, 1, 1)])
    assert film.bad_count == 3
    assert film.bad_samples == [(2, 1, 1), (3, 1, 7), (0, 0, 9)]


def test_a_rectangle_of_a_film_is_replaced() -> None:
    film, rectangle = _core.Film(6, 5), (1, 2, 4, 5)
    sums = np.random.default_rng(1).integers(0, 9, (3, 3, 24)).astype(np.float32)
    film.restore_within(sums, 1, 2)
    assert np.array_equal(film.sums_within(rectangle), sums)
    assert np.asarray(film.sums()).sum() == sums.sum()
    for wrong in ((-1, 0, 2, 2), (4, 0, 7, 2), (0, 3, 2, 6)):
        with pytest.raises(ValueError, match="expected a rectangle inside 6x5 pixels"):
            film.sums_within(wrong)


@pytest.mark.parametrize("method", ["path", "irradiance-cache"])
def test_points_are_the_same(client: Any, method: str) -> None:
    chance = np.random.default_rng(1)
    points, normals = chance.uniform((-0.5, 0.5, -0.5), (0.5, 1.5, 0.5), (300, 3)), chance.normal(size=(300, 3))
    counts: tuple[dict[str, float], dict[str, float]] = ({}, {})
    common: dict[str, Any] = {"samples": 16, "max_error": 0.2}
    here = eclat.irradiance("cornell-box", points, normals, method, statistics=counts[0], **common)
    with Farm(client) as farm:
        there = eclat.irradiance("cornell-box", points, normals, method, statistics=counts[1], **common)
        assert farm.ranges_sent >= 4
    assert np.array_equal(here, there)
    assert {k: v for k, v in counts[0].items() if k != "seconds"} == {
        k: v for k, v in counts[1].items() if k != "seconds"
    }


def test_a_light_map_is_the_same(client: Any) -> None:
    common: dict[str, Any] = {"texel_size": 0.2, "samples": 16, "max_error": 0.3}
    here = eclat.bake("cornell-box", **common)
    with Farm(client):
        assert np.array_equal(here.irradiance, eclat.bake("cornell-box", **common).irradiance)


@pytest.mark.slow
@pytest.mark.parametrize(
    "method",
    [eclat.IrradianceCache(max_error=0.1), eclat.RadianceCache(max_error=0.2), eclat.PhotonMap(photons=50_000)],
)
def test_a_picture_is_the_same_when_workers_are_killed_at_random(client: Any, method: eclat.Method) -> None:
    common: dict[str, Any] = {"size": (96, 64), "samples": 16, "denoise": False}
    here = eclat.render("glossy-box", method, **common)
    chance = np.random.default_rng(5)
    killed: list[str] = []

    def kill(phase: str, share: float, statistics: dict[str, float]) -> None:
        if len(killed) == 3 or share <= 0 or chance.random() > 0.3:
            return
        victims = list(client.run(os.getpid, on_error="ignore").values())
        # Dask gives up a worker that dies while it starts, so that both could be lost for ever.
        if len(victims) == 2:
            killed.append(phase)
            os.kill(victims[chance.integers(len(victims))], signal.SIGKILL)

    with Farm(client, patience=300):  # workers of a busy machine may take a minute to start again
        there = eclat.render("glossy-box", method, progress=kill, **common)
    assert killed
    assert same(here, there)
