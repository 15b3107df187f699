# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Denoised pictures: the error that they state is the true one, it says when to stop, and the metadata make them again."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.images import denoiser
from eclat.measure.metrics import relative_rmse
from eclat.sampling import convergence
from eclat.scene import Material, PointLight, grey
from eclat.scenes import build

pytestmark = pytest.mark.skipif(not denoiser.has_denoiser(), reason="pyoidn is not installed")

SIZE = (96, 96)


@pytest.fixture(scope="module")
def cornell() -> eclat.Scene:
    return build("cornell-box")


@pytest.fixture(scope="module")
def truth(cornell: eclat.Scene) -> tuple[np.ndarray, np.ndarray]:
    a, b = (eclat.render(cornell, eclat.Path(), samples=512, seed=seed, size=SIZE).pixels for seed in (71, 72))
    return a, b


def denoised(scene: eclat.Scene, **keywords: Any) -> eclat.Image:
    return eclat.render(scene, **{"what": eclat.Path(), "size": SIZE, "denoise": True, **keywords})


def test_the_error_that_is_stated_is_the_true_one(cornell: eclat.Scene, truth: tuple[np.ndarray, np.ndarray]) -> None:
    stated, true = [], []
    for seed in range(4):
        image = denoised(cornell, samples=8, seed=seed)
        statistics = image.metadata["statistics"]
        stated.append(statistics["estimated_error"] ** 2)
        true.append(relative_rmse(image.pixels, *truth) ** 2)
        assert true[-1] ** 0.5 < 0.5 * relative_rmse(image.layers["noisy"], *truth)
        assert statistics["noise"] > 2 * statistics["estimated_error"]
    assert np.mean(stated) / np.mean(true) == pytest.approx(1, abs=0.4)


def test_the_denoised_error_says_when_to_stop(cornell: eclat.Scene) -> None:
    plain = denoised(cornell, max_error=0.05, denoise=False).metadata["statistics"]
    image = denoised(cornell, max_error=0.05)
    statistics = image.metadata["statistics"]
    assert image.metadata["denoised"] and statistics["estimated_error"] <= 0.05 < statistics["noise"]
    assert statistics["samples"] < plain["samples"] / 2


def test_samples_that_meet_the_error_themselves_are_not_denoised() -> None:
    image = denoised(build("furnace"), max_error=0.1, size=(32, 32))
    assert not image.metadata["denoised"] and "noisy" not in image.layers
    assert image.metadata["statistics"]["estimated_error"] <= 0.1
    made = {"samples": int(image.metadata["statistics"]["samples"]), "denoise": False, "halves": True}
    again = denoised(build("furnace"), size=(32, 32), **made)
    np.testing.assert_array_equal(again.pixels, image.pixels)


def test_samples_go_where_the_denoiser_leaves_errors(
    cornell: eclat.Scene, truth: tuple[np.ndarray, np.ndarray]
) -> None:
    """In the picture that the denoiser judged, they go less to what it cleans, and the error is smaller; measured 0.97."""
    errors, images = {}, {}
    for by in ("noise", "denoised"):
        images[by] = [denoised(cornell, samples=32, adaptive=by, seed=seed, continuable=True) for seed in range(4)]
        errors[by] = np.mean([relative_rmse(image.pixels, *truth) ** 2 for image in images[by]])
        assert all(image.metadata["adaptive"] == by and image.metadata["denoised"] for image in images[by])
    more, left = [], []
    for noise, judged in zip(images["noise"], images["denoised"], strict=True):
        more.append(judged.layers["sample_counts"] / noise.layers["sample_counts"])
        left.append(noise.layers["error"] / denoised(cornell, samples=32, denoise=False, halves=True).layers["error"])
    assert np.corrcoef(np.mean(more, axis=0).ravel(), np.mean(left, axis=0).ravel())[0, 1] > 0.5
    assert errors["denoised"] < errors["noise"]


@pytest.mark.parametrize(
    ("given", "chosen"),
    [
        ({"adaptive": True}, "denoised"),
        ({"adaptive": True, "denoise": False}, "noise"),
        ({"adaptive": True, "samples": None, "time": 0.1}, "noise"),
        ({"adaptive": "noise"}, "noise"),
        ({"adaptive": "denoised", "denoise": False, "halves": True}, "denoised"),
        ({}, False),
        ({"what": eclat.IrradianceCache(max_error=0.3)}, "denoised"),
        ({"what": eclat.IrradianceCache(max_error=0.3), "crop": (0, 0, 8, 8)}, False),
    ],
)
def test_what_decides_where_samples_go(cornell: eclat.Scene, given: dict[str, Any], chosen: Any) -> None:
    image = denoised(cornell, **{"samples": 2, "size": (16, 16), "check": False, **given})
    assert image.metadata["adaptive"] == chosen


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"adaptive": "denoise"}, "adaptive: expected True, False, 'noise' or 'denoised', got 'denoise'; did you mean"),
        ({"adaptive": "denoised", "denoise": False}, "adaptive: expected denoising or halves=True with 'denoised'"),
    ],
)
def test_what_cannot_decide_is_refused(cornell: eclat.Scene, given: dict[str, Any], message: str) -> None:
    with pytest.raises(eclat.EclatError, match=message):
        denoised(cornell, samples=2, **given)


