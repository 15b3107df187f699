# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Where records appear in the picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat.images.image import RECORD_MARK, Image
from eclat.images.record_overlay import project, record_density
from eclat.scene import Camera, look_at

CAMERA = Camera(look_at((0, 0, 4), (0, 0, 0)), fov=90.0, fov_axis="y")
SIZE = (80, 40)


def test_rays_go_through_the_middle_and_the_corners() -> None:
    points = np.array([[0.0, 0, 0], [-8, 4, 0], [8, -4, 0]])
    raster, distance = project(CAMERA, points, SIZE)
    np.testing.assert_allclose(raster, [[40, 20], [0, 0], [80, 40]], atol=1e-9)
    np.testing.assert_allclose(distance, [4, np.sqrt(96), np.sqrt(96)])


def test_points_behind_the_camera_are_not_projected() -> None:
    raster, distance = project(CAMERA, np.array([[0.0, 0, 5]]), SIZE)
    assert np.isnan(raster).all() and np.isnan(distance).all()


def test_orthographic_and_shifted() -> None:
    camera = Camera(CAMERA.to_world, fov=2.0, projection="orthographic", shift=(0.25, -0.5))
    raster, distance = project(camera, np.array([[1.0, 1.0, 0]]), SIZE)
    np.testing.assert_allclose(raster, [[60 - 20, 0 + 20]], atol=1e-9)
    assert distance == pytest.approx([4.0])


def picture(depth: float) -> Image:
    return Image(np.zeros((40, 80, 3), np.float32), {"depth": np.full((40, 80), depth, np.float32)})


def test_hidden_records_are_not_counted() -> None:
    points = np.array([[0.01, -0.01, 0], [0.01, -0.01, 0], [0.01, -0.01, -2], [100, 0, 0]])
    density = record_density(picture(4.0), CAMERA, points)
    assert density[20, 40] == 2 and density.sum() == 2
    assert record_density(picture(np.inf), CAMERA, points).sum() == 3


def with_records(image: Image, *points: tuple[float, float, float]) -> Image:
    return replace(image, layers={**image.layers, "record_density": record_density(image, CAMERA, np.array(points))})


def test_marks_show_at_the_exposure_asked_for() -> None:
    marked = with_records(picture(4.0), (0.01, -0.01, 0)).show_records(exposure=2.0)
    assert marked.pixels[20, 40] == pytest.approx(0.25 * np.array(RECORD_MARK))
    assert np.count_nonzero(marked.pixels.any(axis=2)) == 1
    assert marked.layers["record_density"][20, 40] == 1


def test_marks_grow_with_the_picture() -> None:
    large = with_records(Image(np.zeros((1600, 3200, 3), np.float32)), (0, 0, 0))
    assert np.count_nonzero(large.show_records().pixels.any(axis=2)) == 9


def test_without_records_there_are_no_marks() -> None:
    marked = with_records(picture(4.0), (0, 0, 5)).show_records()
    assert not marked.pixels.any() and not marked.layers["record_density"].any()


def test_marking_records_of_a_picture_without_records_is_refused() -> None:
    with pytest.raises(EclatError, match="expected an image with the layer 'record_density'"):
        picture(4.0).show_records()
