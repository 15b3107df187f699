# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records of radiance over time: light that changes in proportion is followed within the tolerance, lives are the same
backwards, nothing is gathered twice where nothing changes, and glossy things that move reflect what they should."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.bridge.compiled import fingerprint
from eclat.frames.motion_layers import Moment
from eclat.frames.timeline import Timeline
from eclat.images.image import Image
from eclat.methods.records.lives import lives_of
from eclat.methods.records.moving import LARGEST_CHANGE, MovingSolution, solve_over_time
from eclat.methods.records.radiance_rows import luminances, rows_of
from eclat.methods.work import Times, Work
from eclat.motion.animation import Motion, Pose
from eclat.scene import Material, Mesh, Scene, grey
from eclat.scenes import glossy_box
from eclat.scenes.geometry import box
from eclat.scenes.geometry import mesh as made

SIZE = (32, 24)
METHOD = eclat.RadianceCache(max_error=0.05, far_records=100, far_rows=3, rows=8, least_pixels=2, gloss_rows=8)


FINER = replace(METHOD, far_records=500, far_rows=5, rows=14, gloss_rows=16)
"""With seeds 0 to 3, the light on the plate has a standard deviation of 4 % with it, over time or not."""


def solved(
    scene: Scene, count: int, backwards: bool = False, threads: int = 2, method: eclat.RadianceCache = METHOD
) -> MovingSolution:
    """Solve a scene, whose camera is the first, at the times 0, 1, …"""

    def at(time: float) -> Moment:
        return Moment(scene.at(count - 1 - time if backwards else time), scene.cameras[0])

    times: Times = Timeline(at, map(float, range(count)), SIZE, fingerprint, count).times
    return solve_over_time(method, times, Work(threads=threads))


def dimmed(brightness: Callable[[float], float]) -> Scene:
    """The box with rough metal, under a lamp whose radiance changes."""
    scene = glossy_box.build(0.5)

    def lit(mesh: Mesh, time: float) -> Mesh:
        emission = mesh.material.emission
        if emission is None:
            return mesh
        scaled = replace(emission, constant=tuple(brightness(time) * x for x in emission.constant[:3]))
        return replace(mesh, material=replace(mesh.material, emission=scaled))

    def pose(time: float) -> Pose:
        return Pose({i: lit(mesh, time) for i, mesh in enumerate(scene.meshes)})

    rest = pose(0)
    return replace(scene, meshes=tuple(rest.meshes.values()), animation=Motion(rest, pose, 0, 100, ("lamp",)))


def turning(count: int) -> Scene:
    """The Cornell box, in which a plate of rough metal that leans back turns like a wheel."""
    parameters = {"eta": grey(0), "k": grey(1), "specular_reflectance": grey(0.8), "alpha_u": grey(0.6)}
    scene, metal = eclat.load("cornell-box"), Material("conductor", parameters, "metal")
    plate = made([box((-0.5, -0.5, -0.05), (0.5, 0.5, 0.05))], metal, "plate")
    fixed: dict[Any, Mesh] = dict(enumerate(scene.meshes))
    lean, place = np.array([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]]), np.array([0, -0.1, 0.5])

    def pose(time: float) -> Pose:
        angle = 0.5 * np.pi * time / (count - 1)
        c, s = np.cos(angle), np.sin(angle)
        turned = np.asarray(plate.positions) @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ lean
        return Pose(fixed | {"plate": replace(plate, positions=turned + place)})

    rest = pose(0)
    return replace(scene, meshes=tuple(rest.meshes.values()), animation=Motion(rest, pose, 0, count, ("plate",)))


def light(solution: MovingSolution, time: int) -> np.ndarray:
    """The coefficients of the luminance of all records of radiance at a time."""
    radiance = solution.at(time).radiance
    assert radiance is not None
    return luminances(rows_of(radiance, METHOD.order))


@pytest.mark.parametrize("rate", [0.01, 0.1])
def test_radiance_follows_a_lamp_within_the_tolerance(rate: float) -> None:
    solution = solved(dimmed(lambda time: float(np.exp(rate * time))), 13)
    assert solution.radiance is not None
    assert len(solution.radiance) > 10
    first = light(solution, 0)
    for time in range(13):
        # All light is proportional to that of the lamp.
        exact = first * np.exp(rate * time)
        off = np.linalg.norm(light(solution, time) - exact, axis=1) / np.linalg.norm(exact, axis=1)
        assert off.max() < LARGEST_CHANGE * METHOD.max_error
    lives = np.diff(lives_of(solution.radiance.keyed)[1:], axis=0)
    assert lives.mean() > 4 if rate < 0.05 else lives.mean() < 2


def test_light_that_stays_takes_one_gather_for_each_record() -> None:
    solution = solved(dimmed(lambda time: 1.0), 5)
    count = sum(solution.statistics[name] for name in ("records", "far_records", "radiance_records"))
    assert solution.statistics["gathers"] == count
    np.testing.assert_array_equal(light(solution, 0), light(solution, 4))


def test_time_reversed_gives_the_same_lives_and_radiance() -> None:
    scene = dimmed(lambda time: float(np.exp(0.05 * time)))
    forward, backward = (solved(scene, 9, backwards) for backwards in (False, True))
    assert forward.radiance is not None
    assert backward.radiance is not None
    np.testing.assert_array_equal(forward.radiance.keyed, backward.radiance.keyed[:, ::-1])
    for time in range(9):
        there, back = light(forward, time), light(backward, 8 - time)
        np.testing.assert_allclose(there, back, rtol=1e-4, atol=1e-5 * np.abs(there).max())


@pytest.fixture(scope="module")
def wheel() -> MovingSolution:
    return solved(turning(5), 5, method=FINER)


def test_glossy_things_that_turn_reflect_as_with_a_solution_of_their_own(wheel: MovingSolution) -> None:
    assert wheel.radiance is not None
    assert wheel.radiance.moving.all()
    for time in (0, 2):
        scene = wheel.times.scene(time)
        own = eclat.solve(scene, FINER, camera=0, size=SIZE, threads=2)
        given: dict[str, Any] = {"size": SIZE, "samples": 32, "threads": 2, "denoise": False, "adaptive": False}
        over_time, alone = (eclat.render(scene, source, **given) for source in (wheel.at(time), own))
        cached = over_time.layers["gloss_cached"] > 0.9
        assert cached.mean() > 0.08
        a, b = (image.layers["indirect"][cached].mean(dtype=np.float64) for image in (over_time, alone))
        assert a == pytest.approx(b, rel=0.06)


def test_records_of_radiance_are_the_same_bits_on_any_number_of_threads(wheel: MovingSolution) -> None:
    one = solved(turning(5), 5, threads=1, method=FINER)
    for time in range(5):
        a, b = one.at(time).radiance, wheel.at(time).radiance
        assert a is not None
        assert b is not None
        for name, array in a.arrays().items():
            np.testing.assert_array_equal(array, b.arrays()[name])


def test_frames_of_radiance_caching_share_their_records(tmp_path: Path) -> None:
    given: dict[str, Any] = {"size": (24, 16), "samples": 2, "threads": 2, "fps": 1, "max_error": 0.1}
    files = eclat.animate(turning(3), "radiance-cache", frames=range(3), output=tmp_path / "%d.exr", **given)
    # On the plate, which turns, there are other records in sight in each frame.
    assert min(Image.load(path).metadata["statistics"]["radiance_records"] for path in files) > 0
    found = {Image.load(path).metadata["statistics"]["records"] for path in files}
    assert max(found) - min(found) < 0.2 * max(found)