def test_a_picture_that_the_denoiser_judged_can_be_continued_without_it(cornell: eclat.Scene, tmp_path: Path) -> None:
    given = {"size": (48, 48), "seed": 4, "continuable": True, "adaptive": "denoised"}
    denoised(cornell, samples=8, **given).save(tmp_path / "eight.exr")
    longer = denoised(cornell, continued=tmp_path / "eight.exr", size=None, samples=32, denoise=False)
    once = denoised(cornell, samples=32, denoise=False, halves=True, **given)
    by_noise = denoised(cornell, samples=32, denoise=False, halves=True, **{**given, "adaptive": "noise"})
    np.testing.assert_array_equal(longer.pixels, once.pixels)
    assert (once.pixels != by_noise.pixels).any()


@pytest.mark.parametrize("what", [eclat.Path(), eclat.IrradianceCache(max_error=0.1), eclat.Direct()])
def test_same_bits_for_any_number_of_threads_and_from_the_metadata(cornell: eclat.Scene, what: Any) -> None:
    first = denoised(cornell, what=what, max_error=0.1, threads=2)
    made = {name: first.metadata[name] for name in ("seed", "halves", "adaptive")}
    statistics = first.metadata["statistics"]
    made |= {name: int(statistics[name]) for name in ("samples", "gathered_samples") if name in statistics}
    again = denoised(cornell, what=what, denoise=first.metadata["denoised"], threads=1, **made)
    np.testing.assert_array_equal(again.pixels, first.pixels)
    for name, layer in first.layers.items():
        np.testing.assert_array_equal(again.layers[name], layer)
    for name in ("noise_left", "estimated_error", "estimated_error_high"):
        assert again.metadata["statistics"][name] == first.metadata["statistics"][name]


def test_the_denoiser_gives_the_same_bits_on_one_processor_and_on_all() -> None:
    script = (
        "import numpy as np, hashlib\n"
        "from eclat.images.denoiser import denoise\n"
        "noisy = np.random.default_rng(1).exponential(size=(90, 130, 3)).astype(np.float32)\n"
        "print(hashlib.sha256(denoise(noisy, np.minimum(noisy, 1), noisy - 1).tobytes()).hexdigest())\n"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", script], env={**os.environ, **threads}, capture_output=True, text=True, check=True
        ).stdout
        for threads in ({}, {"OIDN_NUM_THREADS": "1"})
    }
    assert len(found) == 1


def test_the_error_of_records_is_joined(cornell: eclat.Scene) -> None:
    image = denoised(cornell, what=eclat.IrradianceCache(max_error=0.2, final_gather=False), max_error=0.2, samples=4)
    statistics = image.metadata["statistics"]
    assert statistics["cache_error"] > 0 and statistics["noise_left"] > 0
    joined = np.hypot(statistics["cache_error"], statistics["noise_left"])
    assert 0.7 * joined <= statistics["estimated_error"] <= 1.4 * joined
    # The probes of the picture judge records that were solved before, too, unless that is not wanted.
    solution = eclat.solve(cornell, eclat.IrradianceCache(max_error=0.2), size=SIZE)
    given = denoised(cornell, what=solution, samples=4).metadata["statistics"]
    assert given["estimated_error"] > 0 and given["noise_left"] > 0
    unchecked = denoised(cornell, what=solution, samples=4, check=False).metadata["statistics"]
    assert "estimated_error" not in unchecked and unchecked["noise_left"] > 0


def test_the_stated_error_includes_the_error_of_records(
    cornell: eclat.Scene, truth: tuple[np.ndarray, np.ndarray]
) -> None:
    # Records of light that is half as bright again: the halves cannot see it, and nothing was estimated when they were solved.
    solution = eclat.solve(cornell, eclat.IrradianceCache(max_error=0.1), size=SIZE, check=False)
    wrong = replace(solution, near=solution.near.copy())
    wrong.irradiance[:] *= 1.5
    image = denoised(cornell, what=wrong, samples=8)
    statistics, true = image.metadata["statistics"], relative_rmse(image.pixels, *truth)
    assert statistics["noise_left"] < 0.5 * true
    assert statistics["estimated_error_low"] < true < statistics["estimated_error_high"]


