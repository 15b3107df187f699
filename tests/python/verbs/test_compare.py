# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Methods beside the truth, with a renderer whose noise is known."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.cli import main
from eclat.errors import EclatError
from eclat.images.image import Image
from eclat.loaders import load
from eclat.report.compare_page import page_facts
from eclat.verbs.compare import Effort, Reference, compare, default_size
from support.fake_api import FakeApi


@pytest.fixture
def api(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> FakeApi:
    monkeypatch.chdir(tmp_path)
    return FakeApi(monkeypatch)


def test_each_level_halves_noise_and_bias() -> None:
    effort = Effort(levels=3, samples=64, max_error=0.01)
    assert [effort.at(level) for level in range(3)] == [
        ({"samples": 4}, 0.04),
        ({"samples": 16}, 0.02),
        ({"samples": 64}, 0.01),
    ]
    assert [Effort(levels=2, time=8.0).at(level)[0] for level in range(2)] == [{"time": 2.0}, {"time": 8.0}]
    # Never more than options accept, never less than one sample.
    assert Effort(levels=9, samples=1, max_error=0.1).at(0) == ({"samples": 1}, 0.5)


def test_errors_are_those_of_the_known_noise(api: FakeApi) -> None:
    comparison = compare(load("cornell-box"), ["path"], effort=Effort(3, 64), size=(96, 64), reference_samples=1024)
    (result,) = comparison.results
    for measurement in result.measurements:
        noise = 0.5 / math.sqrt(measurement.statistics["samples"])
        # Slightly less, since c counts too.
        assert 0.9 * noise < measurement.error < 1.02 * noise
    assert comparison.reference.noise == pytest.approx(0.5 / math.sqrt(2048), rel=0.1)
    assert result.measurements[-1].error_away_from_edges == pytest.approx(result.measurements[-1].error)


def test_references_and_pictures_come_from_unrelated_seeds(api: FakeApi) -> None:
    compare(load("cornell-box"), ["path"], effort=Effort(1), size=(8, 8), seed=5)
    assert len({call["seed"] for call in api.calls}) == 3
    assert [call["samples"] for call in api.calls] == [256, 256, 64]


def test_all_methods_by_default_and_no_level_twice(api: FakeApi) -> None:
    comparison = compare(load("cornell-box"), effort=Effort(3, 4), size=(8, 8))
    assert [(r.method, len(r.measurements)) for r in comparison.results] == [
        ("direct", 2),
        ("path", 2),
        ("irradiance-cache", 3),
        ("radiance-cache", 3),
        ("photon-map", 3),
        ("radiosity", 3),
    ]
    photons = [call["what"].photons for call in api.calls if isinstance(call["what"], eclat.PhotonMap)]
    assert photons == [12_500, 50_000, 200_000]


def test_a_reference_of_ones_own_sets_the_size(api: FakeApi) -> None:
    truth = Image(np.ones((6, 10, 3), dtype=np.float32))
    comparison = compare(load("cornell-box"), ["direct"], effort=Effort(1), reference=Reference(truth, truth))
    assert api.calls[0]["size"] == (10, 6)
    assert comparison.reference.noise is None
    assert comparison.results[0].measurements[0].error_away_from_edges is None


def test_progress_says_which_rendering_it_is(api: FakeApi) -> None:
    phases: list[str] = []
    scene = load("cornell-box")
    compare(scene, ["path"], effort=Effort(2), size=(8, 8), progress=lambda phase, *_: phases.append(phase))
    assert list(dict.fromkeys(phases)) == [
        "reference 1 of 2: render",
        "reference 2 of 2: render",
        "path, level 1: render",
        "path, level 2: render",
    ]


def test_the_camera_size_is_scaled_down() -> None:
    scene = load("cornell-box")
    wide = dataclasses.replace(scene, cameras=(dataclasses.replace(scene.cameras[0], size=(1280, 720)),))
    assert default_size(wide, 0) == (512, 288)
    assert default_size(dataclasses.replace(scene, cameras=()), 0) == (512, 288)
    assert default_size(scene, 0) == (512, 512)


def test_levels_out_of_range() -> None:
    with pytest.raises(EclatError, match="levels: expected 1 to 10, got 0"):
        Effort(levels=0)


def test_the_command_writes_one_page_and_its_numbers(api: FakeApi, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = "compare cornell-box --size 32x24 --levels 2 --samples 16 --methods path,irradiance-cache"
    assert main(arguments.split()) == 0
    assert [path.name for path in Path().iterdir()] == ["cornell-box.html"]
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "cornell-box.html"
    assert [line.split()[0] for line in lines[1:]] == ["path", "irradiance-cache"]
    assert main([*arguments.split(), "--json"]) == 0
    result = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert [m["method"] for m in result["measurements"]] == ["path"] * 2 + ["irradiance-cache"] * 2


def test_references_from_files(api: FakeApi, capsys: pytest.CaptureFixture[str]) -> None:
    for name, size in (("a.exr", 8), ("b.exr", 8), ("c.exr", 9)):
        Image(np.ones((size, size, 3), dtype=np.float32)).save(name)
    base = ["compare", "cornell-box", "--methods", "direct", "--levels", "1", "--quiet"]
    assert main([*base, "--reference", "a.exr", "--reference", "b.exr"]) == 0
    assert len(api.calls) == 1
    for bad in (["a.exr", "c.exr"], ["a.exr", "a.exr", "a.exr"]):
        assert main([*base, *(part for name in bad for part in ("--reference", name))]) == 2
    assert capsys.readouterr().err == (
        "eclat: --reference: expected pictures of the same size, and of --size if that is given, got 8x8 and 9x9\n"
        "eclat: --reference: expected one or two files, got 3\n"
    )


def test_facts_are_json(api: FakeApi) -> None:
    comparison = compare(load("cornell-box"), ["direct"], effort=Effort(1), size=(8, 8))
    facts = json.loads(json.dumps(page_facts(comparison)))
    assert facts["scene"] == "cornell-box"
    assert facts["measurements"][0]["statistics"]["samples"] == 64
