# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras of Blender, and views of its viewports, as Éclat's."""

import math

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat_blender.camera import scene_camera, view_camera
from eclat_blender.notices import Notices
from support.blender_standins import camera_data


@pytest.mark.parametrize(
    ("fit", "size", "axis", "sensor"),
    [
        ("AUTO", (20, 10), "x", 36), ("AUTO", (10, 20), "y", 36), ("HORIZONTAL", (10, 20), "x", 36),
        ("VERTICAL", (20, 10), "y", 24),
    ],
)  # fmt: skip
def test_the_sensor_fills_the_side_that_it_is_fitted_to(fit, size, axis, sensor):
    made = scene_camera(camera_data(sensor_fit=fit, lens=30.0), np.eye(4), size, Notices())
    assert made.fov_axis == axis and math.tan(math.radians(made.fov) / 2) == pytest.approx(sensor / 60)


def test_the_aperture_is_the_focal_length_over_the_f_number():
    data = camera_data()
    data.dof.use_dof, data.dof.aperture_fstop = True, 2.5
    made = scene_camera(data, np.diag((2.0, 2.0, 2.0, 1.0)), (20, 10), Notices())
    assert made.aperture_radius == pytest.approx(0.01) and made.focus_distance == 5
    assert np.allclose(made.to_world, np.eye(4))  # The scale of a camera does not matter.


def test_a_panorama_is_refused():
    with pytest.raises(EclatError, match="expected a perspective or orthographic camera, got pano"):
        scene_camera(camera_data(type="PANO"), np.eye(4), (4, 4), Notices())


def _seen(camera, point, size):
    """Where a point is in the picture, in fractions from its top left, by the definition of `eclat.scene.Camera`."""
    eye = np.linalg.inv(camera.to_world) @ (*point, 1)
    half = camera.half_extent(size[0] / size[1])
    depth = 1.0 if camera.projection == "orthographic" else -eye[2]
    x = (eye[0] / depth / half[0] + 1) / 2 - camera.shift[0]
    y = (1 - eye[1] / depth / half[1]) / 2 - camera.shift[1]
    return x, y


@pytest.mark.parametrize("perspective", [True, False])
def test_a_viewport_sees_points_where_its_matrices_put_them(perspective):
    near, far, wide, high, right, up = 0.1, 100.0, 0.8, 0.5, 0.06, -0.03
    if perspective:
        reach = near
        window = np.array([
            (2 * reach / wide, 0, 2 * right / wide, 0), (0, 2 * reach / high, 2 * up / high, 0),
            (0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)), (0, 0, -1, 0),
        ])  # fmt: skip
    else:
        near = -far  # Blender shows what is behind the eye, too.
        window = np.array([
            (2 / wide, 0, 0, -2 * right / wide), (0, 2 / high, 0, -2 * up / high),
            (0, 0, -2 / (far - near), -(far + near) / (far - near)), (0, 0, 0, 1),
        ])  # fmt: skip
    view = np.eye(4)
    view[:3, :3] = [(0, 1, 0), (0, 0, 1), (1, 0, 0)]
    view[:3, 3] = (0.1, -0.2, -3)
    size = (80, 50)
    camera = view_camera(view, window, size)
    for point in ((0.0, 0.0, 0.0), (0.3, -0.1, 0.2)):
        clip = window @ view @ (*point, 1)
        clip = clip / clip[3]
        assert np.allclose(_seen(camera, point, size), ((1 + clip[0]) / 2, (1 - clip[1]) / 2))
    if not perspective:
        assert (np.linalg.inv(camera.to_world) @ (0, 0, 0, 1))[2] == pytest.approx(-3 - far)
