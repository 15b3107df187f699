# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Charts: without overlap, apart, to scale, by xatlas and without it."""

from __future__ import annotations

import os
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.gltf_export.geometry import with_flat_normals
from eclat.lightmap import atlas as atlas_module
from eclat.lightmap.atlas import Atlas, Packing, areas, default_texel_size, unwrap
from eclat.lightmap.texels import corners_of, rasterize
from eclat.scene import Material, Mesh
from eclat.scenes import build

BOTH = pytest.mark.parametrize("timeout", [60.0, 0.0], ids=["xatlas", "planar"])


def meshes_of(name: str) -> list[Mesh]:
    return [with_flat_normals(mesh) for mesh in eclat.load(name).meshes]


def check(meshes: list[Mesh], atlas: Atlas, texel_size: float, scale: float = 0.1) -> None:
    """Charts lie apart, inside the image, and are about as large as the texel size says: xatlas stretches them to whole
    texels."""
    corners = corners_of(meshes, atlas)
    texels = rasterize(corners, atlas.width, atlas.stack_height)
    assert texels.shared == 0, "no texel is read from two charts"
    for unwrapped in atlas.meshes:
        placed = unwrapped.charts >= 0
        uvs = unwrapped.uvs[placed]
        # Bilinear filtering clamps half a texel from the border, so charts must not come nearer.
        assert (uvs >= 0.5 - 1e-4).all() and (uvs <= np.array([atlas.width, atlas.height]) - 0.5 + 1e-4).all()
        assert unwrapped.page_of_vertices().max(initial=0) < atlas.pages
        for chart in np.unique(unwrapped.charts[placed]):
            assert len(np.unique(unwrapped.page_of_vertices()[unwrapped.charts == chart])) == 1, "charts are whole"
    # Inside a chart nothing overlaps: a texel's centre lies in one triangle at most, or on an edge of several.
    a, b, c = (corners.uvs[:, i] for i in range(3))
    doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    inside = np.abs(doubled).sum() / 2
    world = sum(areas(mesh).sum() for mesh in meshes) / texel_size**2
    assert inside == pytest.approx(world, rel=scale)
    rng = np.random.default_rng(0)
    points = rng.uniform(0, (atlas.width, atlas.stack_height), (4000, 2))
    hits = np.zeros(len(points), int)
    for triangle, area in zip(corners.uvs, doubled, strict=True):
        if area == 0:
            continue
        edges, offsets = np.roll(triangle, -1, axis=0) - triangle, points - triangle[:, None]
        sides = [e[0] * o[:, 1] - e[1] * o[:, 0] for e, o in zip(edges, offsets, strict=True)]
        hits += (np.stack(sides) * np.sign(area) > 1e-9).all(axis=0)
    assert hits.max() <= 1
    for mesh, unwrapped in zip(meshes, atlas.meshes, strict=True):
        np.testing.assert_array_equal(unwrapped.vertices[unwrapped.triangles], mesh.triangles)


@BOTH
@pytest.mark.parametrize("gutter", [2, 6])
def test_cornell_box(timeout: float, gutter: int) -> None:
    meshes = meshes_of("cornell-box")
    atlas = unwrap(meshes, 0.05, Packing(gutter, timeout=timeout))
    check(meshes, atlas, 0.05)
    assert atlas.method == ("xatlas" if timeout else "planar")
    charts = [len(np.unique(m.charts)) for m in atlas.meshes]
    assert charts == [1] * 6 + [6] * 2


@BOTH
def test_curved_meshes(timeout: float) -> None:
    meshes = [with_flat_normals(mesh) for mesh in build("furnace").meshes]
    atlas = unwrap(meshes, 0.1, Packing(timeout=timeout))
    check(meshes, atlas, 0.1, scale=0.3 if timeout else 1e-6)


