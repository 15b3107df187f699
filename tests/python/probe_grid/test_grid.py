# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Grids of probes: interpolation, files, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError
from eclat.probe_grid.grid import ProbeGrid
from support.probe_grids import some_grid


@pytest.mark.parametrize("suffix", [".json", ".npz", ".JSON"])
def test_files_hold_every_bit(tmp_path: Path, suffix: str) -> None:
    grid, path = some_grid(), tmp_path / f"a{suffix}"
    grid.save(path)
    again = eclat.ProbeGrid.load(path)
    assert (again.coefficients == grid.coefficients).all() and again.coefficients.dtype == np.float32
    assert (again.inside == grid.inside).all() and (again.positions == grid.positions).all()
    assert again.header() == grid.header()
    assert repr(again) == "<ProbeGrid: 3 x 2 x 4 probes, total light by path>"


def test_the_json_is_what_the_guide_says(tmp_path: Path) -> None:
    grid = some_grid()
    grid.save(tmp_path / "a.json")
    file = json.loads((tmp_path / "a.json").read_text())
    assert (file["format"], file["version"], file["counts"]) == ("eclat-probes", 1, [3, 2, 4])
    # x changes fastest, then y; a row is R, G, B of each coefficient.
    row = np.array(file["coefficients"][2 + 3 * (1 + 2 * 3)], np.float32).reshape(9, 3)
    assert (row == grid.coefficients[2, 1, 3]).all()
    assert file["inside"] == [0 + 3 * (1 + 2 * 2)]
    positions, coefficients = grid.rows()
    assert positions[2 + 3 * (1 + 2 * 3)].tolist() == [2.0, -1.0, 0.85]
    assert (coefficients[2 + 3 * (1 + 2 * 3)] == row).all()


def test_interpolation_is_exact_at_probes_and_for_linear_light() -> None:
    grid = some_grid()
    found = grid.at(grid.positions.reshape(-1, 3))
    assert found == pytest.approx(grid.coefficients.reshape(-1, 9, 3), abs=1e-6)
    linear = np.einsum("xyza,a->xyz", grid.positions, [1.0, 2.0, 3.0])[..., None, None] * np.ones((9, 3))
    grid.coefficients[:] = linear
    points = np.random.default_rng(2).uniform(grid.origin, grid.positions[-1, -1, -1], (50, 3))
    assert grid.at(points)[:, 4, 1] == pytest.approx(points @ [1.0, 2.0, 3.0], abs=1e-5)
    # Beyond the border is the border.
    assert grid.at([(100.0, 100.0, 100.0)])[0, 0, 0] == pytest.approx(linear[-1, -1, -1, 0, 0], abs=1e-6)


def test_a_grid_of_one_probe_is_the_same_everywhere() -> None:
    grid = some_grid((1, 2, 1))
    assert grid.at([(9.0, -2.0, 9.0), (-9.0, -1.0, 9.0)]) == pytest.approx(grid.coefficients[0, :, 0], abs=1e-6)


BROKEN = {
    "format": ("other", "expected a file of probes"),
    "version": (2, "expected version 1 of eclat-probes, got 2"),
    "counts": ([3, 2, 5], "is damaged"),
    "origin": ([1, 2], "is damaged"),
    "spacing": ([1, 2, float("inf")], "is damaged"),
    "inside": ([24], "is damaged"),
    "coefficients": ([[0] * 27], "is damaged"),
    "statistics": (3, "is damaged"),
    "unit": (None, "is damaged"),
}


@pytest.mark.parametrize("key", BROKEN)
def test_damaged_files_are_refused(tmp_path: Path, key: str) -> None:
    some_grid().save(tmp_path / "a.json")
    file = json.loads((tmp_path / "a.json").read_text())
    value, message = BROKEN[key]
    (tmp_path / "b.json").write_text(json.dumps(file | {key: value}))
    with pytest.raises(EclatError, match=message):
        ProbeGrid.load(tmp_path / "b.json")
    del file[key]
    (tmp_path / "c.json").write_text(json.dumps(file))
    with pytest.raises(EclatError, match=r"c\.json: "):
        ProbeGrid.load(tmp_path / "c.json")


def test_other_files_and_names_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("[1]")
    with pytest.raises(EclatError, match="JSON of another kind"):
        ProbeGrid.load(tmp_path / "a.json")
    (tmp_path / "a.json").write_bytes(b"\xff{")
    with pytest.raises(EclatError, match="is not JSON"):
        ProbeGrid.load(tmp_path / "a.json")
    (tmp_path / "a.npz").write_bytes(b"PK")
    with pytest.raises(EclatError, match=r"a\.npz"):
        ProbeGrid.load(tmp_path / "a.npz")
    with pytest.raises(EclatError, match="file not found"):
        ProbeGrid.load(tmp_path / "none.json")
    with pytest.raises(EclatError, match=r"expected a name that ends in \.json or \.npz"):
        some_grid().save(tmp_path / "a.txt")
    with pytest.raises(EclatError, match="cannot be written"):
        some_grid().save(tmp_path / "none" / "a.json")
