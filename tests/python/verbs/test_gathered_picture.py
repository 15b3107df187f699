# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures whose records err more than is wanted: they get paths beside the records until they err as little as wanted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.measure.metrics import relative_rmse
from eclat.methods.records.solution import FinalGather
from eclat.scenes import build
from eclat.verbs.gathered_picture import ADDED
from eclat.verbs.picture import Picture

WANTED, LESS = 0.02, 0.012
COARSE = eclat.IrradianceCache(max_error=0.3, final_gather=False)
SIZE = (40, 40)


@pytest.fixture(scope="module")
def scene() -> eclat.Scene:
    return build("cornell-box")


def made(scene: eclat.Scene, max_error: float = WANTED, **keywords: Any) -> eclat.Image:
    return eclat.render(scene, COARSE, max_error=max_error, size=SIZE, halves=True, denoise=False, **keywords)


@pytest.fixture(scope="module")
def blend(scene: eclat.Scene) -> eclat.Image:
    return made(scene, continuable=True)


@pytest.fixture(scope="module")
def alone(scene: eclat.Scene, blend: eclat.Image) -> eclat.Image:
    """The picture of the records alone, with as many samples."""
    samples = int(blend.metadata["statistics"]["samples"])
    return eclat.render(scene, COARSE, samples=samples, size=SIZE, halves=True, denoise=False, check=False)


def test_the_error_that_is_wanted_is_reached(scene: eclat.Scene, blend: eclat.Image, alone: eclat.Image) -> None:
    truth = eclat.render(scene, eclat.Path(), samples=1024, size=SIZE, seed=9).pixels
    statistics = blend.metadata["statistics"]
    assert statistics[ADDED] > 0 and statistics["estimated_error"] < 1.2 * WANTED
    before, after = (relative_rmse(image.pixels, truth, truth) for image in (alone, blend))
    assert after < 1.2 * WANTED < before
    weight = blend.layers["record_weight"]
    assert weight.min() >= 0 and weight.max() <= 1 and weight.mean() < 0.9
    # The layers stay those of the records.
    np.testing.assert_array_equal(blend.layers["indirect"], alone.layers["indirect"])


def test_the_number_of_threads_does_not_matter(scene: eclat.Scene, blend: eclat.Image) -> None:
    np.testing.assert_array_equal(made(scene, threads=1).pixels, blend.pixels)


def test_the_numbers_of_samples_repeat_it(scene: eclat.Scene, blend: eclat.Image) -> None:
    statistics = blend.metadata["statistics"]
    counts = {"samples": int(statistics["samples"]), "gathered_samples": int(statistics[ADDED])}
    again = eclat.render(
        scene, COARSE, **counts, size=SIZE, halves=True, denoise=False, adaptive=blend.metadata["adaptive"], check=False
    )
    np.testing.assert_array_equal(again.pixels, blend.pixels)
    assert np.isfinite(again.metadata["statistics"]["noise_left"])
    with pytest.raises(eclat.EclatError, match="gathered_samples: expected samples and halves=True"):
        eclat.render(scene, COARSE, gathered_samples=4, size=SIZE)


def test_a_picture_that_errs_little_stays_as_it_is(scene: eclat.Scene) -> None:
    image = made(scene, max_error=0.5)
    assert ADDED not in image.metadata["statistics"] and "record_weight" not in image.layers


def test_a_blend_can_be_continued(scene: eclat.Scene, blend: eclat.Image, tmp_path: Path) -> None:
    blend.save(tmp_path / "begun.exr")
    longer = eclat.render(scene, COARSE, max_error=LESS, continued=tmp_path / "begun.exr", denoise=False)
    before, after = (image.metadata["statistics"] for image in (blend, longer))
    assert after[ADDED] >= 2 * before[ADDED] and after["estimated_error"] < before["estimated_error"]


@pytest.mark.parametrize(("owner", "name", "call"), [(Picture, "probed", 2), (FinalGather, "radiance_estimator", 1)])
def test_an_interrupted_blend_leaves_the_picture_of_the_records(
    scene: eclat.Scene, alone: eclat.Image, monkeypatch: pytest.MonkeyPatch, owner: type, name: str, call: int
) -> None:
    """In the middle of its samples, or while its guide is learnt."""
    whole, calls = getattr(owner, name), 0

    def stop_at_call(*arguments: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls == call:
            raise KeyboardInterrupt
        return whole(*arguments)

    monkeypatch.setattr(owner, name, stop_at_call)
    with pytest.raises(KeyboardInterrupt) as stopped:
        made(scene, keep_partial=True)
    partial = stopped.value.partial  # type: ignore[attr-defined]
    assert partial.metadata["samples_done"] > 0 and partial.metadata["unfinished"]
    np.testing.assert_array_equal(partial.pixels, alone.pixels)
