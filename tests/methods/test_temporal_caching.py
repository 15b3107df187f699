# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records over time: the closed form of a furnace whose wall changes, lives that are the same backwards, one gather where
nothing changes, records that roll with their surface, and the flicker of frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError
from eclat.images.image import Image
from eclat.methods.records.lives import alive, lives_of
from eclat.methods.records.moving import LARGEST_CHANGE, MovingSolution, solve_over_time
from eclat.methods.work import Work
from eclat.motion.animation import Motion, Pose
from eclat.scene import Scene, grey
from eclat.scenes import build
from support.over_time import BALL, RADIUS, SIZE, rolling, times_of

METHOD = eclat.IrradianceCache(max_error=0.05, far_records=100, far_rows=3, rows=8, least_pixels=2)


def solved(scene: Scene, count: int, backwards: bool = False, threads: int = 2) -> MovingSolution:
    return solve_over_time(METHOD, times_of(scene, count, backwards), Work(threads=threads))


def furnace(brightness: Callable[[float], float]) -> Scene:
    """A furnace whose wall emits a radiance that changes."""
    scene = build("furnace", shape="box")
    wall = scene.meshes[0]

    def pose(time: float) -> Pose:
        return Pose({0: replace(wall, material=replace(wall.material, emission=grey(brightness(time))))})

    rest = pose(0)
    return replace(scene, meshes=tuple(rest.meshes.values()), animation=Motion(rest, pose, 0, 100, ("wall",)))


def wave(time: float) -> float:
    return 1.5 + np.sin(2 * np.pi * time / 24)


def rise(time: float) -> float:
    return float(np.exp(0.1 * time))


@pytest.mark.parametrize("brightness", [wave, rise])
def test_records_follow_the_closed_form_of_a_furnace_within_the_tolerance(
    brightness: Callable[[float], float],
) -> None:
    solution = solved(furnace(brightness), 30)
    worst = 0.0
    for time in range(30):
        records = solution.at(time)
        light = (records.irradiance + records.excess)[:, 1]
        exact = np.pi * brightness(time) * 0.5 / (1 - 0.5)
        assert light.mean(dtype=np.float64) == pytest.approx(exact, rel=0.06)
        # Gathers have the same random numbers at all times, so a record errs by its lives alone.
        alone = (records.irradiance + records.excess)[:, 1] / brightness(time)
        first = solution.at(0)
        alone /= (first.irradiance + first.excess)[:, 1] / brightness(0)
        worst = max(worst, float(np.abs(alone - 1).max()))
    assert worst < LARGEST_CHANGE * METHOD.max_error
    # Lives are as long as the changes allow.
    lives = np.diff(lives_of(solution.near.keyed)[1:], axis=0)
    assert 1 < lives.mean() < 12


def test_a_faster_change_takes_shorter_lives_and_none_takes_one_gather() -> None:
    keys = []
    for rate in (0.0, 0.01, 0.03, 0.3):
        solution = solved(furnace(lambda time, rate=rate: float(np.exp(rate * time))), 13)  # type: ignore[misc]
        keys.append(solution.statistics["gathers"] / (len(solution.near) + len(solution.far)))
    assert keys[0] == 1
    assert 1 < keys[1] <= keys[2] < keys[3] == 13


def test_time_reversed_gives_the_same_lives_and_light() -> None:
    forward, backward = (solved(furnace(rise), 13, backwards) for backwards in (False, True))
    np.testing.assert_array_equal(forward.near.keyed, backward.near.keyed[:, ::-1])
    np.testing.assert_array_equal(forward.far.keyed, backward.far.keyed[:, ::-1])
    for time in range(13):
        np.testing.assert_allclose(forward.at(time).irradiance, backward.at(12 - time).irradiance, rtol=1e-5)


def test_records_are_the_same_bits_on_any_number_of_threads() -> None:
    one, two = (solved(rolling(4), 4, threads=threads) for threads in (1, 2))
    for time in range(4):
        np.testing.assert_array_equal(one.at(time).near, two.at(time).near)
        np.testing.assert_array_equal(one.at(time).far, two.at(time).far)


@pytest.fixture(scope="module")
def ball() -> MovingSolution:
    return solved(rolling(13), 13)