@BOTH
def test_uvs_of_the_scene_do_not_matter(timeout: float) -> None:
    """Overlapping, repeated, missing: the light map has its own."""
    (wall, *_), n = meshes_of("cornell-box"), 0.05
    stacked = replace(wall, uvs=np.zeros((len(wall.positions), 2)))
    beyond = replace(wall, uvs=np.full((len(wall.positions), 2), 1e6))
    found = [unwrap([wall, mesh], n, Packing(timeout=timeout)).meshes[1].uvs for mesh in (wall, stacked, beyond)]
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])


@BOTH
def test_instances_and_mirror_images_have_charts_of_their_own(timeout: float) -> None:
    box = meshes_of("cornell-box")[-1]
    mirror = np.array([-1.0, 1, 1])
    mirrored = replace(
        box, positions=box.positions * mirror, normals=box.normals * mirror, triangles=box.triangles[:, ::-1]
    )
    meshes = [box, replace(box, positions=box.positions + np.array([5, 0, 0])), mirrored, box]
    check(meshes, unwrap(meshes, 0.05, Packing(timeout=timeout)), 0.05)


@BOTH
def test_triangles_without_area_go_along(timeout: float) -> None:
    wall = meshes_of("cornell-box")[1]
    thin = replace(wall, triangles=np.concatenate((wall.triangles, [[0, 0, 1], [2, 2, 2]])))
    atlas = unwrap([thin], 0.1, Packing(timeout=timeout))
    assert np.isfinite(atlas.meshes[0].uvs).all()
    assert len(atlas.meshes[0].triangles) == len(thin.triangles)
    assert len(rasterize(corners_of([thin], atlas), atlas.width, atlas.height)) >= 21 * 21


@BOTH
def test_meshes_without_triangles_go_along(timeout: float) -> None:
    wall, *_ = meshes_of("cornell-box")
    empty = replace(wall, triangles=np.zeros((0, 3), np.int64))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        atlas = unwrap([empty, wall, empty], 0.1, Packing(timeout=timeout))
    assert [len(m.triangles) for m in atlas.meshes] == [0, 2, 0]
    check([empty, wall, empty], atlas, 0.1, scale=0.2)


