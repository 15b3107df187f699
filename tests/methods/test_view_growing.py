# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The page of `eclat view` in headless Chromium while its records grow: it asks, says so, and shows what paths show."""

from __future__ import annotations

import base64
import json
import subprocess
from typing import Any

import numpy as np
import pytest

import eclat
from eclat import scenes
from eclat.measure.metrics import away_from_edges, relative_rmse
from eclat.scenes import glossy_box
from support.browser import WEB, require_browser, require_node, require_page

SIZE = (160, 120)


def watched(viewer: eclat.Viewer) -> dict[str, Any]:
    """Open the page and wait until its records have grown; web/tests/view-live.mjs says what is returned."""
    request = {"page": viewer.url, "width": SIZE[0], "height": SIZE[1]}
    run = subprocess.run(
        [require_node(), str(WEB / "tests/view-live.mjs"), require_browser()],
        input=json.dumps(request),
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    answer: dict[str, Any] = json.loads(run.stdout)
    floats = np.frombuffer(base64.b64decode(answer["picture"]), np.float32)
    return answer | {"picture": floats.reshape(SIZE[1], SIZE[0], 4)[::-1, :, :3]}


@pytest.mark.slow
def test_radiance_is_solved_while_one_looks() -> None:
    require_node(), require_browser(), require_page()
    scene = glossy_box.build(alpha=0.4)
    with eclat.view(scene, eclat.RadianceCache(max_error=0.1), texel_size=0.03, samples=64) as viewer:
        answer = watched(viewer)
        solution = viewer.solution
    assert answer["message"] == "" and answer["messages"] == []
    assert solution.radiance is not None
    assert 0 < answer["radiance"] <= len(solution.radiance) and answer["begun"] < answer["records"]
    a, b = (eclat.render(scene, solution, size=SIZE, samples=64, seed=seed) for seed in (5, 6))
    cached = (a.layers["gloss_cached"] > 0.99) & away_from_edges(a.layers["depth"], a.layers["normal"])
    assert cached.mean() > 0.05
    assert relative_rmse(answer["picture"], a.pixels, b.pixels, mask=cached) < 0.06


@pytest.mark.slow
def test_a_view_without_records_is_solved_while_one_looks() -> None:
    require_node(), require_browser(), require_page()
    scene = scenes.build("cornell-box")
    with eclat.view(scene, eclat.IrradianceCache(max_error=0.05), texel_size=0.03, samples=64) as viewer:
        answer = watched(viewer)
        solution = viewer.solution
        origin = viewer.url[: viewer.url.index("/", 8)]
    assert answer["message"] == ""
    assert "being computed" in answer["told"][0]
    assert answer["begun"] < answer["records"] == int((~solution.enclosed).sum())
    assert all(address.startswith((origin, "blob:", "data:")) for address in answer["requests"])
    a, b = (eclat.render(scene, eclat.Path(), size=SIZE, samples=64, seed=seed) for seed in (5, 6))
    away = away_from_edges(a.layers["depth"], a.layers["normal"])
    matte = away & (a.layers["albedo"].max(axis=2) > 0) & (a.pixels.max(axis=2) < 5)
    assert relative_rmse(answer["picture"], a.pixels, b.pixels, mask=matte) < 0.06
