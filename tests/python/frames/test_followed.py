# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Other frames at the places that one frame shows."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.frames.followed import Look, accumulated, followed

H, W = 4, 6


def look(radiance: np.ndarray, depth: float = 2.0, number: float = 1.0) -> Look:
    normals = np.zeros((H, W, 3))
    normals[..., 2] = 1
    return Look(radiance, np.full((H, W), number), normals, np.full((H, W), depth))


def noise(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).random((H, W, 3))


def moved(x: float, y: float = 0.0, farther: float = 0.0) -> np.ndarray:
    return np.broadcast_to(np.array([x, y, farther]), (H, W, 3))


def test_what_rests_is_found_in_its_own_pixel() -> None:
    there = noise(1)
    found, share = followed(look(noise(0)), look(there), moved(0))
    np.testing.assert_array_equal(found, there)
    np.testing.assert_array_equal(share, 1)


def test_what_moves_is_found_where_it_is_then_between_pixels() -> None:
    there = noise(1)
    found, share = followed(look(noise(0)), look(there), moved(1.25, -1))
    np.testing.assert_allclose(found[1:, :-2], 0.75 * there[:-1, 1:-1] + 0.25 * there[:-1, 2:])
    np.testing.assert_allclose(share[1:, :-2], 1)
    assert (share[0] == 0).all()  # It has left the picture.
    np.testing.assert_allclose(share[1:, -2], 0.75)


def test_other_objects_depths_and_normals_are_left_out() -> None:
    here = look(noise(0))
    turned = look(noise(1))
    turned.normals[...] = [1, 0, 0]
    for there, motion in (
        (look(noise(1), number=2), moved(0)), (look(noise(1), depth=2.1), moved(0)), (turned, moved(0)),
        (look(noise(1)), moved(0, 0, 0.1)),
    ):  # fmt: skip
        assert (followed(here, there, motion)[1] == 0).all()
        np.testing.assert_allclose(accumulated(here, [(there, motion)]), here.radiance, rtol=1e-6)
    assert (followed(here, look(noise(1), depth=2.1), moved(0, 0, 0.1))[1] == 1).all()
    # The background has neither depth nor normal.
    sky = Look(noise(1), np.zeros((H, W)), np.zeros((H, W, 3)), np.full((H, W), np.inf))
    assert (followed(sky, sky, moved(0))[1] == 1).all()


def test_the_mean_of_frames_has_less_noise() -> None:
    frames = [look(noise(seed)) for seed in range(5)]
    mean = accumulated(frames[2], [(frames[k], moved(0)) for k in (0, 1, 3, 4)])
    np.testing.assert_allclose(mean, np.mean([frame.radiance for frame in frames], axis=0), rtol=1e-6)
    assert mean.std() == pytest.approx(noise(0).std() / 5**0.5, rel=0.2)