def test_records_roll_with_the_surface_that_they_are_on(ball: MovingSolution) -> None:
    on_ball = ball.near.anchors.meshes == BALL
    assert on_ball.sum() > 5
    assert ball.times.moving_meshes == (BALL,)
    for time in (0, 6, 12):
        posed = ball.near.anchors.taken(on_ball).posed(ball.times.scene(time))
        center = ball.times.scene(time).meshes[BALL].positions.mean(axis=0)
        np.testing.assert_allclose(np.linalg.norm(posed.positions - center, axis=1), RADIUS, rtol=0.05)
        records = ball.at(time)
        living = alive(ball.near.keyed, time)
        assert len(records.near) == len(living)
        assert (~on_ball).sum() < len(living) < len(ball.near)
        there = on_ball[living]
        np.testing.assert_allclose(
            records.positions[there], posed.positions[np.isin(np.nonzero(on_ball)[0], living)], atol=1e-6
        )
        # Gradients of irradiance lie in the surface, also after it has turned.
        gradients = records.translation_gradients[there].astype(np.float64)
        along = np.einsum("nci,ni->nc", gradients, records.normals[there])
        assert np.abs(along).max() <= 1e-3 * np.linalg.norm(gradients, axis=2).max()


def test_the_light_of_a_time_is_that_of_its_own_solution(ball: MovingSolution) -> None:
    for time in (0, 5, 12):
        scene = ball.times.scene(time)
        own = eclat.solve(scene, METHOD, camera=0, size=SIZE, threads=2)
        given: dict[str, Any] = {"size": SIZE, "samples": 64, "threads": 2, "denoise": False, "adaptive": False}
        a, b = (eclat.render(scene, source, **given).pixels for source in (ball.at(time), own))
        assert np.mean(a, dtype=np.float64) == pytest.approx(np.mean(b, dtype=np.float64), rel=0.01)
        assert np.sqrt(np.mean((a - b) ** 2)) < 0.05 * np.mean(b)


def test_lives_of_a_ball_take_fewer_gathers_than_a_cache_for_each_time(ball: MovingSolution) -> None:
    fresh = eclat.solve(ball.times.scene(6), METHOD, camera=0, size=SIZE, threads=2)
    assert ball.statistics["rays"] < 0.75 * 13 * fresh.statistics["rays"]
    # Records that the ball passes have shorter lives than those that it does not.
    keys = ball.near.keyed.sum(axis=1)
    assert keys.min() < keys.max()


def test_frames_over_time_are_the_same_files_in_any_order(tmp_path: Path) -> None:
    given: dict[str, Any] = {"size": (24, 16), "samples": 4, "threads": 2, "fps": 1, "max_error": 0.1}
    whole = eclat.animate(rolling(4), frames=range(4), output=tmp_path / "a" / "%d.exr", **given)
    for shard in ((2, 2), (1, 2)):
        few = given | {"threads": 1}
        eclat.animate(rolling(4), frames=range(4), output=tmp_path / "b" / "%d.exr", shard=shard, **few)
    for path in whole:
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()
    # The records are the same in all frames, but for those of the ball that are out of sight in some of them.
    counts = [Image.load(path).metadata["statistics"]["records"] for path in whole]
    assert max(counts) - min(counts) < 0.1 * max(counts)
    # What a frame shows depends on all frames, because they share their records.
    with pytest.raises(EclatError, match="another scene or with other settings"):
        eclat.animate(rolling(4), frames=range(3), output=tmp_path / "a" / "%d.exr", **given)


def test_frames_flicker_less_than_those_of_caches_of_their_own(ball: MovingSolution) -> None:
    given: dict[str, Any] = {"size": SIZE, "samples": 16, "threads": 2, "denoise": False, "adaptive": False}
    pictures: dict[str, list[np.ndarray]] = {"over time": [], "anew": []}
    for time in range(4, 10):
        scene = ball.times.scene(time)
        own = eclat.solve(scene, METHOD, camera=0, size=SIZE, threads=2)
        for name, source in (("over time", ball.at(time)), ("anew", own)):
            pictures[name].append(eclat.render(scene, source, **given).pixels.mean(axis=2))
    far_away = np.s_[: SIZE[1] // 2]  # The ball is on the floor; the upper half of the picture stays nearly the same.
    flicker = {
        name: float(np.median(np.std(found, axis=0)[far_away]) / np.mean(found)) for name, found in pictures.items()
    }
    assert flicker["over time"] < 0.005
    assert flicker["over time"] < flicker["anew"]
