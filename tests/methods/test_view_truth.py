# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The truth beside the page's picture in headless Chromium: its figure, the border between both, the map of the difference."""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy as np
import pytest
from PIL import Image

import eclat
from eclat import scenes
from eclat.measure.metrics import away_from_edges, relative_rmse
from support.browser import compare_with_truth, require_page

SIZE = (160, 120)
SAMPLES = 128


def picture_of(step: dict[str, Any]) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(step["shot"]))).convert("RGB"), np.float64)


@pytest.mark.slow
def test_the_truth_stands_beside_the_page_and_its_figure_is_the_error() -> None:
    require_page()
    scene = scenes.build("cornell-box")
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.05), size=SIZE, check=False)
    steps = [
        {"set": {"Render this view beside": "paths", "Border between page and truth": 0.25}, "shot": True},
        {"set": {"Light from records": False}, "shot": True},
        {"set": {"Map of the difference": True}, "shot": True},
        {"set": {"Light from records": True, "Render this view beside": "records"}, "shot": True},
    ]
    with eclat.view(scene, solution, texel_size=0.03, samples=64) as viewer:
        answer = compare_with_truth(viewer.url, SIZE, SAMPLES, steps)
    assert answer["messages"] == []
    beside, direct_only, map_of_direct, by_records = answer["steps"]
    assert 0.001 < beside["figures"]["away"] < 0.02
    assert by_records["figures"]["away"] < 0.02
    assert any(f"{100 * beside['figures']['away']:.2f} %" in told for told in beside["told"])

    # Without the light of records the page shows direct light, whose distance from the truth is known from `render`.
    a, b = (eclat.render(scene, eclat.Path(), size=SIZE, samples=SAMPLES, seed=seed) for seed in (1, 2))
    away = away_from_edges(a.layers["depth"], a.layers["normal"])
    for name, mask in (("whole", None), ("away", away)):
        expected = relative_rmse((a.layers["direct"] + b.layers["direct"]) / 2, a.pixels, b.pixels, mask=mask)
        assert direct_only["figures"][name] == pytest.approx(expected, rel=0.05)

    shown, dark = picture_of(beside), picture_of(direct_only)
    border = SIZE[0] // 4
    assert (shown[10:-10, border - 1 : border + 1] > 250).all()
    # To the left of the border is the page, which has lost its light; to the right the truth, which has not.
    left, right = np.s_[:, : border - 2], np.s_[:, border + 2 :]
    assert dark[left].mean() < 0.8 * shown[left].mean()
    assert np.abs(dark[right] - shown[right]).mean() < 5
    # The page is too dark everywhere then: blue. With its light it is right: nearly white.
    blue, white = picture_of(map_of_direct)[20:-20, 20:-20], picture_of(by_records)[20:-20, 20:-20]
    assert (blue[..., 2] > blue[..., 0]).mean() > 0.8
    assert np.median(white) > 235
