# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Parts of a picture become the whole one, and caches one cache, on the command line and in Python; mistakes are named."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.cli import main
from eclat.errors import EclatError
from eclat.images.image import Image

SIZE = (48, 40)
CROPS = [(0, 0, 48, 11), (0, 11, 20, 40), (20, 11, 48, 40)]


def part(crop: tuple[int, int, int, int] | None, **settings: Any) -> Image:
    given: dict[str, Any] = {"size": SIZE, "samples": 3, "crop": crop, "continuable": True, **settings}
    return eclat.render("cornell-box", "path", **given)


def test_parts_become_the_picture_that_is_rendered_at_once_and_go_on_like_it() -> None:
    parts = [part(crop) for crop in CROPS]
    merged, whole = eclat.merge_pictures(parts), part(None)
    assert np.array_equal(merged.pixels, whole.pixels)
    assert set(merged.layers) == set(whole.layers)
    for name, layer in whole.layers.items():
        assert np.array_equal(merged.layers[name], layer, equal_nan=True), name
    assert merged.metadata["statistics"]["samples"] == 3
    assert merged.metadata["statistics"]["rays"] >= whole.metadata["statistics"]["rays"]
    further = [eclat.render("cornell-box", "path", samples=5, continued=one).pixels for one in (merged, whole)]
    assert np.array_equal(*further)


def test_parts_that_do_not_fit_are_refused() -> None:
    one, two, three = (part(crop) for crop in CROPS)
    for wrong, words in (
        ([], "at least one picture"),
        ([one, two], r"812 pixels are in none, first \(20, 11\)"),
        ([one, two, three, two], r"do not overlap, but pixel \(0, 11\) is in two"),
        ([one, two, part(CROPS[2], seed=1)], "expected seed as in continued, 0, got 1"),
        ([one, two, part(CROPS[2], samples=4)], "expected samples as in continued, 3, got 4"),
        ([part(None, adaptive=True)], "without adaptive"),
        ([part(None, halves=True)], "without halves"),
        ([part(None, continuable=False)], "expected a picture that can be continued"),
    ):
        with pytest.raises(EclatError, match=words):
            eclat.merge_pictures(wrong)


def test_the_first_of_all_bad_samples_is_named() -> None:
    parts = [part(crop) for crop in CROPS]
    parts[0].metadata["bad_samples"] = {"count": 2, "first": [5, 5, 2]}
    parts[2].metadata["bad_samples"] = {"count": 1, "first": [30, 30, 1]}
    assert eclat.merge_pictures(parts).metadata["bad_samples"] == {"count": 3, "first": [30, 30, 1]}


def test_the_command_merges_pictures_and_caches(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for number, crop in enumerate(CROPS):
        part(crop).save(f"{number}.exr")
    assert main(["merge", "0.exr", "1.exr", "2.exr", "-o", "whole.exr"]) == 0
    assert "whole.exr: 48x40, from 3 parts" in capsys.readouterr().out
    assert np.array_equal(Image.load("whole.exr").pixels, part(None).pixels)
    method = eclat.IrradianceCache(max_error=0.3)
    for name, height in (("a", 0.4), ("b", 1.2)):
        eclat.solve("cornell-box", method, points=([[0.0, height, 0.0]], [[0.0, 1.0, 0.0]]), check=False).save(
            f"{name}.npz"
        )
    assert main(["merge", "a.npz", "b.npz"]) == 0
    assert len(eclat.load_solved("merged.npz")) == 2
    for wrong, words in (
        (["a.npz", "0.exr"], "expected .npz files or .exr files"),
        (["a.npz", "-o", "x.exr"], "x.exr: expected a name that ends in .npz"),
        (["0.exr", "1.exr"], "pixels are in none"),
    ):
        assert main(["merge", *wrong]) == 2
        assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("method", "count"),
    [("path", 3), ("irradiance-cache", 2), ("photon-map", 2), ("radiosity", 2), ("radiance-cache", 2)],
)
def test_shards_become_the_picture_that_is_rendered_at_once(method: str, count: int) -> None:
    common: dict[str, Any] = {"size": (48, 41), "samples": 3, "max_error": 0.3}
    shards = [eclat.render("cornell-box", method, shard=(i, count), **common) for i in range(count, 0, -1)]
    whole = eclat.render("cornell-box", method, adaptive=False, denoise=False, **common)
    merged = eclat.merge_pictures(shards)
    assert np.array_equal(merged.pixels, whole.pixels)
    for name, layer in whole.layers.items():
        assert np.array_equal(merged.layers[name], layer, equal_nan=True), name


def test_shards_that_cannot_be_are_refused() -> None:
    common: dict[str, Any] = {"size": (8, 8), "samples": 1, "shard": (1, 2)}
    for wrong, words in (
        ({"shard": (3, 2)}, "expected i/n with 1 ≤ i ≤ n, got 3/2"),
        ({"shard": (1, 9)}, "at most 8 parts, the number of rows"),
        ({"samples": None}, "expected samples with shard"),
        ({"crop": (0, 0, 2, 2)}, "shard or crop"),
        ({"time": 1.0}, "shard or time"),
        ({"adaptive": True}, "shard or adaptive"),
        ({"halves": True}, "shard or halves"),
        ({"denoise": True}, "shard or denoise"),
        ({"light_groups": True}, "shard or light_groups"),
    ):
        with pytest.raises(EclatError, match=words):
            eclat.render("furnace", "path", **common | wrong)


def test_the_command_renders_shards_and_goes_on_from_the_merged_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    common = ["render", "cornell-box", "--method", "path", "--size", "24x20", "-q"]
    for number in (1, 2, 3):
        assert main([*common, "--samples", "2", "--shard", f"{number}/3", "-o", f"part-{number}.exr"]) == 0
    assert main(["merge", "part-1.exr", "part-2.exr", "part-3.exr", "-o", "merged.exr", "-q"]) == 0
    assert main([*common, "--samples", "2", "-o", "whole.exr"]) == 0
    merged, whole = Image.load("merged.exr"), Image.load("whole.exr")
    assert np.array_equal(merged.pixels, whole.pixels)
    # The settings of the parts are those of the whole, so that it is continued, and parts are repeated, by their files alone.
    assert main(["render", "cornell-box", "--continue", "merged.exr", "--samples", "3", "-o", "more.exr", "-q"]) == 0
    assert main([*common, "--samples", "3", "-o", "at-once.exr"]) == 0
    assert np.array_equal(Image.load("more.exr").pixels, Image.load("at-once.exr").pixels)
    assert main(["render", "cornell-box", "--replay-settings", "part-2.exr", "-o", "again.exr", "-q"]) == 0
    assert np.array_equal(Image.load("again.exr").pixels, Image.load("part-2.exr").pixels)
    capsys.readouterr()
    for wrong, words in (
        (["--samples", "2", "--shard", "1/2", "-o", "x.png"], "--shard: expected an .exr file"),
        (["--shard", "1/2", "-o", "x.exr"], "expected samples with shard"),
        (["--samples", "2", "--shard", "0/2", "-o", "x.exr"], "--shard: expected a share I/N with 1 ≤ I ≤ N"),
    ):
        assert main([*common, *wrong]) == 2
        assert words in capsys.readouterr().err
