# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What render promises beside radiance: layers, metadata, partial pictures, messages."""

from __future__ import annotations

import importlib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.errors import EclatWarning
from eclat.images.image import RECORD_MARK
from eclat.scenes import build
from eclat.verbs.picture import warn_of_error

SIZE = (48, 48)

# The attribute of the package is the function of that name.
rendering = importlib.import_module("eclat.verbs.render")


@pytest.fixture(scope="module")
def cornell() -> eclat.Scene:
    return build("cornell-box")


@pytest.fixture(scope="module")
def solution(cornell: eclat.Scene) -> eclat.Solution:
    return eclat.solve(cornell, eclat.IrradianceCache(max_error=0.05), size=SIZE)


def test_layers_say_what_they_hold(cornell: eclat.Scene, solution: eclat.Solution) -> None:
    image = eclat.render(cornell, solution, samples=4, size=SIZE)
    assert list(image.layers) == ["direct", "indirect", "albedo", "normal", "depth", "record_density"]
    np.testing.assert_allclose(image.layers["direct"] + image.layers["indirect"], image.pixels, atol=1e-5)
    assert "record_density" not in eclat.render(cornell, eclat.Path(), samples=1, size=SIZE).layers
    assert image.metadata["version"] == eclat.__version__


def test_each_record_that_is_seen_is_counted_once(cornell: eclat.Scene, solution: eclat.Solution) -> None:
    """Candidates come from the camera, so that almost all records are in view; the rest are at silhouettes, where a
    pixel's mean depth lies in front of them."""
    image = eclat.render(cornell, solution, samples=4, size=SIZE)
    density = image.layers["record_density"]
    assert 0.9 * len(solution) < density.sum() <= len(solution)
    crop = eclat.render(cornell, solution, samples=4, size=SIZE, crop=(8, 8, 24, 40)).layers["record_density"]
    assert np.array_equal(crop[8:40, 8:24], density[8:40, 8:24]) and crop.sum() == density[8:40, 8:24].sum()


def test_records_are_shown_where_they_are(cornell: eclat.Scene, solution: eclat.Solution) -> None:
    image = eclat.render(cornell, solution, samples=1, size=SIZE)
    shown = image.show_records(exposure=1.0)
    marked = (shown.pixels == np.float32(0.5) * np.array(RECORD_MARK, np.float32)).all(axis=2)
    assert np.array_equal(marked, image.layers["record_density"] > 0) and marked.any()
    assert np.array_equal(shown.pixels[~marked], image.pixels[~marked])


def interrupt_at(fraction: float) -> Any:
    """A progress report that is Ctrl-C once the rendering is that far."""

    def report(phase: str, done: float, statistics: dict[str, float]) -> None:
        if phase == "render" and done >= fraction:
            raise KeyboardInterrupt

    return report


def test_a_partial_picture_is_that_of_fewer_samples(cornell: eclat.Scene) -> None:
    with pytest.raises(KeyboardInterrupt) as stop:
        eclat.render(cornell, eclat.Path(), samples=10**6, size=SIZE, keep_partial=True, progress=interrupt_at(5e-6))
    partial = stop.value.partial  # type: ignore[attr-defined]
    done = partial.metadata["samples_done"]
    assert 0 < done < 10**6 and partial.metadata["statistics"]["samples"] == done
    whole = eclat.render(cornell, eclat.Path(), samples=done, size=SIZE)
    assert np.array_equal(partial.pixels, whole.pixels)
    assert all(np.array_equal(partial.layers[name], layer) for name, layer in whole.layers.items())


def test_without_keep_partial_nothing_is_kept(cornell: eclat.Scene) -> None:
    with pytest.raises(KeyboardInterrupt) as stop:
        eclat.render(cornell, eclat.Path(), samples=10**6, size=SIZE, progress=interrupt_at(0.0))
    assert not hasattr(stop.value, "partial")


def test_keeping_partial_pictures_changes_no_bits(cornell: eclat.Scene) -> None:
    plain, kept = (eclat.render(cornell, eclat.Path(), samples=8, size=SIZE, keep_partial=k) for k in (False, True))
    assert np.array_equal(plain.pixels, kept.pixels)
    assert "samples_done" not in kept.metadata


