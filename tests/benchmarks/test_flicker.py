# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The arithmetic of the benchmark of flicker, and its scenes."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.images.image import Image
from flicker import Truth
from harness.moving_scenes import FRAMES, with_ball, with_swinging_lamp, with_walk

H, W, COUNT = 40, 60, 6
STATIC = [np.ones((H, W), np.bool_) for _ in range(COUNT - 1)]


def noise(seed: int, deviation: float) -> np.ndarray:
    return np.asarray(np.random.default_rng(seed).normal(0, deviation, (H, W, 3)))


def truth(brightness: list[float]) -> Truth:
    """References of a plane whose light changes; each has the same noise in all frames."""
    normals = np.broadcast_to(np.array([0, 0, 1], np.float32), (H, W, 3))
    guide = Image(np.ones((H, W, 3), np.float32), {"normal": normals, "depth": np.full((H, W), 2, np.float32)}, {})
    rest = {(i, k): np.zeros((H, W, 3), np.float32) for i in range(COUNT) for k in range(COUNT)}
    a, b = ([b + noise(seed, 0.05) for b in brightness] for seed in (1, 2))
    return Truth(a, b, STATIC, [np.ones((H, W), np.float32)] * COUNT, [guide] * COUNT, rest, 1.0)


def test_what_changes_as_the_reference_does_has_no_flicker_whatever_its_noise() -> None:
    brightness = [1.0, 1.1, 1.2, 1.1, 1.0, 0.9]
    assert truth(brightness).flicker([b + noise(3, 0.2) for b in brightness]) < 1e-6


def test_new_noise_flickers_by_its_deviation() -> None:
    exact = truth([1.0] * COUNT)
    assert exact.flicker([1 + noise(10 + i, 0.02) for i in range(COUNT)]) == pytest.approx(0.02 * 2**0.5, rel=0.05)
    # Light that the reference does not have comes and goes.
    assert exact.flicker([1 + 0.03 * (i % 2) + noise(3, 0.2) for i in range(COUNT)]) == pytest.approx(0.03, rel=0.01)


def test_the_error_is_free_of_the_noise_of_the_references() -> None:
    found = truth([1.0] * COUNT).error([1.04 + noise(3, 0.0) for _ in range(COUNT)])
    assert found == pytest.approx(0.04 / 1.01**0.5, rel=0.1)


def test_the_scenes_move() -> None:
    ball = with_ball(eclat.load("cornell-box"))
    places = [ball.at(float(t)).meshes[-1].positions.mean(axis=0)[0] for t in (0, FRAMES - 1)]
    assert places == pytest.approx([-0.8, 0.8], abs=0.01)
    lamp = with_swinging_lamp(eclat.load("cornell-box"))
    first, middle, last = (lamp.at(t).meshes[-1].positions.mean(axis=0) for t in (0.0, (FRAMES - 1) / 2, FRAMES - 1.0))
    np.testing.assert_allclose(first, last, atol=1e-6)
    assert middle[0] < first[0] - 1
    walk = with_walk(eclat.load("cornell-box"))
    start, end = (np.asarray(walk.at(t).cameras[0].to_world)[:3, 3] for t in (0.0, FRAMES - 1.0))
    assert np.linalg.norm(end - start) == pytest.approx(np.hypot(0.8, 0.3), rel=0.01)
