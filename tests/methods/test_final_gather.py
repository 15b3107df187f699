# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Paths that read records only after a matte surface: against path tracing, and against a closed form with wrong records."""

from __future__ import annotations

import sys
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import eclat
from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.measure.error_estimate import ErrorEstimate
from eclat.measure.metrics import relative_rmse
from eclat.methods.method import Prepared
from eclat.methods.records.solution import FinalGather, Solution
from eclat.scenes import build
from support.courtyard import court
from support.statistics import block_means, welch

SIZE = (32, 32)


def solved(scene: eclat.Scene, method: eclat.Method) -> Solution:
    found = eclat.solve(scene, method, size=SIZE, check=False)
    assert isinstance(found, Solution)
    return found


def picture(scene: eclat.Scene, prepared: Prepared, samples: int, seed: int) -> NDArray[np.float32]:
    return eclat.render(scene, prepared, samples=samples, size=SIZE, seed=seed, adaptive=False, check=False).pixels


@pytest.mark.parametrize("light", ["sky", "sun"])
def test_a_final_gather_agrees_with_paths(light: str) -> None:
    """The sky is left to the records where they are read, and must be sampled, once, where they are not."""
    scene = court(light)
    gather = solved(scene, eclat.IrradianceCache(max_error=0.02)).final_gather()
    ours = np.stack([block_means(picture(scene, gather, 16, k), 8).ravel() for k in range(8)])
    paths = np.stack([block_means(picture(scene, eclat.Path(), 16, 100 + k), 8).ravel() for k in range(8)])
    # What is left of the records' error is below a per cent of a block.
    t, limit = welch(ours, paths)
    assert t < limit or np.abs(ours.mean(0) - paths.mean(0)).max() < 0.01 * paths.mean()
    assert abs(ours.mean() / paths.mean() - 1) < 0.005


def test_a_guided_path_depends_on_no_other() -> None:
    scene, gather = court("sun"), solved(court("sun"), eclat.IrradianceCache(max_error=0.1)).final_gather()
    whole = picture(scene, gather, 4, 1)
    part = eclat.render(
        scene, gather, samples=4, size=SIZE, seed=1, adaptive=False, check=False, crop=(5, 9, 23, 30), threads=1
    )
    np.testing.assert_array_equal(part.pixels[9:30, 5:23], whole[9:30, 5:23])
    assert whole[9:30, 5:23].any()


