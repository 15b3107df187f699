# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Lamps over a window in the ceiling of a room, sheets in the window, and methods, each against `path` by z-tests of seeds."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import eclat
from eclat import _core
from eclat.light_sources import PointLight
from eclat.methods import Method
from eclat.methods.records.laws import core_options
from eclat.scene import Camera, Material, Mesh, Scene, grey, look_at
from eclat.scenes.geometry import box

GREY = Material("diffuse", {"reflectance": grey(0.5)})
GLOW = Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(20.0), two_sided=False)
CURTAIN = Material("translucent", {"reflectance": grey(0.4), "transmittance": grey(0.5)})

pytestmark = pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")


def facing_down(height: float, x: tuple[float, float], z: tuple[float, float], material: Material) -> Mesh:
    corners = [(x[0], height, z[0]), (x[1], height, z[0]), (x[1], height, z[1]), (x[0], height, z[1])]
    return Mesh(np.array(corners), np.array([(0, 1, 2), (0, 2, 3)]), material)


def room() -> tuple[Mesh, ...]:
    """A room of 2 × 2 × 2 m whose ceiling has a window of 1 × 1 m."""
    hull = box((-1, 0, -1), (1, 2, 1)).inside_out()
    below = [t for t in hull.triangles if hull.positions[t][:, 1].min() < 1.9]
    around = (
        ((-1.0, 1.0), (-1.0, -0.5)),
        ((-1.0, 1.0), (0.5, 1.0)),
        ((-1.0, -0.5), (-0.5, 0.5)),
        ((0.5, 1.0), (-0.5, 0.5)),
    )
    return Mesh(hull.positions, np.array(below), GREY), *(facing_down(2.0, x, z, GREY) for x, z in around)


def ball() -> Mesh:
    """A lamp of 512 triangles, of which a light sample finds the half that faces away in vain, so that its light is noisy."""
    polar, azimuth = np.meshgrid(np.linspace(0, np.pi, 9), np.linspace(0, 2 * np.pi, 33), indexing="ij")
    around = np.stack((np.sin(polar) * np.cos(azimuth), np.cos(polar), -np.sin(polar) * np.sin(azimuth)), -1)
    first = np.arange(8)[:, None] * 33 + np.arange(32)
    quads = np.stack((first, first + 33, first + 34, first + 1), -1).reshape(-1, 4)
    triangles = np.concatenate((quads[32:, [0, 2, 3]], quads[:-32, [0, 1, 2]]))
    return Mesh(np.array((0.2, 2.6, 0.1)) + 0.1 * around.reshape(-1, 3), triangles, replace(GLOW, emission=grey(60.0)))


LAMPS: dict[str, Scene] = {
    "ball": Scene((ball(),)),
    "quad": Scene((facing_down(2.6, (-0.3, 0.3), (-0.2, 0.4), GLOW),)),
    "point": Scene((), lights=(PointLight((0.2, 2.7, 0.1), (3.0,) * 3),)),
}
WINDOW = ((-0.5, 0.5), (-0.5, 0.5))
SHEETS: dict[str, tuple[Mesh, ...]] = {
    "curtain": (facing_down(2.0, *WINDOW, CURTAIN),),
    "half-open curtain": (facing_down(2.0, *WINDOW, replace(CURTAIN, opacity=grey(0.5))),),
}
METHODS: dict[str, Method] = {
    "irradiance-cache": eclat.IrradianceCache(max_error=0.03),
    "radiosity": eclat.Radiosity(patches=1500),
}
ROWS = [
    ("point", "curtain", "irradiance-cache"),
    ("quad", "curtain", "irradiance-cache"),
    ("quad", "half-open curtain", "irradiance-cache"),
    ("point", "curtain", "radiosity"),
]
SIZE = 32
LARGEST_BIAS = 0.02
"""What a method may err in a strip beyond chance: two thirds of the `max_error` of the cache."""


@cache
def scene(lamp: str, sheet: str) -> Scene:
    of_lamp = LAMPS[lamp]
    camera = Camera(look_at((0.2, 1.0, 0.95), (-0.1, 0.7, -1), (0, 1, 0)), fov=80.0)
    return replace(of_lamp, meshes=(*room(), *of_lamp.meshes, *SHEETS[sheet]), cameras=(camera,))


def strips(lamp: str, sheet: str, method: Method, samples: int, seeds: int) -> np.ndarray:
    """The means of four strips of the picture, from above, with each seed: (seeds, 4)."""
    pictures = [
        eclat.render(scene(lamp, sheet), method, size=(SIZE, SIZE), samples=samples, seed=seed, check=False).pixels
        for seed in range(seeds)
    ]
    return np.array(pictures)[..., 1].reshape(seeds, 4, -1).mean(-1)


@cache
def truth(lamp: str, sheet: str) -> np.ndarray:
    return strips(lamp, sheet, eclat.Path(), 512, 6)


def test_records_share_noisy_light_without_brightening_walls() -> None:
    """Far records on the walls have nearly all their light from few rays that found it. When each took the mean of those around
    it, they were 8 to 9 % brighter together than what they gathered: wide records lie lower and narrow ones close to the window,
    where little light arrives; now they are 1.0 to 1.4 %. The bound is `max_error`."""
    method = eclat.IrradianceCache(max_error=0.03)
    solution = eclat.solve(scene("ball", "curtain"), method, size=(SIZE, SIZE), seed=1, check=False)
    options = core_options(method)
    options.spacing = options.far_spacing
    far = np.ascontiguousarray(solution.far)
    caches = _core.SolvedCaches(far, far, options)
    columns = {name: slice(first, first + count) for name, first, count in _core.record_layout()}
    on_wall = abs(far[:, columns["normals"]][:, 1]) < 0.5
    gathered, kept = far[:, columns["excess"]][on_wall, 1], far[:, columns["irradiance"]][on_wall, 1]
    assert gathered.sum() > 10 * kept.sum()
    shared = caches.near_shared_excess[on_wall, 1]
    assert (kept + shared).sum() == pytest.approx((kept + gathered).sum(), rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(("lamp", "sheet", "method"), ROWS)
def test_light_under_a_window_is_that_of_path(lamp: str, sheet: str, method: str) -> None:
    """Before records were read without the tangents' common error, the upper strip under the point lamp's curtain was 6.8 % too
    bright by the cache, 4.6 standard errors beyond what is allowed. The bound of 4 was chosen with that in view, and the other
    rows were not tried on that state; tests/core/records/test_record_cache.cpp holds the formula itself. The seeds are fixed."""
    right, found = truth(lamp, sheet), strips(lamp, sheet, METHODS[method], 64, 8)
    error = np.sqrt(right.var(0, ddof=1) / len(right) + found.var(0, ddof=1) / len(found))
    beyond = abs(found.mean(0) - right.mean(0)) - LARGEST_BIAS * right.mean(0)
    assert (beyond < 4 * error).all(), f"off by {found.mean(0) / right.mean(0) - 1}"
