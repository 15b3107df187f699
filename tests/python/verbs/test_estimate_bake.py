# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Estimates of bakes against the bakes."""

from __future__ import annotations

from pathlib import Path

import pytest

import eclat
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


@pytest.mark.parametrize(("fixed", "power"), [(0.0, 1.0), (1e6, 1.0), (1e5, 0.5), (0.0, 0.8)])
def test_the_growth_of_the_work_is_found(fixed: float, power: float) -> None:
    def rays(count: float) -> float:
        return fixed + 300 * count**power

    numbers = [64, 256, 1024]
    assert extrapolated(numbers, [rays(n) for n in numbers], 500_000) == pytest.approx(rays(500_000), rel=1e-6)


def test_few_texels_are_in_proportion() -> None:
    assert extrapolated([64, 100], [640.0, 1000.0], 100) == 1000