def test_a_guide_of_very_many_records_learns_at_some_of_them() -> None:
    scene = court("sun")
    few = solved(scene, eclat.IrradianceCache(max_error=0.1))
    column = {name: slice(first, first + count) for name, first, count in _core.record_layout()}

    def places(copies: int) -> int:
        near = np.tile(few.near, (copies, 1))
        for radii in ("radii", "least_radii", "largest_radii"):
            near[:, column[radii]] *= 1e-3  # Small records are found fast.
        near[:, column["positions"]] += np.random.default_rng(1).normal(0, 0.05, (len(near), 3)).astype(np.float32)
        caches = _core.SolvedCaches(near, few.far, _core.IrradianceCacheOptions())
        return len(_core.learn_path_guide(compiled(scene).core, caches, 1, 2, _core.Progress()))

    assert places(1) == len(few.near)
    assert 1 << 14 < places(1 + (1 << 16) // len(few.near)) <= 1 << 16


def test_wrong_records_reach_a_pixel_once_more_reflected() -> None:
    """In a furnace of emission L_e and reflectance ρ, the radiance is L = L_e / (1 − ρ). If records hold 1.5 times their
    irradiance π ρ L, a picture that reads them at first sight is too bright by ½ ρ² L, and a final gather by ½ ρ³ L.
    """
    rho = 0.5
    scene = eclat.load("furnace", rho=rho)
    right = solved(scene, eclat.IrradianceCache(max_error=0.05))
    wrong = replace(right, near=_brighter(right.near, 1.5), far=_brighter(right.far, 1.5))
    truth = picture(scene, eclat.Path(), 64, 1).mean()
    assert abs(picture(scene, right.final_gather(), 64, 2).mean() / truth - 1) < 0.003
    assert abs(picture(scene, wrong, 64, 3).mean() / truth - (1 + 0.5 * rho**2)) < 0.005
    # A few paths meet no record near enough, and go on to one more reflection.
    excess = picture(scene, wrong.final_gather(), 64, 4).mean() / truth - 1
    assert 0.8 * 0.5 * rho**3 < excess < 1.02 * 0.5 * rho**3


def test_short_rays_read_no_records() -> None:
    """Beside an edge of a box, where half of the rays are shorter than the radii of records, wrong ones brighten pixels less."""
    scene = eclat.load("furnace", rho=0.5, shape="box")
    right = solved(scene, eclat.IrradianceCache(max_error=0.05))
    wrong = replace(right, near=_brighter(right.near, 1.5), far=_brighter(right.far, 1.5))
    image = eclat.render(scene, wrong.final_gather(), samples=512, size=SIZE, seed=4, adaptive=False, check=False)
    excess, normal = image.pixels.mean(axis=-1) / 2 - 1, image.layers["normal"]
    beside = np.zeros(excess.shape, bool)
    for axis in (0, 1):
        edge = np.abs(normal - np.roll(normal, 1, axis)).sum(axis=-1) > 0.5
        beside |= edge | np.roll(edge, -1, axis)
    assert excess[beside].mean() < 0.94 * excess[~beside].mean()  # without: 0.99


def _brighter(records: NDArray[np.float32], factor: float) -> NDArray[np.float32]:
    """Scale the irradiance of records, with all that is in proportion to it."""
    probe = Solution(eclat.IrradianceCache(), "", records.copy(), records[:0], np.zeros(3))
    for values in (probe.irradiance, probe.excess):
        values *= factor
    return probe.near


def test_denoised_pictures_are_final_gathers_and_can_be_repeated() -> None:
    scene, wanted, size = build("atrium"), 0.06, (64, 36)
    image = eclat.render(scene, max_error=wanted, size=size, seed=3)
    options, statistics = image.metadata["options"], image.metadata["statistics"]
    assert options["final_gather"] and options["least_pixels"] == 1 and image.metadata["adaptive"] == "denoised"
    assert "cache_error" not in statistics and statistics["records"] > 0 and image.layers["record_density"].any()
    a, b = (eclat.render(scene, eclat.Path(), size=size, samples=256, seed=seed, adaptive=False) for seed in (8, 9))
    assert relative_rmse(image.pixels, a.pixels, b.pixels) < 1.2 * wanted
    again = eclat.render(
        scene, eclat.IrradianceCache(**options), samples=int(statistics["samples"]), adaptive=image.metadata["adaptive"],
        halves=True, denoise=image.metadata["denoised"], size=size, seed=3,
    )  # fmt: skip
    np.testing.assert_array_equal(again.pixels, image.pixels)


@pytest.mark.parametrize(
    ("size", "arguments", "gathers", "least_pixels"),
    [
        ((160, 8), {"denoise": True, "samples": 2}, True, 2),
        ((16, 16), {"denoise": True, "samples": 2, "max_error": 0.019}, False, None),
        ((16, 16), {"denoise": False, "samples": 1}, False, None),
        ((16, 16), {"denoise": True, "time": 0.5}, False, None),
    ],
)
def test_what_is_a_final_gather(
    size: tuple[int, int], arguments: dict[str, Any], gathers: bool, least_pixels: float
) -> None:
    """Noise that nothing removes, and errors that only records make small enough, are left to records read at sight."""
    options = eclat.render(build("cornell-box"), size=size, check=False, **arguments).metadata["options"]
    assert options["final_gather"] is gathers and (options["least_pixels"] == least_pixels or least_pixels is None)


def test_what_all_paths_may_have_in_common_makes_the_statement_less_certain(monkeypatch: pytest.MonkeyPatch) -> None:
    def stated(behind: ErrorEstimate | None) -> dict[str, float]:
        monkeypatch.setattr(FinalGather, "error_behind", property(lambda _: behind))
        method = eclat.IrradianceCache(max_error=0.1, final_gather=True)
        image = eclat.render(build("cornell-box"), method, samples=64, size=SIZE, denoise=True, check=False)
        return dict(image.metadata["statistics"])

    certain, doubtful = stated(None), stated(ErrorEstimate(1.0, 0.9, 1.1))
    assert doubtful["estimated_error_high"] > 1.2 * certain["estimated_error_high"]


@pytest.mark.parametrize("check", [True, False])
def test_it_ends_after_a_number_of_paths(check: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    rendering = sys.modules["eclat.verbs.render"]
    monkeypatch.setattr(rendering, "MOST_GATHERED", 24 * 24 * 16)
    monkeypatch.setattr(rendering, "LEAST_GATHERED", 8)
    method = eclat.IrradianceCache(max_error=0.1, final_gather=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", eclat.EclatWarning)
        image = eclat.render(
            build("cornell-box"), method, max_error=0.001, size=(24, 24), denoise=True, halves=True, check=check
        )
    assert image.metadata["statistics"]["samples"] == 16


def test_lobes_of_radiance_records_are_traced_too() -> None:
    scene = eclat.load("glossy-box", alpha=0.6)
    gather = solved(scene, eclat.RadianceCache(max_error=0.1)).final_gather()
    image = eclat.render(scene, gather, samples=64, size=SIZE, seed=5, adaptive=False, check=False)
    paths = picture(scene, eclat.Path(), 64, 6)
    assert abs(image.pixels.mean() / paths.mean() - 1) < 0.01
