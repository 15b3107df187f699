# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Photons as a value."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.scenes import build

OPTIONS = eclat.PhotonMap(photons=5000, caustic_photons=2000)


@pytest.fixture(scope="module")
def scene() -> eclat.Scene:
    return build("glossy-box")


@pytest.fixture(scope="module")
def photons(scene: eclat.Scene) -> eclat.Photons:
    return eclat.solve(scene, OPTIONS)


def test_arrays(photons: eclat.Photons) -> None:
    n = len(photons)
    assert n == len(photons.stored) + len(photons.caustic) > 7000
    assert (
        photons.positions.shape == photons.powers.shape == photons.directions.shape == photons.normals.shape == (n, 3)
    )
    assert photons.is_caustic.sum() == len(photons.caustic)
    assert photons.edges.shape == (n,) and photons.edges.min() >= 2
    assert np.linalg.norm(photons.directions, axis=1) == pytest.approx(1, abs=1e-4)
    assert np.abs(photons.positions).max() < 1.01
    assert photons.statistics["photons"] == len(photons.stored)


def test_save_and_load(photons: eclat.Photons, scene: eclat.Scene, tmp_path: Path) -> None:
    file = tmp_path / "photons.npz"
    photons.save(file)
    loaded = eclat.Photons.load(file, scene)
    assert np.array_equal(loaded.stored, photons.stored) and np.array_equal(loaded.caustic, photons.caustic)
    assert (loaded.options, loaded.emissions, loaded.max_depth) == (photons.options, photons.emissions, -1)
    first, second = (eclat.render(scene, p, samples=1, size=(16, 16)).pixels for p in (photons, loaded))
    assert np.array_equal(first, second)
    with pytest.raises(eclat.EclatError, match="this photon map was solved for another scene"):
        eclat.Photons.load(file, build("furnace"))
    with pytest.raises(eclat.EclatError, match="max_depth: expected -1, with which this photon map was solved, got 4"):
        eclat.render(scene, loaded, samples=1, size=(16, 16), max_depth=4)


def test_damaged_files(photons: eclat.Photons, tmp_path: Path) -> None:
    file = tmp_path / "photons.npz"
    with pytest.raises(eclat.EclatError, match="file not found"):
        eclat.Photons.load(file)
    photons.save(file)
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(eclat.EclatError, match="the file was not saved by Éclat, or it is damaged"):
        eclat.Photons.load(file)
    eclat.solve(build("furnace"), points=([[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])).save(file)
    with pytest.raises(eclat.EclatError, match="expected a photon map, got a cache"):
        eclat.Photons.load(file)


def test_merge_refuses_what_does_not_belong_together(photons: eclat.Photons, scene: eclat.Scene) -> None:
    with pytest.raises(
        eclat.EclatError, match="expected photon maps of different seeds, got two that hold the photons of seed 0"
    ):
        eclat.merge(photons, photons)
    with pytest.raises(eclat.EclatError, match="expected two solutions of the same scene"):
        eclat.merge(photons, eclat.solve(build("furnace"), OPTIONS, seed=1))
    with pytest.raises(eclat.EclatError, match="expected two solutions with the same options"):
        eclat.merge(photons, eclat.solve(scene, eclat.PhotonMap(photons=1000, caustic_photons=1000), seed=1))
    records = eclat.solve(build("furnace"), points=([[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
    with pytest.raises(
        eclat.EclatError, match="merge: expected two solutions of one kind, got a photon map and a cache"
    ):
        eclat.merge(photons, records)


def test_photons_are_for_the_whole_scene(scene: eclat.Scene) -> None:
    with pytest.raises(eclat.EclatError, match="photon-map is solved for the whole scene"):
        eclat.solve(scene, OPTIONS, size=(16, 16))


def test_no_photons_are_traced_if_none_can_be_stored(scene: eclat.Scene) -> None:
    assert len(eclat.solve(scene, OPTIONS, max_depth=2)) == 0
    assert len(eclat.solve(build("cornell-box"), OPTIONS).caustic) == 0  # all surfaces are diffuse