def test_samples_that_are_not_finite_are_counted_and_told_with_their_replay(
    cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Film(rendering._core.Film):
        bad_count = 3
        bad_samples = ((4, 7, 19), (5, 7, 19))

    monkeypatch.setattr(rendering._core, "Film", Film)
    with pytest.warns(eclat.EclatWarning) as warnings:
        image = eclat.render(cornell, eclat.Path(), samples=20, size=(8, 8), seed=7)
    assert str(warnings[0].message) == (
        "3 of 1,280 samples were not finite and are left out; the first is sample 19 of pixel (4, 7)\n"
        "         to repeat it, call eclat.render(…) with the same arguments and samples=20, "
        "crop=(4, 7, 5, 8), size=(8, 8)"
    )
    assert image.metadata["bad_samples"] == {"count": 3, "first": [4, 7, 19]}


def test_a_replay_repeats_the_sample_that_was_not_finite(cornell: eclat.Scene) -> None:
    """A light so near to the ceiling that it is brighter there than a float can say."""
    blinding = eclat.scene.PointLight((0.6, 0.999, 0.5), (1e37, 1e37, 1e37))
    scene = replace(cornell, lights=(blinding,))
    with pytest.warns(eclat.EclatWarning, match="samples were not finite"):
        whole = eclat.render(scene, eclat.Path(), samples=4, size=(16, 16))
    assert np.isfinite(whole.pixels).all()
    x, y, sample = whole.metadata["bad_samples"]["first"]
    with pytest.warns(eclat.EclatWarning, match="1 of"):
        again = eclat.render(scene, eclat.Path(), samples=sample + 1, crop=(x, y, x + 1, y + 1), size=(16, 16))
    assert again.metadata["bad_samples"] == {"count": 1, "first": [x, y, sample]}


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"samples": 1, "time": 1.0}, "expected samples or time, got both"),
        ({"samples": 0}, "samples must be between 1 and 16777216, got 0"),
        ({"time": 0.0}, "time must be a finite number of seconds above 0, got 0.0"),
        ({"time": float("nan")}, "time must be a finite number"),
        ({"max_depth": 0}, r"max_depth must be -1 \(unlimited\) or at least 1, got 0"),
        ({"filter": "tentt"}, r"filter must be one of box, tent, got 'tentt'; did you mean 'tent'\?"),
        ({"size": (70000, 1)}, "expected a width and a height between 1 and 65,536 pixels, got 70000x1"),
        ({"crop": (0, 0, 49, 1)}, r"inside the picture of 48x48 pixels, got"),
        ({"camera": 3}, "below 1, the number of cameras of cornell-box, got 3"),
        ({"seed": -1}, "seed must be between 0 and"),
        ({"tile_order": [0, 1, 2]}, r"tile_order: expected a permutation of the 4 indices 0 to 3, got \[0, 1, 2\]"),
        ({"tile_order": [0, 0, 1, 2]}, "tile_order: expected a permutation"),
        ({"tile_order": [-1, 0, 1, 2]}, "tile_order: expected a permutation"),
        ({"threads": 0}, "threads must be between 1 and 1024, got 0"),
    ],
)
def test_bad_arguments(cornell: eclat.Scene, keywords: dict[str, Any], message: str) -> None:
    with pytest.raises(eclat.EclatError, match=message):
        eclat.render(cornell, eclat.Path(), **{"size": SIZE, **keywords})


def test_the_samples_that_a_time_limit_chose_are_stated(cornell: eclat.Scene) -> None:
    timed = eclat.render(cornell, eclat.Path(), time=0.2, size=SIZE)
    made = {"denoise": timed.metadata["denoised"], "halves": timed.metadata["halves"]}
    samples = int(timed.metadata["statistics"]["samples"])
    again = eclat.render(cornell, eclat.Path(), samples=samples, size=SIZE, **made)
    assert np.array_equal(timed.pixels, again.pixels)


def test_an_error_above_the_wanted_one_is_a_warning(recwarn: pytest.WarningsRecorder) -> None:
    """A room with a pane and a curtain stopped after 8 samples for an error of 3 %, and only its statistics said 6.9 %."""

    def found(error: float) -> dict[str, float]:
        return {"estimated_error": error, "estimated_error_low": 0.8 * error, "estimated_error_high": 1.2 * error}

    warn_of_error(found(0.033), 0.03)
    warn_of_error({}, 0.03)
    assert not recwarn
    with pytest.warns(EclatWarning, match=r"estimated error 6\.9 %.* above the wanted 3 %"):
        warn_of_error(found(0.069), 0.03)
