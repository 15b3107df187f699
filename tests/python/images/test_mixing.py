# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mixing the light of finished pictures."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.images.image import Image
from eclat.images.mixing import groups_of, weight_of


def picture() -> Image:
    random = np.random.default_rng(3)
    lamp, sky = (random.random((4, 5, 3), dtype=np.float32) for _ in range(2))
    layers = {"light.lamp": lamp, "light.my sky": sky, "depth": np.ones((4, 5), np.float32), "direct": lamp}
    return Image(lamp + sky, layers, {"seed": 4, "statistics": {"samples": 3.0}})


def test_a_mix_is_the_weighted_sum() -> None:
    before = picture()
    lamp, sky = groups_of(before).values()
    after = eclat.mix(before, {"lamp": 0.3, "my sky": (1, 0.5, 0)})
    np.testing.assert_allclose(after.pixels, 0.3 * lamp + sky * (1, 0.5, 0), rtol=1e-6)
    np.testing.assert_array_equal(sum(groups_of(after).values()), after.pixels)
    assert set(after.layers) == {"depth", "light.lamp", "light.my sky"} and "statistics" not in after.metadata
    again = eclat.mix(after, {"lamp": 1 / 0.3})
    np.testing.assert_allclose(again.layers["light.lamp"], lamp, rtol=1e-6)


def test_weights_as_text() -> None:
    np.testing.assert_allclose(weight_of("0.3"), [0.3] * 3)
    np.testing.assert_allclose(weight_of("#ff8000"), [1, 0.2158605, 0], atol=1e-6)  # sRGB 128 is 21.6 % of the light
    np.testing.assert_allclose(weight_of("2,#FF8000"), [2, 0.431721, 0], atol=1e-6)


@pytest.mark.parametrize("weight", ["red", "", "#ff80", "-1", -0.5, float("nan"), float("inf"), (1, 2), None, "nan"])
def test_weights_that_are_none(weight: object) -> None:
    with pytest.raises(eclat.EclatError, match="mix, lamp: expected a factor of at least 0"):
        eclat.mix(picture(), {"lamp": weight})  # type: ignore[dict-item]


def test_pictures_and_names_that_cannot_be_mixed() -> None:
    with pytest.raises(eclat.EclatError, match="expected a picture that was rendered with light_groups"):
        eclat.mix(Image(np.ones((2, 2, 3), np.float32)), {})
    with pytest.raises(
        eclat.EclatError, match="expected one of the groups lamp, my sky, got 'lamb'; did you mean 'lamp'"
    ):
        eclat.mix(picture(), {"lamb": 1})