def test_guides_are_those_of_the_surface_behind_mirrors(cornell: eclat.Scene) -> None:
    # The green wall becomes a mirror, in which the rest of the box is seen.
    smooth = {"alpha_u": grey(0), "eta": grey(0), "k": grey(1)}
    mirror = Material("conductor", smooth)
    meshes = tuple(replace(mesh, material=mirror) if mesh.name == "green-wall" else mesh for mesh in cornell.meshes)
    layers = denoised(replace(cornell, meshes=meshes), samples=4).layers
    wall = (layers["albedo"] > 0.99).all(axis=2)
    assert wall.sum() > 200
    assert np.abs(layers["normal"][wall][:, 0]).min() > 0.99
    # It shows back wall, floor, ceiling and boxes, all of them white, and never itself.
    assert (layers["rough_normal"][wall][:, 0] > -0.5).mean() > 0.9
    white = np.array((0.885809, 0.698859, 0.666422))
    assert (np.abs(layers["rough_albedo"][wall] - white).max(axis=1) < 1e-4).mean() > 0.9
    # Without mirrors both are the same.
    plain = denoised(cornell, samples=4).layers
    np.testing.assert_array_equal(plain["rough_normal"], plain["normal"])


def test_layers_of_a_denoised_picture(cornell: eclat.Scene) -> None:
    image = denoised(cornell, samples=4)
    error = image.layers["error"]
    assert error.shape == SIZE[::-1] and (error >= 0).all()
    stated = image.metadata["statistics"]["noise_left"]
    assert np.sqrt((error**2).mean()) == pytest.approx(stated, rel=0.5)
    weight = image.layers["denoiser_weight"]
    assert weight.min() >= 0 and weight.max() <= 1 and weight.max() > 0.5
    noisy = image.layers["noisy"]
    np.testing.assert_allclose(image.layers["direct"] + image.layers["indirect"], noisy, atol=1e-5)


def test_interrupted_pictures_are_denoised_as_well(cornell: eclat.Scene) -> None:
    def report(phase: str, done: float, statistics: dict[str, float]) -> None:
        if statistics.get("samples", 0) >= 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stop:
        denoised(cornell, samples=10**6, keep_partial=True, progress=report)
    partial = stop.value.partial  # type: ignore[attr-defined]
    done = partial.metadata["samples_done"]
    assert done % 2 == 0 and partial.metadata["denoised"]
    np.testing.assert_array_equal(partial.pixels, denoised(cornell, samples=done).pixels)


def test_few_samples_and_black_pictures(cornell: eclat.Scene) -> None:
    one = denoised(cornell, samples=1)
    assert one.metadata["statistics"]["samples"] == 2 and np.isfinite(one.pixels).all()
    dark = replace(cornell, meshes=cornell.meshes[1:], lights=(PointLight((0.5, 5.0, 0.5), (1e-30,) * 3),))
    black = denoised(dark, samples=2, size=(33, 17))
    assert not (black.pixels > 1e-6).any() and black.metadata["statistics"]["estimated_error"] >= 0
    tiny = denoised(cornell, samples=2, size=(1, 1))
    assert np.isfinite(tiny.pixels).all()


def test_a_crop_is_denoised_alone(cornell: eclat.Scene) -> None:
    image = denoised(cornell, samples=4, crop=(10, 20, 60, 50))
    assert image.metadata["denoised"] and not image.pixels[:20].any() and image.pixels[20:50, 10:60].all(axis=2).any()
    # Without being asked for, neither a crop nor a number of samples is denoised.
    for keywords in ({"crop": (10, 20, 60, 50), "max_error": 0.3}, {"samples": 2}):
        assert not denoised(cornell, denoise=None, **keywords).metadata["halves"]


def test_giving_up_causes_a_warning(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(convergence, "MOST_SAMPLES", 8)
    with pytest.warns(
        eclat.EclatWarning, match=r"the relative noise after denoising is still \d+\.\d+, above the wanted 0\.001"
    ):
        image = denoised(cornell, max_error=0.001)
    assert image.metadata["statistics"]["samples"] == 8


def test_without_a_denoiser(cornell: eclat.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(denoiser, "PACKAGE", "no_such_denoiser")
    with pytest.raises(eclat.EclatError, match="extra `denoise`"):
        denoised(cornell, samples=2)
    image = denoised(cornell, denoise=None, max_error=0.5)
    assert not image.metadata["halves"] and not image.metadata["denoised"]


def test_halves_are_needed(cornell: eclat.Scene) -> None:
    with pytest.raises(eclat.EclatError, match="expected halves=True with denoise"):
        denoised(cornell, samples=2, halves=False)
