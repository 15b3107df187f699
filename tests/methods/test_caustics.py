# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Focused light: mirrors and glass whose caustics have a closed form, and glass against `path`."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, DirectionalLight, Material, Mesh, PointLight, Scene, grey, look_at
from eclat.scenes.geometry import Solid, box, mesh
from support.caustics import GLASS, glass_sphere_box, sphere
from support.glass_optics import reflectance, through_ball, through_slab
from support.statistics import block_means

REFLECTANCE, FLOOR_ALBEDO, INTENSITY = 0.8, 0.5, 3.0
MIRROR = Material(
    "conductor", {"eta": grey(0.0), "k": grey(1.0), "specular_reflectance": grey(REFLECTANCE)}, name="mirror"
)
FLOOR = Material("diffuse", {"reflectance": grey(FLOOR_ALBEDO)}, name="floor")


def floor(half: float, y: float = 0.0) -> Mesh:
    corners = np.array([(-half, y, half), (half, y, half), (half, y, -half), (-half, y, -half)])
    return Mesh(corners, np.array([(0, 1, 2), (0, 2, 3)]), FLOOR, name="floor")


def turned(radii: np.ndarray, heights: np.ndarray, slopes: np.ndarray, segments: int = 256) -> Solid:
    """An open surface of revolution about y with exact vertex normals; `slopes` is d height / d radius."""
    phi = np.arange(segments) * (2 * np.pi / segments)
    positions, normals = [], []
    for r, y, slope in zip(radii, heights, slopes, strict=True):
        positions.append(np.column_stack([r * np.cos(phi), np.full(segments, y), r * np.sin(phi)]))
        across = 1.0 if np.isfinite(slope) else 0.0
        radial = -slope if np.isfinite(slope) else -1.0
        n = np.column_stack([radial * np.cos(phi), np.full(segments, across), radial * np.sin(phi)])
        normals.append(n / np.linalg.norm(n, axis=1, keepdims=True))
    i, j = np.arange(segments), (np.arange(segments) + 1) % segments
    triangles = []
    for row in range(len(radii) - 1):
        a, b, c, d = row * segments + i, row * segments + j, (row + 1) * segments + j, (row + 1) * segments + i
        triangles += [np.column_stack([a, b, c]), np.column_stack([a, c, d])]
    return Solid(np.concatenate(positions), np.concatenate(triangles), np.concatenate(normals))