def test_too_slow_or_broken_unwrapping_is_replaced(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A child that sleeps is killed, one that fails is told; charts come in any case."""
    meshes = meshes_of("cornell-box")
    monkeypatch.setattr(atlas_module, "XATLAS_PROGRAM", tmp_path / "child.py")
    for program, problem in (
        ("import time; time.sleep(100)", "took longer than 0.5 s"),
        ("raise MemoryError('no room')", "failed .MemoryError: no room."),
        ("print('nonsense')", "gave no charts"),
    ):
        (tmp_path / "child.py").write_text(program)
        started = time.monotonic()
        with pytest.warns(EclatWarning, match=problem):
            atlas = unwrap(meshes, 0.05, Packing(timeout=0.5 if "sleep" in program else 20))
        assert atlas.method == "planar" and time.monotonic() - started < 50
        check(meshes, atlas, 0.05)


@pytest.mark.parametrize("crashes", [1, atlas_module.ATTEMPTS])
def test_charts_do_not_depend_on_a_crash(crashes: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A child that a signal ends is started again, a few times."""
    meshes = meshes_of("cornell-box")
    whole = unwrap(meshes, 0.05)
    real, runs = atlas_module.XATLAS_PROGRAM, tmp_path / "runs"
    (tmp_path / "child.py").write_text(
        f"import os, signal, sys\nsys.path.insert(0, {str(real.parent)!r})\nimport xatlas_process\n"
        f"open({str(runs)!r}, 'a').write('.')\n"
        f"if os.path.getsize({str(runs)!r}) <= {crashes}: os.kill(os.getpid(), signal.SIGSEGV)\n"
        "xatlas_process.main()\n"
    )
    monkeypatch.setattr(atlas_module, "XATLAS_PROGRAM", tmp_path / "child.py")
    if crashes == atlas_module.ATTEMPTS:
        with pytest.warns(EclatWarning, match="failed .exit code -11."):
            assert unwrap(meshes, 0.05).method == "planar"
    else:
        for again, first in zip(unwrap(meshes, 0.05).meshes, whole.meshes, strict=True):
            np.testing.assert_array_equal(again.uvs, first.uvs)
    assert runs.stat().st_size == min(crashes + 1, atlas_module.ATTEMPTS)


def test_an_atlas_that_is_too_large_is_refused() -> None:
    long = Mesh(np.array([[0.0, 0, 0], [100, 0, 0], [0, 0.1, 0]]), np.array([[0, 1, 2]]), Material())
    with pytest.raises(EclatError, match=r"more than a page of 256 x 256; a texel size of .* m fits"):
        unwrap([with_flat_normals(long)], 0.1, Packing(max_size=256, timeout=0))


@BOTH
def test_charts_that_do_not_fit_on_one_page_go_on_several(timeout: float) -> None:
    meshes = meshes_of("cornell-box")
    for max_size, least in ((64, 3), (80, 2), (256, 1)):
        atlas = unwrap(meshes, 0.05, Packing(max_size=max_size, timeout=timeout))
        check(meshes, atlas, 0.05)
        assert atlas.pages >= least and max(atlas.width, atlas.height) <= max_size
        used = np.unique(np.concatenate([u.page_of_vertices() for u in atlas.meshes]))
        np.testing.assert_array_equal(used, np.arange(atlas.pages))
        corners = corners_of(meshes, atlas)
        rows = rasterize(corners, atlas.width, atlas.stack_height).rows % (atlas.height + atlas.gap)
        assert rows.max() < atlas.height, "no texel lies between pages"


def test_default_texel_size() -> None:
    assert default_texel_size(26.0) == 0.01
    assert default_texel_size(26.0e6) == pytest.approx(10, rel=0.05)
    assert default_texel_size(0) == 1


def test_an_interrupt_ends_the_child(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "child.py").write_text(
        "import os, sys, time\n"
        f"open({str(tmp_path / 'starting')!r}, 'w').write(str(os.getpid()))\n"
        f"os.rename({str(tmp_path / 'starting')!r}, {str(tmp_path / 'pid')!r})\n"
        "time.sleep(1000)\n"
    )
    monkeypatch.setattr(atlas_module, "XATLAS_PROGRAM", tmp_path / "child.py")

    def progress(*report: object) -> None:
        if (tmp_path / "pid").exists():
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        unwrap(meshes_of("cornell-box"), 0.05, Packing(timeout=120), progress)
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)


def test_triangles_that_xatlas_leaves_out_get_charts_of_their_own(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Sibenik has slivers that xatlas leaves out: the charts of all else stay, without a warning."""
    real = atlas_module.XATLAS_PROGRAM
    (tmp_path / "child.py").write_text(
        f"import sys\nsys.path.insert(0, {str(real.parent)!r})\nimport xatlas_process\n"
        "unwrap = xatlas_process.unwrap\n"
        "def without(arrays):\n"
        "    found = unwrap(arrays)\n"
        "    found['charts6'] = found['charts6'].copy()\n"
        "    found['charts6'][found['triangles6'][[0, 5]].ravel()] = -1\n"
        "    return found\n"
        "xatlas_process.unwrap = without\nxatlas_process.main()\n"
    )
    meshes = meshes_of("cornell-box")
    whole = unwrap(meshes, 0.05)
    monkeypatch.setattr(atlas_module, "XATLAS_PROGRAM", tmp_path / "child.py")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        atlas = unwrap(meshes, 0.05)
    check(meshes, atlas, 0.05)
    assert atlas.method == "xatlas" and len(np.unique(atlas.meshes[6].charts)) > 1
    np.testing.assert_array_equal(atlas.meshes[0].uvs, whole.meshes[0].uvs)
    # All triangles that share a vertex with those that were left out are left out too; a mesh of them alone is too much.
    monkeypatch.setattr(atlas_module, "MAX_LEFT_OUT", 0.0)
    with pytest.warns(EclatWarning, match="left out"):
        assert unwrap(meshes, 0.05).method == "planar"
