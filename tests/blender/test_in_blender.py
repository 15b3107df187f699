# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on inside Blender, as the module `bpy`: pictures beside those of Cycles and of the exported glTF, passes, Esc,
a viewport, and light maps.

They run in a Python of their own, which ECLAT_BPY_PYTHON names, because `bpy` serves one version of Python only and is a
gigabyte; `tools/check --full` makes one.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent / "in_blender"
PYTHON = os.environ.get("ECLAT_BPY_PYTHON", "")

pytestmark = [
    pytest.mark.full,
    pytest.mark.skipif(
        not PYTHON, reason="ECLAT_BPY_PYTHON names no Python that has bpy (tools/check --full makes build/bpy)"
    ),
]

DIFFUSE_AND_GLOSSY = {
    "diffuse_room", "four_lamps", "glossy_balls", "turned_sky", "instances", "sun_and_sky", "blurred", "glass_and_mixes",
}  # fmt: skip
"""Scenes whose materials are the same in Éclat and in Cycles."""

PRINCIPLED = {"textured", "parallel_cutout"}
"""Scenes with the Principled BSDF. Its diffuse part is dimmed by what its coat reflects: in Cycles by the direction of view
alone, in Éclat by both directions, so that light and view may change places. Under even light the sum is the same; under a
sun Éclat is up to 2 % brighter."""


COLOURED = {"diffuse_room", "glossy_balls"}
"""Scenes in which each channel is compared by itself."""


def run(program: str, folder: Path, *arguments: str) -> dict:
    paths = os.environ.get("PYTHONPATH", str(ROOT / "python"))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT / "blender"), paths))}
    command = [PYTHON, str(HERE / program), str(folder), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200, env=environment)
    result = folder / "means.json"
    assert result.exists(), done.stdout[-2000:] + done.stderr[-2000:]
    return json.loads(result.read_text())


@pytest.fixture(scope="module")
def means(tmp_path_factory):
    return run("compare.py", tmp_path_factory.mktemp("pictures"), "256")


@pytest.mark.parametrize("name", sorted(DIFFUSE_AND_GLOSSY | PRINCIPLED))
def test_the_mean_is_that_of_cycles(means, name):
    ours, theirs = means[name]["ours"], means[name]["theirs"]
    close = 0.03 if name in PRINCIPLED else 0.01
    assert sum(ours[:3]) == pytest.approx(sum(theirs[:3]), rel=close)
    if name in COLOURED:
        assert ours[:3] == pytest.approx(theirs[:3], rel=0.005)
    assert ours[3] == pytest.approx(theirs[3], abs=0.003)
    assert means[name]["left"] == pytest.approx(means[name]["left_theirs"], rel=3 * close)


@pytest.fixture(scope="module")
def features(tmp_path_factory):
    return run("features.py", tmp_path_factory.mktemp("features"))


def test_passes_reach_the_file(features):
    layers = features["passes"]
    for name in ("Direct.R", "Indirect.R", "Albedo.R", "Normal.Z", "Depth.Z", "Record Density.X"):
        assert f"ViewLayer.{name}" in layers
    combined = layers["ViewLayer.Combined.R"]
    assert layers["ViewLayer.Direct.R"] + layers["ViewLayer.Indirect.R"] == pytest.approx(combined, rel=0.02)
    assert layers["ViewLayer.Record Density.X"] > 0


def test_the_exported_gltf_gives_the_same_picture(features):
    assert features["gltf"] == pytest.approx(features["blender"], rel=0.01)


def test_light_maps_of_the_selected_objects(features):
    assert features["maps"] == ["Cube light map", "Plane light map"]
    assert features["floor"] == pytest.approx(features["floor_by_path"], rel=0.03)


def test_a_viewport_is_translated_and_refined(features):
    assert features["viewport"] == pytest.approx(features["viewport_final"], rel=0.03)


def test_registration_is_undone(features):
    assert features["unregistered"]
