# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Estimates of bakes against the bakes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.scene import Material
from eclat.verbs.estimate_bake import extrapolated


def test_an_estimate_is_that_of_the_bake(tmp_path: Path) -> None:
    options = {"texel_size": 0.08, "samples": 32, "max_error": 0.05, "max_size": 64}
    found = eclat.estimate_bake("cornell-box", ktx2=True, **options)
    lightmap = eclat.bake("cornell-box", **options)
    counted = lightmap.statistics
    assert (found.texels, found.charts, found.pages) == tuple(counted[n] for n in ("texels", "charts", "pages"))
    assert lightmap.pages[0].shape == (found.height, found.width, 3) and found.pages > 1
    sizes = [file.stat().st_size for file in lightmap.save(tmp_path / "a.glb", ktx2=True) if file.suffix != ".json"]
    assert found.most_bytes / 4 < sum(sizes) <= found.most_bytes * 1.02 + 2000 * found.pages
    assert 1 / 3 < found.rays / counted["rays"] < 3
    assert found.seconds > 0


def test_a_share_of_the_texels_tells_how_many_are_lit(monkeypatch: pytest.MonkeyPatch) -> None:
    # The box away from all light is dark, and takes a share of the texels that few of them tell.
    lit = eclat.load("cornell-box")
    outside = [np.asarray(mesh.positions) + np.array([10, 0, 0]) for mesh in lit.meshes]
    black = Material("diffuse", name="black")
    away = [replace(mesh, positions=at, material=black) for mesh, at in zip(lit.meshes, outside, strict=True)]
    scene = replace(lit, meshes=(*lit.meshes, *away))
    options = {"texel_size": 0.1, "samples": 4, "max_depth": 3, "threads": 1}
    whole = eclat.estimate_bake(scene, "path", **options)
    monkeypatch.setattr("eclat.verbs.estimate_bake.LOOKED_AT", whole.texels // 4)
    part = eclat.estimate_bake(scene, "path", **options)
    assert part.texels == whole.texels > 2000
    assert part.rays == pytest.approx(whole.rays, rel=0.1)


@pytest.mark.parametrize(("fixed", "power"), [(0.0, 1.0), (1e6, 1.0), (1e5, 0.5), (0.0, 0.8)])
def test_the_growth_of_the_work_is_found(fixed: float, power: float) -> None:
    def rays(count: float) -> float:
        return fixed + 300 * count**power

    numbers = [64, 256, 1024]
    assert extrapolated(numbers, [rays(n) for n in numbers], 500_000) == pytest.approx(rays(500_000), rel=1e-6)


def test_few_texels_are_in_proportion() -> None:
    assert extrapolated([64, 100], [640.0, 1000.0], 100) == 1000
