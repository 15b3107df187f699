# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Caches as values: files that are whole, refused where they do not fit, and merged."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.scenes import build

POINTS = (np.array([[0.0, -1.0, 0.0], [0.5, -1.0, 0.5]]), np.array([[0.0, 1.0, 0.0]] * 2))


@pytest.fixture(scope="module")
def scene() -> eclat.Scene:
    return build("cornell-box")


@pytest.fixture(scope="module")
def solution(scene: eclat.Scene) -> eclat.Solution:
    return eclat.solve(scene, eclat.IrradianceCache(max_error=0.1), points=POINTS, max_depth=4)


def test_the_core_says_where_the_fields_of_a_record_lie(solution: eclat.Solution) -> None:
    layout = eclat._core.record_layout()
    taken = [place for _, first, count in layout for place in range(first, first + count)]
    assert len(taken) == len(set(taken)) and max(taken) < solution.near.shape[1]
    # The two records lie at the points that were asked for, on the floor of a closed room.
    assert np.allclose(np.sort(solution.positions, axis=0), np.sort(POINTS[0], axis=0), atol=1e-5)
    assert np.allclose(solution.normals, (0, 1, 0), atol=1e-6)
    assert (solution.irradiance[0] > 0).all() and (solution.radii > 0).all()
    assert solution.enclosed.tolist() == [False, True]  # the second one lies inside of a box
    column = {name: slice(first, first + count) for name, first, count in layout}
    marked = solution.near.copy()
    marked[:, column["enclosed"]] = 1
    core = eclat._core.SolvedCaches(marked, solution.far, eclat._core.IrradianceCacheOptions())
    assert np.array_equal(core.near[:, column["enclosed"]], marked[:, column["enclosed"]])
    assert core.near.shape == solution.near.shape


def test_a_saved_file_is_loaded_unchanged(scene: eclat.Scene, solution: eclat.Solution, tmp_path: Path) -> None:
    solution.save(tmp_path / "a.npz")
    assert [p.name for p in tmp_path.iterdir()] == ["a.npz"]
    loaded = eclat.Solution.load(tmp_path / "a.npz", scene)
    assert (loaded.options, loaded.max_depth, loaded.complete) == (solution.options, 4, True)
    assert loaded.statistics == solution.statistics
    for name in ("near", "far", "center"):
        assert np.array_equal(getattr(loaded, name), getattr(solution, name))


def test_a_file_that_cannot_be_written_is_reported(solution: eclat.Solution, tmp_path: Path) -> None:
    with pytest.raises(eclat.EclatError, match=r"the file cannot be written, because the folder .* does not exist"):
        solution.save(tmp_path / "no" / "a.npz")


def _write(path: Path, solution: eclat.Solution, **changes: Any) -> None:
    solution.save(path)
    with np.load(path) as data:
        arrays = dict(data)
    header = json.loads(str(arrays["header"]))
    for name, value in changes.items():
        if name in arrays:
            arrays[name] = value
        else:
            header[name] = value
    arrays["header"] = np.array(json.dumps(header))
    np.savez(path, **arrays)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"format": 99}, "expected a cache of this version of Éclat, got one of another version"),
        ({"options": {"sharpness": 3}}, "the header is damaged"),
        ({"options": {"max_error": 7}}, "the header is damaged"),
        ({"max_depth": "deep"}, "the header is damaged"),
        ({"near": np.zeros((3, 2), np.float32)}, "the array 'near' is damaged"),
        ({"far": np.full((1, 45), np.nan, np.float32)}, "the array 'far' is damaged"),
        ({"near": np.full((1, 53), 1e20, np.float32)}, "the array 'near' is damaged"),
        ({"center": np.zeros(2)}, "in the array 'center', got others"),
    ],
)
def test_damage_is_named_in_the_message(
    solution: eclat.Solution, tmp_path: Path, changes: dict[str, Any], message: str
) -> None:
    path = tmp_path / "a.npz"
    _write(path, solution, **changes)
    with pytest.raises(eclat.EclatError, match=message) as error:
        eclat.Solution.load(path)
    assert str(error.value).startswith(f"{path}: ")


@pytest.mark.parametrize("content", [b"", b"0 0 0 0 1 0\n", b"\x93NUMPY\x01\x00", b"PK\x03\x04 and no more"])
def test_files_that_are_no_archives_are_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(content)
    with pytest.raises(eclat.EclatError, match="the file was not saved by Éclat, or it is damaged") as error:
        eclat.Solution.load(path)
    assert "pickle" not in str(error.value)
    np.save(tmp_path / "array.npy", np.zeros(3))
    with pytest.raises(eclat.EclatError, match=r"array\.npy: the file was not saved"):
        eclat.Solution.load(tmp_path / "array.npy")
    with pytest.raises(eclat.EclatError, match="file not found"):
        eclat.Solution.load(tmp_path / "missing.npz")


def test_records_under_an_open_sky_survive(tmp_path: Path) -> None:
    """They see nothing, at an infinite distance."""
    scene = build("cornell-box")
    sky = eclat.scene.Environment(np.ones((1, 1, 3), np.float32))
    open_floor = eclat.Scene(meshes=tuple(m for m in scene.meshes if m.name == "floor"), environment=sky)
    solution = eclat.solve(open_floor, points=POINTS)
    assert np.isinf(solution.near).any()
    solution.save(tmp_path / "a.npz")
    assert len(eclat.Solution.load(tmp_path / "a.npz", open_floor)) == len(solution)


def test_merging_an_incomplete_cache_gives_an_incomplete_one(scene: eclat.Scene, solution: eclat.Solution) -> None:
    from dataclasses import replace

    both = eclat.merge(solution, replace(solution, complete=False))
    assert not both.complete and both.max_depth == 4 and len(both) == len(solution)
    with pytest.raises(eclat.EclatError, match="expected two solutions with the same options"):
        eclat.merge(solution, replace(solution, max_depth=3))
    with pytest.warns(eclat.EclatWarning, match="incomplete"):
        eclat.irradiance(scene, *POINTS, both, max_depth=4, samples=1)
