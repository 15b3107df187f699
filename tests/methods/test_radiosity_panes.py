# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Radiosity through panes of glass: light that lamps of some size send into a room, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, Material, Mesh, Scene, grey, look_at, rgb
from eclat.scenes.geometry import box

CAMERA = Camera(look_at((0.3, 1.3, 1.4), (0, 0.5, -0.3), (0, 1, 0)), fov=75.0, size=(16, 16))
TINT = (0.8, 0.5, 1.0)
SOLVERS = {
    "gathering": eclat.Radiosity(patches=1500),
    "shooting": eclat.Radiosity(patches=1500, solver="shooting"),
}

pytestmark = pytest.mark.filterwarnings("ignore:radiosity treats all surfaces as diffuse")


def pane(tint: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Material:
    return Material("thin_dielectric", {"specular_transmittance": rgb(*tint)})


def quad(corners: list[tuple[float, float, float]], material: Material) -> Mesh:
    return Mesh(np.array(corners, float), np.array([(0, 1, 2), (0, 2, 3)]), material)


def inner_sides(
    low: tuple[float, float, float], high: tuple[float, float, float], material: Material, without_x: float | None
) -> Mesh:
    room = box(low, high).inside_out()
    kept = (
        np.ones(len(room.triangles), bool)
        if without_x is None
        else np.abs(room.positions[room.triangles][..., 0] - without_x).max(axis=1) > 0
    )
    return Mesh(room.positions, room.triangles[kept], material)


def wall(reflectance: float, emission: float = 0.0, two_sided: bool = False) -> Material:
    light = grey(emission) if emission else None
    return Material("diffuse", {"reflectance": grey(reflectance)}, emission=light, two_sided=two_sided)


def hemispherical(ior: float = 1.5) -> float:
    """Share of even light that passes a pane: the mean of its transmittance weighted by cosine."""
    c = np.sqrt((np.arange(4000) + 0.5) / 4000)
    inside = np.sqrt(1 - (1 - c**2) / ior**2)
    s, p = (c - ior * inside) / (c + ior * inside), (ior * c - inside) / (ior * c + inside)
    r = (s * s + p * p) / 2
    return float(((1 - r) / (1 + r)).mean())


def behind_window(solver: str, panes: list[Material]) -> np.ndarray:
    """Power that a room whose black walls emit radiance 1 sends into a black room through a window of 1 m², W."""
    bright = inner_sides((-2, -1, -1), (0, 1, 1), wall(0.0, 1.0), 0.0)
    dark = inner_sides((0.3, -1, -1), (2, 1, 1), wall(0.0), 0.3)
    frames = [
        quad([(x, y0, z0), (x, y1, z0), (x, y1, z1), (x, y0, z1)], wall(0.0, two_sided=True))
        for x in (0.0, 0.3)
        for y0, y1, z0, z1 in ((-1, -0.5, -1, 1), (0.5, 1, -1, 1), (-0.5, 0.5, -1, -0.5), (-0.5, 0.5, 0.5, 1))
    ]
    sheets = [
        quad([(x, -0.5, -0.5), (x, 0.5, -0.5), (x, 0.5, 0.5), (x, -0.5, 0.5)], glass)
        for x, glass in zip((0.3, 0.2), panes, strict=False)
    ]
    # The reveal of the window emits, too, so that all that comes to the pane has radiance 1.
    tunnel = inner_sides((0, -0.5, -0.5), (0.3, 0.5, 0.5), wall(0.0, 1.0), None)
    sides = np.ptp(tunnel.positions[tunnel.triangles][..., 0], axis=1) > 0
    reveal = Mesh(tunnel.positions, tunnel.triangles[sides], tunnel.material)
    scene = Scene(meshes=(bright, dark, *frames, *sheets, reveal), cameras=(CAMERA,))
    solution = eclat.solve(scene, SOLVERS[solver], seed=1)
    inside = solution.corners[..., 0].max(axis=1) > 0.31
    return np.asarray((solution.irradiance * solution.areas[:, None])[inside].sum(axis=0))


@pytest.mark.parametrize("solver", SOLVERS)
def test_light_of_a_bright_room_passes_a_tinted_pane(solver: str) -> None:
    expected = math.pi * hemispherical() * np.array(TINT)
    assert behind_window(solver, [pane(TINT)]) == pytest.approx(expected, rel=0.02)


def test_light_of_a_bright_room_passes_frosted_glass() -> None:
    """Frosted glass scatters what passes, so that all of it arrives, as it does through a clear pane."""
    frosted = Material("metallic_roughness", {"roughness": grey(0.6), "metallic": grey(0.0), "transmission": grey(1.0)})
    assert behind_window("gathering", [frosted])[0] == pytest.approx(behind_window_by_paths(frosted), rel=0.05)


def behind_window_by_paths(glass: Material) -> float:
    """The same power by what a sheet shows from behind: the mean of its radiance there, weighted by cosine, times π."""
    lit = inner_sides((-2, -1, -1), (0, 1, 1), wall(0.0, 1.0), 0.0)
    sheet = quad([(0, -1, -1), (0, 1, -1), (0, 1, 1), (0, -1, 1)], glass)
    point = [(1e-3, 0.0, 0.0)]
    found = eclat.irradiance(Scene(meshes=(lit, sheet)), point, [(-1.0, 0.0, 0.0)], eclat.Path(), samples=4096)
    return float(np.asarray(found)[0, 0])


# Glass that is half wall absorbs a quarter of the light that comes to it; in a furnace it emits as much.
HALF_WALL = Material(
    "blend",
    {"weight": grey(0.5)},
    children=(pane(), wall(0.5, two_sided=True)),
    emission=grey(0.5),
    emission_two_sided=True,
)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("glass", [pane(), HALF_WALL], ids=["clear", "half-wall"])
def test_panes_in_a_furnace_change_nothing(solver: str, glass: Material) -> None:
    """Walls that emit 1 and reflect half show radiance 2 everywhere."""
    room = inner_sides((-1, -1, -1), (1, 1, 1), wall(0.5, 1.0), None)
    sheet = quad([(-0.6, -0.7, -0.5), (0.5, -0.7, 0.4), (0.5, 0.6, 0.4), (-0.6, 0.6, -0.5)], glass)
    solution = eclat.solve(Scene(meshes=(room, sheet), cameras=(CAMERA,)), SOLVERS[solver], seed=1)
    walls = solution.triangles < len(room.triangles)
    assert np.average(solution.irradiance[walls, 1], weights=solution.areas[walls]) == pytest.approx(
        2 * math.pi, rel=0.01
    )
    assert np.ptp(solution.irradiance[walls, 1]) < 0.1 * 2 * math.pi
