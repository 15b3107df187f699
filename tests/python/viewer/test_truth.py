# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of what a page sees: by paths, and by the records so far as `eclat render` makes them."""

from __future__ import annotations

import threading

import numpy as np
import pytest

import eclat
from eclat import _core, scenes
from eclat.measure.metrics import relative_rmse
from eclat.viewer import truth as truth_module
from eclat.viewer.live import Live
from eclat.viewer.truth import TruthPicture, TruthSoFar

SIZE = (32, 24)


def camera() -> _core.Camera:
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    return _core.Camera(
        axes=axes, position=(0.0, 0.0, 2.5), size=SIZE, half_extent=(0.4, 0.3), shift=(0.0, 0.0), lens=(0.0, 1.0),
        orthographic=False,
    )  # fmt: skip


def finished(picture: TruthPicture, samples: int, better: threading.Semaphore) -> TruthSoFar:
    while (latest := picture.latest) is None or latest.samples < samples:
        assert better.acquire(timeout=60), picture.failure
    return latest


def test_by_records_is_what_render_shows_and_by_paths_is_the_light() -> None:
    scene = scenes.build("cornell-box")
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.1), size=(64, 48), check=False)
    live = Live(scene, solution, threads=1)
    try:
        found = {}
        for way in ("paths", "records"):
            better = threading.Semaphore(0)
            picture = TruthPicture(camera(), SIZE, live.truth_by(way), better.release, threads=1)
            found[way] = finished(picture, 512, better)
            picture.stop()
    finally:
        live.close()
    paths, records = (np.mean(found[way].halves, axis=0) for way in ("paths", "records"))
    # Records are read where paths would scatter on: much less noise, and the same light.
    noise = {way: float(np.std(np.subtract(*so_far.halves))) for way, so_far in found.items()}
    assert noise["records"] < 0.7 * noise["paths"]
    assert records.mean() == pytest.approx(paths.mean(), rel=0.03)
    assert relative_rmse(records, *found["paths"].halves) < 0.1


def test_a_picture_ends_after_its_last_sample_and_when_it_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = scenes.build("cornell-box")
    monkeypatch.setattr(truth_module, "MOST_SAMPLES", 8)
    better = threading.Semaphore(0)
    picture = TruthPicture(
        camera(), SIZE, lambda: truth_module.by_paths(scene, max_depth=2, roulette_depth=4), better.release, threads=1
    )
    assert finished(picture, 8, better).samples == 8
    picture.stop()
    assert picture.latest is not None and picture.latest.samples == 8 and picture.failure is None


def test_what_fails_is_kept() -> None:
    def fails() -> _core.Estimator:
        raise MemoryError

    picture = TruthPicture(camera(), SIZE, fails, lambda: None)
    picture.stop()
    assert isinstance(picture.failure, MemoryError) and picture.latest is None
