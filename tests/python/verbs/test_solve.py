# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What solve promises beside light: what an interrupt leaves, whatever the records are for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import eclat
from eclat.scenes import build

OPTIONS = eclat.IrradianceCache(max_error=0.006)


@pytest.fixture(scope="module")
def cornell() -> eclat.Scene:
    return build("cornell-box")


def interrupt_at(fraction: float) -> Any:
    """A progress report that is Ctrl-C once the solve is that far."""

    def report(phase: str, done: float, statistics: dict[str, float]) -> None:
        assert phase == "solve"
        if done >= fraction:
            raise KeyboardInterrupt

    return report


def interrupted(
    scene: eclat.Scene, fraction: float, options: eclat.IrradianceCache = OPTIONS, **keywords: Any
) -> KeyboardInterrupt:
    with pytest.raises(KeyboardInterrupt) as stop:
        eclat.solve(scene, options, progress=interrupt_at(fraction), **keywords)
    return stop.value


def many_points() -> tuple[np.ndarray, np.ndarray]:
    points = np.random.default_rng(1).uniform(-0.9, 0.9, (4000, 3))
    return points, np.tile([0.0, 1.0, 0.0], (len(points), 1))


# The part of the passes after which records of the view (not only far ones) are there; most of the work comes later.
@pytest.mark.parametrize(
    ("keywords", "fraction", "max_error"),
    [
        ({"size": (128, 128)}, 0.4, 0.006),
        ({"points": many_points()}, 0.6, 0.006),
        ({"view_independent": True}, 0.3, 0.05),
    ],
    ids=["view", "points", "everywhere"],
)
def test_an_interrupt_leaves_the_passes_that_were_finished(
    cornell: eclat.Scene, keywords: dict[str, Any], fraction: float, max_error: float
) -> None:
    """They are the first records of the whole solve; later passes may only clamp their radii."""
    options = eclat.IrradianceCache(max_error=max_error)
    stop = interrupted(cornell, fraction, options, keep_partial=True, **keywords)
    partial = stop.partial  # type: ignore[attr-defined]
    whole = eclat.solve(cornell, options, **keywords)
    assert whole.complete and not partial.complete
    assert 0 < len(partial) < len(whole)
    assert partial.statistics["records"] == len(partial) and partial.statistics["rays"] > 0
    for name in ("positions", "normals", "irradiance"):
        assert np.array_equal(getattr(partial, name), getattr(whole, name)[: len(partial)]), name
    assert (partial.radii >= whole.radii[: len(partial)]).all()


def test_a_partial_solution_renders_the_rest_by_paths(cornell: eclat.Scene) -> None:
    partial = interrupted(cornell, 0.4, keep_partial=True, size=(128, 128)).partial  # type: ignore[attr-defined]
    size = (32, 32)
    with pytest.warns(eclat.EclatWarning, match="this cache is incomplete"):
        image = eclat.render(cornell, partial, samples=64, size=size)
    reference = eclat.render(cornell, eclat.Path(), samples=256, size=size)
    assert image.metadata["statistics"]["cache_misses"] > 0
    assert image.pixels.mean() == pytest.approx(reference.pixels.mean(), rel=0.03)


def test_without_keep_partial_nothing_is_kept(cornell: eclat.Scene) -> None:
    assert not hasattr(interrupted(cornell, 0.4, size=(128, 128)), "partial")


def test_before_the_first_record_there_is_nothing_to_keep(cornell: eclat.Scene) -> None:
    assert not hasattr(interrupted(cornell, 0.0, keep_partial=True, size=(128, 128)), "partial")


def test_threads_below_one_are_refused(cornell: eclat.Scene) -> None:
    with pytest.raises(eclat.EclatError, match="threads"):
        eclat.solve(cornell, threads=-1)
