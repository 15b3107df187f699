# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A radiosity solution as a value."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.cli import main
from eclat.scenes import build

OPTIONS = eclat.Radiosity(patches=500, refinements=1)


@pytest.fixture(scope="module")
def scene() -> eclat.Scene:
    return build("cornell-box")


@pytest.fixture(scope="module")
def solution(scene: eclat.Scene) -> eclat.RadiositySolution:
    return eclat.solve(scene, OPTIONS)


def test_arrays(solution: eclat.RadiositySolution) -> None:
    n = len(solution)
    assert n > 250
    assert solution.corners.shape == (n, 3, 3) and np.abs(solution.corners).max() < 1.02
    for colors in (solution.direct, solution.irradiance, solution.albedo, solution.emitted, solution.radiosity):
        assert colors.shape == (n, 3) and colors.min() >= 0
    walls = solution.areas[solution.triangles < 10].sum()
    assert walls == pytest.approx(4 * 4 + 4 * 0.23 * 0.19, rel=1e-4)  # light, floor, ceiling, back, green
    assert np.linalg.norm(solution.normals, axis=1) == pytest.approx(1)
    assert (solution.irradiance >= solution.direct - 1e-6).all()
    assert not solution.is_back.any()
    assert solution.statistics["patches"] == n


def test_save_and_load(solution: eclat.RadiositySolution, scene: eclat.Scene, tmp_path: Path) -> None:
    file = tmp_path / "radiosity.npz"
    solution.save(file)
    loaded = eclat.RadiositySolution.load(file, scene)
    assert np.array_equal(loaded.patches, solution.patches) and np.array_equal(loaded.values, solution.values)
    assert np.array_equal(loaded.corners, solution.corners) and loaded.options == OPTIONS
    first, second = (eclat.render(scene, s, samples=1, size=(16, 16)).pixels for s in (solution, loaded))
    assert np.array_equal(first, second)
    assert isinstance(eclat.load_solved(file, scene), eclat.RadiositySolution)
    with pytest.raises(eclat.EclatError, match="solved for another scene"):
        eclat.RadiositySolution.load(file, build("furnace"))
    with pytest.raises(
        eclat.EclatError, match="max_depth: expected -1, with which this radiosity solution was solved, got 4"
    ):
        eclat.render(scene, loaded, samples=1, size=(16, 16), max_depth=4)


def test_damaged_files(solution: eclat.RadiositySolution, scene: eclat.Scene, tmp_path: Path) -> None:
    file = tmp_path / "radiosity.npz"
    with pytest.raises(eclat.EclatError, match="file not found"):
        eclat.RadiositySolution.load(file)
    solution.save(file)
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(eclat.EclatError, match="the file was not saved by Éclat, or it is damaged"):
        eclat.RadiositySolution.load(file)
    with pytest.raises(eclat.EclatError, match="the file was not saved by Éclat, or it is damaged"):
        eclat.load_solved(file, scene)
    with np.load(_saved(solution, file)) as data:
        arrays = dict(data)
    np.savez(file, **{**arrays, "values": arrays["values"][:-1]})
    with pytest.raises(eclat.EclatError, match="the array 'values' is damaged"):
        eclat.RadiositySolution.load(file)
    patches = arrays["patches"].copy()
    patches[0] = patches[1]
    np.savez(file, **{**arrays, "patches": patches})
    with pytest.raises(eclat.EclatError, match="cover the surfaces of this scene without gaps or overlaps"):
        eclat.render(scene, eclat.RadiositySolution.load(file), samples=1, size=(8, 8))


def _saved(solution: eclat.RadiositySolution, file: Path) -> Path:
    solution.save(file)
    return file


def test_options_out_of_range() -> None:
    with pytest.raises(eclat.EclatError, match="Radiosity: solver must be one of gathering, shooting, got 'shoot'"):
        eclat.Radiosity(solver="shoot")  # type: ignore[arg-type]
    with pytest.raises(eclat.EclatError, match="Radiosity: patch_size must be between 1e-09 and 1e"):
        eclat.Radiosity(patch_size=0.0)


def test_radiosity_is_for_the_whole_scene(scene: eclat.Scene) -> None:
    with pytest.raises(eclat.EclatError, match="radiosity is solved for the whole scene"):
        eclat.solve(scene, OPTIONS, size=(16, 16))


def test_patch_size_bounds_edges(scene: eclat.Scene) -> None:
    solution = eclat.solve(scene, eclat.Radiosity(patch_size=0.4, refinements=0))
    edges = np.linalg.norm(solution.corners - np.roll(solution.corners, 1, axis=1), axis=2)
    assert edges.max() <= 0.4


def test_glass_causes_a_warning() -> None:
    from eclat.scene import Material
    from eclat.scenes.geometry import box, mesh

    pane = mesh([box((0, 0, 0), (1, 1, 0.1))], Material("dielectric", name="pane"), "pane")
    with pytest.warns(eclat.EclatWarning, match="no light will pass through pane to other surfaces"):
        eclat.solve(eclat.Scene((pane,)), eclat.Radiosity(patches=20))


def test_a_thin_pane_lets_light_through_and_is_warned_of_as_a_mirror() -> None:
    from eclat.scene import Material
    from eclat.scenes.geometry import box, mesh

    sheet = mesh([box((0, 0, 0), (1, 1, 0.1))], Material("thin_dielectric", name="pane"), "pane")
    with pytest.warns(eclat.EclatWarning, match="pane will light other surfaces as diffuse surfaces do") as warned:
        eclat.solve(eclat.Scene((sheet,)), eclat.Radiosity(patches=20))
    assert not any("no light will pass" in str(w.message) for w in warned)


def test_solved_on_the_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    settings = ["--method", "radiosity", "--set", "patches=300"]
    assert main(["solve", "cornell-box", *settings, "-o", "a.npz", "--quiet"]) == 0
    assert main(["render", "cornell-box", "--cache", "a.npz", "--size", "8x8", "--samples", "1", "--quiet"]) == 0
    assert (tmp_path / "cornell-box.png").exists()
    assert main(["solve", "cornell-box", *settings, "--view-independent", "-o", "b.npz", "--quiet"]) == 2
    assert not (tmp_path / "b.npz").exists()
