# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Units, axes and origin are nobody's business: scaled, turned and moved scenes give the same pictures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat.scene import PointLight, Scene, SpotLight
from eclat.scenes import build
from support.similarity import Similarity, rotation
from support.statistics import block_means, relative_error, welch

SIZE = (48, 48)
TURN = rotation((1, 2, -0.5), 77)
FAR = 170 * np.array([0.8, 0.5, -0.3])  # a hundred radii of the box

SIZES_AND_PLACES = {
    "in millimetres": Similarity(1000.0),
    "in kilometres": Similarity(0.001),
    "a hundred radii away": Similarity(shift=FAR),
}


@pytest.fixture(scope="module")
def box() -> Scene:
    """The Cornell box with a point and a spot light, whose intensities must follow the scale."""
    point = PointLight((0.5, 0.5, 0.2), (0.3, 0.3, 0.2))
    spot = SpotLight((-0.5, 0.6, 0.5), (0.2, -1, -0.3), (0.8, 0.6, 0.4), 15, 30)
    return replace(build("cornell-box"), lights=(point, spot))


def traced(scene: Scene, seed: int = 0) -> np.ndarray:
    return eclat.render(scene, eclat.Path(), samples=16, size=SIZE, seed=seed).pixels


def cached(scene: Scene) -> tuple[int, np.ndarray]:
    # Adaptive numbers of samples would follow rounding too, and bring noise of 0.2 %.
    solution = eclat.solve(scene, size=SIZE)
    return len(solution), eclat.render(scene, solution, samples=64, size=SIZE, adaptive=False).pixels


@pytest.fixture(scope="module")
def cached_box(box: Scene) -> tuple[int, np.ndarray]:
    return cached(box)


@pytest.mark.parametrize("name", SIZES_AND_PLACES)
def test_paths_do_not_change_when_samples_are_taken_in_parts(box: Scene, name: str) -> None:
    # Rounding differs; a path that it sends past another edge would show as a hundredth.
    assert relative_error(traced(SIZES_AND_PLACES[name].scene(box)), traced(box)) < 1e-3


@pytest.mark.parametrize("power", [-10, 10])
def test_powers_of_two_change_no_bit(box: Scene, cached_box: tuple[int, np.ndarray], power: int) -> None:
    """They change exponents only: no length in the whole renderer is absolute, or it would show here."""
    scaled = Similarity(2.0**power).scene(box)
    np.testing.assert_array_equal(traced(scaled), traced(box))
    records, image = cached(scaled)
    assert records == cached_box[0]
    np.testing.assert_array_equal(image, cached_box[1])


@pytest.mark.parametrize("name", ["turned", "turned, in millimetres, far away"])
def test_turned_paths_have_the_same_mean(box: Scene, name: str) -> None:
    """Tangent frames follow the world's axes, so that single paths differ: only their means may be compared."""
    moved = Similarity(turn=TURN) if name == "turned" else Similarity(1000.0, TURN, 1000 * FAR)
    runs = range(8)
    ours, theirs = (
        np.array([block_means(traced(scene, seed), 16).ravel() for seed in runs]) for scene in (moved.scene(box), box)
    )
    t, limit = welch(ours, theirs)
    assert t < limit
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.01)


@pytest.mark.parametrize("name", [*SIZES_AND_PLACES, "turned"])
def test_the_cache_has_the_same_records_and_picture(box: Scene, cached_box: tuple[int, np.ndarray], name: str) -> None:
    moved = SIZES_AND_PLACES.get(name, Similarity(turn=TURN))
    records, image = cached(moved.scene(box))
    # Axes choose the sectors in which a record's surroundings are known. Rounding decides here and there which of two
    # points gets a record, and the later ones follow; that moves a picture within its own error.
    moved_only = name in SIZES_AND_PLACES
    assert records == pytest.approx(cached_box[0], rel=0.03 if moved_only else 0.05)
    assert image.mean() == pytest.approx(cached_box[1].mean(), rel=0.003)
    ours, theirs = (block_means(x, 4) for x in (image, cached_box[1]))
    assert relative_error(ours, theirs) < (0.002 if moved_only else 0.012)
