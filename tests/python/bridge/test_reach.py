# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Coordinates that float32 cannot square are refused wherever they enter, and those that it can are right."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, Mesh, PointLight, Scene, SpotLight
from eclat.scenes import build
from support.similarity import Similarity


@pytest.fixture(scope="module")
def cornell() -> Scene:
    return build("cornell-box")


def picture(scene: Scene, camera: int | Camera = 0) -> np.ndarray:
    return eclat.render(scene, eclat.Path(), camera=camera, size=(8, 8), samples=4).pixels


def with_stray(scene: Scene, place: float) -> Scene:
    """A triangle far out; the room stays where it is."""
    mesh = scene.meshes[0]
    far = np.array([[place, 0, 0], [place, 1, 0], [place, 0, 1]])
    return replace(scene, meshes=(*scene.meshes, Mesh(far, np.array([[0, 1, 2]]), mesh.material, name="stray")))


def with_camera(scene: Scene, **changes: object) -> Scene:
    camera = scene.cameras[0]
    if "to_world" in changes:
        matrix = np.array(camera.to_world, np.float64)
        matrix[0, 3] = changes["to_world"]
        changes = {"to_world": matrix}
    return replace(scene, cameras=(replace(camera, **changes),))


LIGHT = (1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: with_stray(s, 1e20), r"mesh \d+ 'stray': position 0 is too far away"),
        (lambda s: with_camera(s, to_world=1e20), "camera .*: position is too far away"),
        (lambda s: with_camera(s, to_world=-1e300), "camera .*: position is too far away"),
        (lambda s: with_camera(s, aperture_radius=1e20), "aperture_radius must be finite and within"),
        (lambda s: with_camera(s, aperture_radius=1.0, focus_distance=1e25), "focus_distance must be finite"),
        (lambda s: with_camera(s, projection="orthographic", fov=1e30), "the picture's extent"),
        (lambda s: with_camera(s, shift=(1e25, 0.0)), "the picture's extent"),
        (lambda s: replace(s, lights=(PointLight((0, 1e19, 0), LIGHT),)), "light 0: position is too far away"),
        (
            lambda s: replace(s, lights=(SpotLight((0, 0, -1e38), (0, 0, 1), LIGHT, 10, 20),)),
            "light 0: position is too far away",
        ),
        (lambda s: Similarity(scale=1e12).scene(s), "triangle 0 is too large: expected an area up to"),
    ],
)
def test_positions_that_are_too_far_away_are_refused(
    cornell: Scene, change: Callable[[Scene], Scene], message: str
) -> None:
    with pytest.raises(eclat.EclatError, match=message) as caught:
        picture(change(cornell))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("place", [1e19, -1e30, 1e300])
def test_points_too_far_away_are_refused(cornell: Scene, place: float) -> None:
    points, normals = [[0.0, 0.0, 0.0], [0.0, place, 0.0]], [[0.0, 1.0, 0.0]] * 2
    with pytest.raises(eclat.EclatError, match="points: point 1 is too far away"):
        eclat.irradiance(cornell, points, normals, eclat.Path(), samples=4)
    with pytest.raises(eclat.EclatError, match="points: point 1 is too far away"):
        eclat.solve(cornell, eclat.IrradianceCache(), points=(np.array(points), np.array(normals)))


def test_a_room_of_a_million_kilometres_looks_like_a_small_one(cornell: Scene) -> None:
    np.testing.assert_allclose(picture(Similarity(scale=1e9).scene(cornell)), picture(cornell), rtol=0.02, atol=1e-3)
