# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""One bad part of many is a warning that names it, in each format; where all parts are bad it is an error."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError
from eclat.loaders.parts import MOST_NAMED, LimitError, Parts

GOOD: dict[str, Any] = {"type": "sphere"}
BAD: dict[str, dict[str, Any]] = {
    "a mesh file that is not there": {"type": "obj", "filename": "gone.obj"},
    "a mesh without area": {"type": "obj", "filename": "flat.obj"},
    "a mesh with a vertex that is no number": {"type": "obj", "filename": "nan.obj"},
    "an empty mesh file": {"type": "ply", "filename": "empty.ply"},
    "a radius below 0": {"type": "sphere", "radius": -1.0},
    "coordinates beyond all bounds": {"type": "cube", "to_world": np.diag([1e25, 1e25, 1e25, 1.0])},
    "a spot without a beam": {"type": "spot", "cutoff_angle": -3.0},
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
    (tmp_path / "nan.obj").write_text("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "empty.ply").write_text("")
    return tmp_path


@pytest.mark.parametrize("kind", list(BAD))
def test_a_bad_part_of_a_mitsuba_scene_is_left_out_with_a_warning(folder: Path, kind: str) -> None:
    with warnings.catch_warnings(record=True) as record:
        warnings.simplefilter("always")
        scene = eclat.load_dict({"type": "scene", "one": GOOD, "bad": BAD[kind], "two": GOOD}, folder)
    assert len(scene.meshes) == 2
    (message,) = (str(warning.message) for warning in record)
    assert message.endswith("; this part of the scene is left out")
    assert "bad" in message or "flat.obj" in message or "nan.obj" in message or "empty.ply" in message


@pytest.mark.parametrize("kind", list(BAD))
def test_a_scene_whose_parts_are_all_bad_is_refused(folder: Path, kind: str) -> None:
    with pytest.raises(EclatError):
        eclat.load_dict({"type": "scene", "bad": BAD[kind]}, folder)


def test_a_bad_primitive_of_a_gltf_file_is_left_out_with_a_warning(tmp_path: Path) -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [np.nan, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes()
    (tmp_path / "points.bin").write_bytes(points)
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": 1}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "byteOffset": 36 * i} for i in (0, 1)
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 72}],
        "buffers": [{"uri": "points.bin", "byteLength": 72}],
    }
    (tmp_path / "scene.gltf").write_text(json.dumps(document))
    with pytest.warns(eclat.EclatWarning, match=r"primitives\[1\].*left out"):
        assert len(eclat.load(tmp_path / "scene.gltf").meshes) == 1


def test_limits_end_the_load_and_many_errors_are_counted() -> None:
    parts = Parts()
    with pytest.raises(LimitError), parts.one():
        raise LimitError("too large")
    with parts.one():
        pass
    for number in range(MOST_NAMED + 5):
        with parts.one():
            raise EclatError(f"part {number}")
    with pytest.warns(eclat.EclatWarning) as record:
        parts.finish()
    assert len(record) == MOST_NAMED + 1 and str(record[-1].message).startswith("5 more parts")
