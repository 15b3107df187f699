# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures with groups of lamps: their sum is the picture, for every method, and each is the light of its lamps alone."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.cli import main
from eclat.images import denoiser
from eclat.images.mixing import groups_of
from support.quick_methods import QUICK
from support.statistics import block_means
from support.two_lamps import lamps_of_all_kinds

SIZE = (32, 32)
BLOCK = 8


@functools.cache
def scene() -> eclat.Scene:
    return lamps_of_all_kinds()


def sum_of_groups(image: eclat.Image) -> np.ndarray:
    return np.sum([np.asarray(light, np.float64) for light in groups_of(image).values()], axis=0)


def relative(image: np.ndarray, truth: np.ndarray) -> float:
    ours, theirs = block_means(image, BLOCK), block_means(truth, BLOCK)
    return float(np.sqrt(np.mean((ours - theirs) ** 2 / (theirs**2 + (0.1 * theirs.mean()) ** 2))))


@functools.cache
def truth(method: str, group: str | None) -> np.ndarray:
    lit = scene() if group is None else eclat.light_groups(scene())[group]
    how = eclat.Direct() if method == "direct" else eclat.Path()
    return eclat.render(lit, how, samples=256, size=SIZE, seed=7, denoise=False).pixels


@pytest.mark.parametrize("method", QUICK)
def test_the_sum_of_the_groups_is_the_picture(method: str) -> None:
    image = eclat.render(scene(), QUICK[method], samples=32, size=SIZE, light_groups=True, check=False)
    assert list(groups_of(image)) == ["light", "globe", "bulb", "sky"]
    np.testing.assert_allclose(sum_of_groups(image), image.pixels, rtol=1e-6)
    np.testing.assert_allclose(image.layers["direct"] + image.layers["indirect"], image.pixels, rtol=1e-5, atol=1e-6)
    # The picture is that of the scene without groups, and each group that of its lamps.
    assert relative(image.pixels, truth(method, None)) < 0.04
    for name, light in groups_of(image).items():
        assert relative(light, truth(method, name)) < 0.08, name
    # The groups have different seeds, so that their errors are independent.
    assert len({float(np.mean(light)) for light in groups_of(image).values()}) == 4


@pytest.mark.skipif(not denoiser.has_denoiser(), reason="pyoidn is not installed")
def test_denoised_pictures_are_sums_of_denoised_groups() -> None:
    image = eclat.render(
        scene(), "path", samples=8, size=SIZE, light_groups={"lamps": ["l*", "g*", "b*"]}, denoise=True
    )
    assert list(groups_of(image)) == ["lamps", "others"]
    np.testing.assert_allclose(sum_of_groups(image), image.pixels, rtol=1e-6)
    assert image.metadata["denoised"] and not np.array_equal(image.layers["noisy"], image.pixels)
    statistics, groups = image.metadata["statistics"], image.metadata["light_groups"]
    assert statistics["samples"] == sum(group["samples"] for group in groups.values())
    errors = [group["estimated_error"] for group in groups.values()]
    assert 0 < statistics["estimated_error"] <= sum(errors)
    # A finished picture is denoised in the same way.
    noisy = eclat.render(scene(), "path", samples=8, size=SIZE, light_groups=True, denoise=False)
    clean = eclat.denoise(noisy)
    np.testing.assert_allclose(sum_of_groups(clean), clean.pixels, rtol=1e-6)
    assert relative(clean.pixels, truth("path", None)) < 0.15
    with pytest.raises(eclat.EclatError, match="expected one picture with groups of lamps, or two without"):
        eclat.denoise(noisy, image)


def test_the_same_bits_for_any_number_of_threads() -> None:
    one, two = (
        eclat.render(scene(), "path", samples=2, size=(16, 16), light_groups=True, threads=threads).pixels
        for threads in (1, 2)
    )
    np.testing.assert_array_equal(one, two)


def test_time_previews_cover_all_groups() -> None:
    shown: list[eclat.Image] = []
    image = eclat.render(
        scene(), "path", time=1.0, size=SIZE, light_groups=True, preview=shown.append,
    )  # fmt: skip
    assert all(group["samples"] >= 1 for group in image.metadata["light_groups"].values())
    assert shown
    assert shown[-1].pixels.shape == image.pixels.shape


def test_what_cannot_have_groups_is_refused(tmp_path: Path) -> None:
    solved = eclat.solve(scene(), eclat.Radiosity(patches=100))
    with pytest.raises(eclat.EclatError, match="light_groups: expected a method, got a solution"):
        eclat.render(scene(), solved, light_groups=True)
    for name in ("continuable", "keep_partial"):
        with pytest.raises(eclat.EclatError, match=f"expected light_groups or {name}, got both"):
            eclat.render(scene(), "path", light_groups=True, **{name: True})  # type: ignore[arg-type]


def test_the_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    exr, again, mixed = (str(tmp_path / name) for name in ("a.exr", "again.exr", "mixed.exr"))
    small = ["--size", "16x12", "--method", "path", "--samples", "2", "--quiet"]
    assert main(["render", "atrium", *small, "--light-groups", "each", "-o", exr]) == 0
    assert main(["render", "atrium", "--replay-settings", exr, "-o", again, "--quiet"]) == 0
    before = eclat.Image.load(exr)
    np.testing.assert_array_equal(before.pixels, eclat.Image.load(again).pixels)
    capsys.readouterr()
    assert main(["mix", exr]) == 0
    assert capsys.readouterr().out.split() == ["sky", "sun"]
    assert main(["mix", exr, "sun=0.5", "sky=0", "-o", mixed]) == 0
    np.testing.assert_allclose(eclat.Image.load(mixed).pixels, before.layers["light.sun"] / 2, rtol=1e-6)
    for arguments in (["sun"], ["sun=1", "sun=2"], ["moon=1"], ["sun=red"]):
        assert main(["mix", exr, *arguments]) == 2
    assert main(["render", "atrium", *small, "--light-groups", "each", "--light-groups", "a=sun"]) == 2
    assert main(["render", "atrium", *small, "--light-groups", "each", "--continuable", "-o", exr]) == 2
    assert "--light-groups cannot be combined with --continuable" in capsys.readouterr().err
