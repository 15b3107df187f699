# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What cameras see of a small bright rectangle: where it falls in the picture, and how a lens blurs it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, FloatArray, Material, Mesh, Scene, grey, look_at
from support.statistics import block_means, welch

EYE, TARGET, UP = (1.0, -2.0, 0.5), (2.0, 3.0, 1.5), (0.1, 0.2, 1.0)
GLOW = Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(1.0), emission_two_sided=True)


def scene_with(camera: Camera, x: tuple[float, float], y: tuple[float, float], depth: float) -> Scene:
    """A rectangle that shines 1, given in the camera's frame (x to the right, y up, `depth` ahead)."""
    corners = np.array([[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])
    matrix = np.asarray(camera.to_world)
    positions = matrix[:3, 3] + corners @ matrix[:3, :2].T - depth * matrix[:3, 2]
    return Scene((Mesh(positions, np.array([[0, 1, 2], [0, 2, 3]]), GLOW),), (), None, (camera,))


def coverage(low: float, high: float, pixels: int) -> FloatArray:
    """How much of each of `pixels` unit intervals lies between `low` and `high`."""
    edges = np.clip(np.arange(pixels + 1), low, high)
    return np.diff(edges)


def check_place(camera: Camera, half_height: float, depth: float) -> None:
    """A rectangle at `depth`, where the picture is 2 `half_height` high, covers each pixel as it should."""
    width, height = 24, 12
    # In units of half the picture's height; y upwards.
    x, y = np.array([-0.83, 0.36]), np.array([-0.37, 0.61])
    scene = scene_with(camera, tuple(x * half_height), tuple(y * half_height), depth)
    image = eclat.render(scene, eclat.Direct(), samples=1024, size=(width, height)).pixels[:, :, 0]
    column = width * (0.5 - camera.shift[0]) + x * height / 2
    row = height * (0.5 - camera.shift[1]) - y[::-1] * height / 2
    expected = coverage(*row, height)[:, None] * coverage(*column, width)
    np.testing.assert_allclose(image, expected, atol=0.01)


# Half the height of the picture, in metres ahead of the camera at depth 1 (perspective) or at any (orthographic).
@pytest.mark.parametrize(
    ("settings", "half_height"),
    [
        ({"fov": 2.0, "projection": "orthographic"}, 1.0),
        ({"fov": 3.0, "projection": "orthographic", "fov_axis": "x"}, 0.75),
        ({"fov": 40.0}, np.tan(np.radians(20))),
        ({"fov": 40.0, "fov_axis": "x"}, np.tan(np.radians(20)) / 2),
        ({"fov": 50.0, "fov_axis": "larger", "shift": (0.1, -0.05)}, np.tan(np.radians(25)) / 2),
        ({"fov": 50.0, "fov_axis": "diagonal"}, np.tan(np.radians(25)) / np.sqrt(5)),
    ],
)
@pytest.mark.parametrize("depth", [0.7, 5.0])
def test_a_rectangle_falls_where_projection_puts_it(settings: dict, half_height: float, depth: float) -> None:
    camera = Camera(look_at(EYE, TARGET, UP), **settings)
    check_place(camera, half_height if camera.projection == "orthographic" else half_height * depth, depth)


def test_objects_in_focus_are_as_sharp_as_with_a_pinhole() -> None:
    camera = Camera(look_at(EYE, TARGET, UP), fov=40.0, aperture_radius=0.3, focus_distance=3.0)
    check_place(camera, 3 * float(np.tan(np.radians(20))), 3.0)


@pytest.mark.parametrize(("depth", "focus"), [(2.0, 4.0), (6.0, 3.0)], ids=["before the focus", "behind it"])
def test_a_lens_spreads_a_point_over_its_circle_of_confusion(depth: float, focus: float) -> None:
    """At distance 1 the image of a point is a disc of radius r = aperture · |1 / focus − 1 / depth|, evenly bright."""
    aperture, size, fov = 0.25, 64, 30.0
    camera = Camera(look_at(EYE, TARGET, UP), fov=fov, aperture_radius=aperture, focus_distance=focus)
    half = 0.008 * depth  # of the bright square, small beside the disc
    middle = np.array([0.05, -0.08]) * depth
    scene = scene_with(camera, (middle[0] - half, middle[0] + half), (middle[1] - half, middle[1] + half), depth)
    image = eclat.render(scene, eclat.Direct(), samples=512, size=(size, size)).pixels[:, :, 0].astype(np.float64)

    pixel = 2 * np.tan(np.radians(fov / 2)) / size
    place = ((np.arange(size) + 0.5) - size / 2) * pixel
    x, y = np.meshgrid(place, -place)
    square = half / depth
    radius = aperture * abs(1 / focus - 1 / depth)
    total = image.sum()
    # A lens moves light about but loses none.
    assert total * pixel**2 == pytest.approx((2 * square) ** 2, rel=0.02)
    dx, dy = x - middle[0] / depth, y - middle[1] / depth
    for d in (dx, dy):
        assert (image * d).sum() / total == pytest.approx(0, abs=0.04 * radius + 0.1 * pixel)
    # Variances add up: of a disc r² / 4 per axis, of the square a third of its half side's square, of a pixel 1 / 12.
    expected = radius**2 / 4 + square**2 / 3 + pixel**2 / 12
    for d in (dx, dy):
        assert (image * d**2).sum() / total == pytest.approx(expected, abs=0.05 * expected + 0.1 * pixel**2)
    away = np.hypot(dx, dy)
    assert image[away > radius + 1.5 * square + pixel].sum() == 0
    inner = image[away < radius - 1.5 * square - pixel]
    even = (2 * square) ** 2 / (np.pi * radius**2)
    assert inner.mean() == pytest.approx(even, rel=0.03)
    assert inner.std() < 0.35 * even  # noise of 512 samples, no rings


def test_a_lens_blurs_as_in_mitsuba() -> None:
    mi = pytest.importorskip("mitsuba", reason="Mitsuba 3 is the oracle of this test: pip install 'eclat[test]'")
    mi.set_variant("scalar_rgb")
    t, size = mi.ScalarTransform4f(), 24
    near, far = ({"type": "area", "radiance": {"type": "rgb", "value": v}} for v in ([2, 1, 0.5], [0.3, 0.6, 1]))
    description = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 1},
        "sensor": {
            "type": "thinlens", "fov": 40, "aperture_radius": 0.2, "focus_distance": 4.0,
            "to_world": t.look_at(origin=[0.3, -0.5, 5], target=[0, 0, 0], up=[0.2, 1, 0]),
            "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent"},
        },
        "near": {"type": "rectangle", "to_world": t.translate([0.6, 0.3, 2.5]).scale(0.3), "emitter": near},
        "far": {"type": "rectangle", "to_world": t.translate([-0.5, 0.2, -4]).scale(2), "emitter": far},
    }  # fmt: skip
    scene, ours_scene = mi.load_dict(description), eclat.load_dict(description)

    def ours(seed: int, of: Scene = ours_scene) -> FloatArray:
        image = eclat.render(of, eclat.Direct(), samples=128, size=(size, size), seed=seed).pixels
        return block_means(image, 4).ravel()

    def theirs(seed: int) -> FloatArray:
        return block_means(np.array(mi.render(scene, spp=128, seed=seed)), 4).ravel()

    runs = range(6)
    t_value, limit = welch(np.array([ours(run) for run in runs]), np.array([theirs(run) for run in runs]))
    assert t_value < limit
    # The lens shows: a pinhole's picture is another.
    (camera,) = ours_scene.cameras
    sharp = replace(ours_scene, cameras=(replace(camera, aperture_radius=0.0),))
    assert np.abs(ours(0, sharp) - theirs(0)).max() > 0.05