def rings(radii: np.ndarray, y: float = 0.0, points: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """Points on circles about the y axis, and normals that point up."""
    phi = 2 * np.pi * (np.arange(points) + 0.3) / points
    p = [np.column_stack([r * np.cos(phi), np.full(points, y), r * np.sin(phi)]) for r in radii]
    positions = np.concatenate(p)
    return positions, np.tile([0.0, 1.0, 0.0], (len(positions), 1))


def caustic_at(scene: Scene, radii: np.ndarray, options: eclat.PhotonMap, y: float = 0.0) -> np.ndarray:
    photons = eclat.solve(scene, options)
    return photons.irradiance(scene, *rings(radii, y), caustic=True)[:, 1].reshape(len(radii), -1).mean(axis=1)


def tube_and_light() -> Scene:
    """A mirroring tube of radius 1 on a floor, a point light on its axis, seen from above within the radius."""
    tube = turned(np.array([1.0, 1.0]), np.array([0.0, 3.0]), np.array([np.inf, np.inf]))
    camera = Camera(look_at((0, 2.9, 0), (0, 0, 0), (0, 0, 1)), fov=2.0, projection="orthographic")
    light = PointLight((0, 1.2, 0), (INTENSITY,) * 3)
    return Scene((floor(1.2), mesh([tube], MIRROR, "tube")), (light,), cameras=(camera,))


def tube_irradiance(radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """On the floor, straight from the light and from mirrors. Light from the axis of a mirroring tube comes back to the axis:
    unfolded, it has gone s = 2mR ± r after m mirrors, and what would have fallen on the ring of radius s falls on that of
    radius r."""
    R, h = 1.0, 1.2

    def unfolded(s: np.ndarray) -> np.ndarray:
        return INTENSITY * h / (s**2 + h**2) ** 1.5

    mirrored = [
        REFLECTANCE**m * unfolded(s) * s / radii for m in range(1, 40) for s in (2 * m * R - radii, 2 * m * R + radii)
    ]
    return unfolded(radii), np.sum(mirrored, axis=0)


def test_point_light_in_a_reflecting_cylinder() -> None:
    radii = np.array([0.15, 0.3, 0.5, 0.7, 0.85])
    options = eclat.PhotonMap(photons=1000, caustic_photons=200_000, caustic_nearest=100)
    assert caustic_at(tube_and_light(), radii, options) == pytest.approx(tube_irradiance(radii)[1], rel=0.03)


def test_progressive_error_falls_to_the_closed_form() -> None:
    """Sixteen times the passes, less than half the error, and again: what is noise falls as n^(−α/2), what is blur as
    n^(α−1), to 0.38 and 0.44 of what it was. With discs that do not shrink the second step keeps more than 0.9."""
    size, parts = 32, 8
    centers = (np.arange(size * parts) + 0.5) * (2 / (size * parts)) - 1
    radii = np.hypot(centers[:, None], centers)
    # What the floor reflects upwards leaves the tube, so this is all the light there is.
    fine = FLOOR_ALBEDO / np.pi * sum(tube_irradiance(radii))
    truth, radii = (a.reshape(size, parts, size, parts).mean(axis=(1, 3)) for a in (fine, radii))
    inside = (radii > 0.25) & (radii < 0.75)  # the axis is infinitely bright

    def error(passes: int) -> float:
        options = eclat.PhotonMap(progressive=True, photons=2000, nearest=50)
        image = eclat.render(tube_and_light(), options, samples=passes, size=(size, size)).pixels[:, :, 1]
        return float(np.sqrt(np.mean((image / truth - 1)[inside] ** 2)))

    errors = [error(n) for n in (1, 16, 256)]
    assert errors[1] < 0.5 * errors[0]
    assert errors[2] < 0.5 * errors[1]
    assert errors[2] < 0.015


def test_point_light_in_the_focus_of_a_paraboloid() -> None:
    """Its mirrored light is a parallel beam of irradiance I / (f (1 + (r / 2f)²))², ρ of it."""
    f = 0.5
    r = np.linspace(0.001, 0.9, 60)
    bowl = turned(r, -(r**2) / (4 * f), -r / (2 * f))  # opens downwards, focus at −f
    light = PointLight((0, -f, 0), (INTENSITY,) * 3)
    scene = Scene((floor(2, -1.5), mesh([bowl], MIRROR, "bowl")), (light,))
    radii = np.array([0.1, 0.3, 0.5, 0.7])
    truth = REFLECTANCE * INTENSITY / (f * (1 + (radii / (2 * f)) ** 2)) ** 2
    found = caustic_at(scene, radii, eclat.PhotonMap(photons=1000, caustic_photons=100_000), y=-1.5)
    assert found == pytest.approx(truth, rel=0.03)
    # The beam ends where the bowl does.
    assert caustic_at(scene, np.array([1.1]), eclat.PhotonMap(photons=1000, caustic_photons=50_000), y=-1.5) < 0.05


IOR = 1.5  # of GLASS


def ring_flux(photons: eclat.Photons, edges: np.ndarray) -> np.ndarray:
    """W of caustic photons between circles about the y axis: what was traced, with no blur of an estimate."""
    x, _, z = photons.positions[photons.is_caustic].T
    return np.histogram(np.hypot(x, z), edges, weights=photons.powers[photons.is_caustic, 1])[0]


@pytest.mark.parametrize("degrees", [0.0, 60.0])
def test_sun_through_a_pane_of_glass(degrees: float) -> None:
    """Of a wide beam a pane lets pass (1 − R)² (1 + R² + R⁴ + …) = (1 − R) / (1 + R)."""
    cosine = np.cos(np.radians(degrees))
    pane = mesh([box((-4, 0.3, -4), (4, 0.5, 4))], GLASS, "pane")
    sun = DirectionalLight((np.sin(np.radians(degrees)), -cosine, 0), (INTENSITY,) * 3)
    scene = Scene((floor(4), pane), (sun,))
    photons = eclat.solve(scene, eclat.PhotonMap(photons=1000, caustic_photons=100_000, caustic_nearest=100))
    r = reflectance(cosine, IOR)
    truth = INTENSITY * cosine * (1 - r) / (1 + r)
    assert ring_flux(photons, np.array([0, 2])) == pytest.approx(truth * np.pi * 4, rel=0.01)
    found = photons.irradiance(scene, *rings(np.array([0.5, 1.0, 1.5]), points=64), caustic=True)[:, 1]
    assert found.mean() == pytest.approx(truth, rel=0.02)


def test_point_light_through_a_pane_of_glass() -> None:
    """The pane brings the light nearer: up to a sixth more than without it, less where it reflects more."""
    pane = mesh([box((-4, 0.3, -4), (4, 0.7, 4))], GLASS, "pane")
    scene = Scene((floor(2), pane), (PointLight((0, 1.2, 0), (INTENSITY,) * 3),))
    radii = np.array([0.1, 0.3, 0.5, 0.7, 1.0, 1.4])
    truth = sum(part.irradiance(radii) for part in through_slab(INTENSITY, 1.2, 0.4, IOR))
    found = caustic_at(scene, radii, eclat.PhotonMap(photons=1000, caustic_photons=200_000, caustic_nearest=100))
    assert found == pytest.approx(truth, rel=0.03)


def test_sun_through_a_glass_ball() -> None:
    """A parallel beam, caught a quarter of the radius behind the paraxial focus at 3/2 of it: Snell and Fresnel say where each
    ray of the beam lands and with how much, how near to each other rays land says how bright it is. From the middle to the
    outermost ring is a factor of 170."""
    radius, height = 0.5, 0.875
    wall = mesh([box((2, 0, -2), (2.1, 2, 2))], FLOOR, "wall")  # what global photons find
    ball = sphere((0, height, 0), radius, GLASS, subdivisions=5)
    scene = Scene((floor(2), wall, ball), (DirectionalLight((0, -1, 0), (INTENSITY,) * 3),))
    photons = eclat.solve(scene, eclat.PhotonMap(photons=1000, caustic_photons=200_000, caustic_nearest=200))
    rays = through_ball(INTENSITY, radius, height, IOR)

    edges = np.array([0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 1.5])
    assert ring_flux(photons, edges) == pytest.approx(sum(part.ring_flux(edges) for part in rays), rel=0.02)

    radii = np.array([0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8])
    found = photons.irradiance(scene, *rings(radii, points=64), caustic=True)[:, 1].reshape(len(radii), -1).mean(axis=1)
    assert found == pytest.approx(sum(part.irradiance(radii) for part in rays), rel=0.04)


def test_agrees_with_path_through_glass() -> None:
    """The caustic below a glass sphere, under a light so large that paths find it by chance."""
    scene = glass_sphere_box(light_scale=3.0)
    reference = eclat.render(scene, eclat.Path(), samples=400, size=(48, 48), seed=1).pixels
    for options in (eclat.PhotonMap(gather=0), eclat.PhotonMap()):
        image = eclat.render(scene, options, samples=24, size=(48, 48)).pixels
        ours, theirs = block_means(image, 12), block_means(reference, 12)
        assert np.sqrt(np.mean((ours - theirs) ** 2 / (theirs**2 + (0.1 * theirs.mean()) ** 2))) < 0.04


def test_no_fireflies_beside_caustics() -> None:
    """Light that path tracing finds once in ten thousand paths makes no bright dots: no pixel of the walls stands out."""
    scene = glass_sphere_box()
    size = (64, 64)
    shown = eclat.render(scene, eclat.PhotonMap(gather=0), samples=4, size=size).pixels.mean(axis=2)
    walls = shown[16:40, 4:60]  # away from the light, the sphere and its caustic
    assert walls.max() < 3 * np.median(walls)
