# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Probes in the layouts of engines, against the formulas of their shaders, and by three.js' own code in Node."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat.probe_grid.layouts import for_godot, for_unity
from support.browser import WEB, require_node
from support.probe_grids import some_grid


def directions(count: int) -> np.ndarray:
    found = np.random.default_rng(3).normal(size=(count, 3))
    return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])


def test_three_js_shows_the_same_irradiance(tmp_path: Path) -> None:
    """`SphericalHarmonics3.getIrradianceAt` of what `web/eclat-probes.js` interpolates."""
    grid = some_grid()
    grid.save(tmp_path / "a.json")
    rng = np.random.default_rng(5)
    points = rng.uniform(grid.origin - 0.3, grid.positions[-1, -1, -1] + 0.3, (60, 3))
    points[:24] = grid.positions.reshape(-1, 3)
    normals = directions(60)
    request = {"file": str(tmp_path / "a.json"), "points": points.tolist(), "normals": normals.tolist()}
    run = subprocess.run(
        [require_node(), str(WEB / "tests/probes.mjs")],
        input=json.dumps(request),
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert np.array(json.loads(run.stdout)) == pytest.approx(grid.irradiance(points, normals), abs=2e-5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"format": "x"}, "expected a file of the format"),
        ({"version": 9}, "got 9"),
        ({"counts": [9, 9, 9]}, "729 probes"),
    ],
)
def test_the_reader_for_three_js_refuses_other_files(tmp_path: Path, change: dict[str, object], message: str) -> None:
    some_grid().save(tmp_path / "a.json")
    (tmp_path / "a.json").write_text(json.dumps(json.loads((tmp_path / "a.json").read_text()) | change))
    request = json.dumps({"file": str(tmp_path / "a.json"), "points": [], "normals": []})
    run = subprocess.run(
        [require_node(), str(WEB / "tests/probes.mjs")],
        input=request,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert run.returncode != 0 and message in run.stderr


def test_godot_shows_the_same_irradiance() -> None:
    """The ambient light that Godot's scene shader makes of the nine colours of a LightmapGI capture, which it multiplies by
    the albedo: E / π."""
    grid = some_grid()
    positions, _ = grid.rows()
    godot = for_godot(grid)
    assert (godot.points == positions).all()
    normals = directions(len(positions))
    x, y, z = normals.T[:, :, None]
    sh = godot.colors.transpose(1, 0, 2)
    c = (0.886227, 1.023327, 0.858086, 0.247708, 0.429043)
    ambient = c[0] * sh[0] + c[1] * (sh[1] * y + sh[2] * z + sh[3] * x)
    ambient += c[2] * (sh[4] * x * y + sh[5] * y * z + sh[7] * x * z)
    ambient += c[3] * sh[6] * (3 * z * z - 1) + c[4] * sh[8] * (x * x - y * y)
    assert np.pi * ambient == pytest.approx(grid.irradiance(positions, normals), abs=2e-5)


@pytest.mark.parametrize("axis", ["x", "z"])
def test_unity_shows_the_same_irradiance(axis: str) -> None:
    """ShadeSH9 of unity_SHAr … unity_SHC, which Unity multiplies by the albedo: E / π, seen in a mirrored world."""
    grid = some_grid()
    positions, _ = grid.rows()
    normals = directions(len(positions))
    mirror = np.array([-1.0 if name == axis else 1.0 for name in "xyz"])
    unity = for_unity(grid, axis)  # type: ignore[arg-type]
    assert (unity.positions == positions * mirror).all()
    seen = normals * mirror
    x, y, z = seen.T
    linear = np.stack([x, y, z, np.ones_like(x)], axis=1)
    products = np.stack([x * y, y * z, z * z, z * x], axis=1)
    A, B, C = unity.shader[:, 0:3], unity.shader[:, 3:6], unity.shader[:, 6, :3]
    shade = np.einsum("ncj,nj->nc", A, linear) + np.einsum("ncj,nj->nc", B, products) + C * (x * x - y * y)[:, None]
    assert np.pi * shade == pytest.approx(grid.irradiance(positions, normals), abs=1e-6)
    # The packed vectors are those that Unity makes of a SphericalHarmonicsL2.
    sh = unity.harmonics
    assert (unity.shader[:, 0, 3] == sh[:, 0, 0] - sh[:, 0, 6]).all()
    assert (unity.shader[:, 4, 2] == 3 * sh[:, 1, 6]).all()
    with pytest.raises(EclatError, match="mirrored: expected 'x' or 'z', got 'y'"):
        for_unity(grid, "y")  # type: ignore[arg-type]
