# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A picture in two halves: their mean is the picture, they are independent, and each is denoised by what it knows itself."""

from __future__ import annotations

import numpy as np
import pytest

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.images import denoiser
from eclat.sampling.halves import Halves, seed_of_half
from eclat.scenes import build

SIZE = (40, 32)


@pytest.fixture(scope="module")
def halves() -> Halves:
    """Eight samples of the Cornell box in each half, in a crop."""
    scene = build("cornell-box")
    prepared = compiled(scene)
    estimator = _core.path_estimator(prepared.core, max_depth=-1, roulette_depth=5)
    films = []
    for half in (0, 1):
        film = _core.Film(*SIZE)
        where = _core.RenderRange(
            crop=(4, 2, 36, 30), seed=seed_of_half(7, half), threads=1, filter=_core.Filter.box, tile_order=[]
        )
        first, end = np.array([0], np.uint32), np.array([8], np.uint32)
        camera = prepared.camera(scene.cameras[0], SIZE)
        _core.render(camera, film, estimator, where, first, end, _core.Progress())
        films.append(film)
    return Halves(films[0], films[1], (4, 2, 36, 30))


def test_the_picture_is_the_mean_of_both(halves: Halves) -> None:
    mean = (halves.even.radiance + halves.odd.radiance) / 2
    np.testing.assert_allclose(halves.radiance, mean, rtol=1e-6)
    assert not np.array_equal(halves.even.radiance, halves.odd.radiance)
    np.testing.assert_allclose(halves.sampled().pixels, mean[2:30, 4:36], rtol=1e-6)


def test_a_copy_stays_as_it_is(halves: Halves) -> None:
    copy, before = halves.copy(), halves.radiance
    copy.even.interleave(copy.odd)
    np.testing.assert_array_equal(halves.radiance, before)
    assert copy.region == halves.region


def test_pixels_outside_the_region_are_black(halves: Halves) -> None:
    pasted = halves.pasted(np.ones((28, 32)))
    assert pasted.shape == (32, 40) and pasted.sum() == 28 * 32 and pasted[2, 4] == 1 and pasted[1, 4] == 0
    assert halves.pasted(np.ones((28, 32, 3))).shape == (32, 40, 3)


def test_seeds_of_halves() -> None:
    assert seed_of_half(7, 0) == 7
    assert len({seed_of_half(seed, half) for seed in range(100) for half in (0, 1)}) == 200
    assert 0 <= seed_of_half(2**32 - 1, 1) < 2**32


def test_stored_sums_are_continued_bit_for_bit(halves: Halves) -> None:
    film = _core.Film(*SIZE)
    film.restore(halves.even.sums())
    for name in ("radiance", "direct", "albedo", "normal", "rough_albedo", "rough_normal", "depth"):
        np.testing.assert_array_equal(getattr(film, name), getattr(halves.even, name))
    with pytest.raises(ValueError, match="expected 40x32 pixels"):
        film.restore(np.zeros((40, 32, 24), np.float32))


@pytest.mark.skipif(not denoiser.has_denoiser(), reason="pyoidn is not installed")
def test_each_half_is_denoised_without_data_of_the_other(halves: Halves, monkeypatch: pytest.MonkeyPatch) -> None:
    given = []
    monkeypatch.setattr(denoiser, "denoise", lambda *pictures: given.append(pictures) or pictures[0])
    found = halves.denoised()
    assert found.pixels.shape == (28, 32, 3)
    for pictures, film in zip(given, (halves.even, halves.odd), strict=True):
        for picture, own in zip(pictures, (film.radiance, film.rough_albedo, film.rough_normal), strict=True):
            np.testing.assert_array_equal(picture, own[2:30, 4:36])
