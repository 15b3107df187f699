# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Focused light: mirrors whose caustics have a closed form, and glass against `path`."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.scene import Material, Mesh, PointLight, Scene, grey
from eclat.scenes.geometry import Solid, mesh
from support.caustics import glass_sphere_box
from support.statistics import block_means

REFLECTANCE, INTENSITY = 0.8, 3.0
MIRROR = Material(
    "conductor", {"eta": grey(0.0), "k": grey(1.0), "specular_reflectance": grey(REFLECTANCE)}, name="mirror"
)
FLOOR = Material("diffuse", {"reflectance": grey(0.5)}, name="floor")


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


def test_point_light_in_a_reflecting_cylinder() -> None:
    """Light from the axis of a mirroring tube comes back to the axis: unfolded, it has gone s = 2mR ± r after m mirrors, and
    what would have fallen on the ring of radius s falls on that of radius r."""
    R, h = 1.0, 1.2
    tube = turned(np.array([R, R]), np.array([0.0, 3.0]), np.array([np.inf, np.inf]))
    scene = Scene((floor(1.2), mesh([tube], MIRROR, "tube")), (PointLight((0, h, 0), (INTENSITY,) * 3),))
    radii = np.array([0.15, 0.3, 0.5, 0.7, 0.85])

    def unfolded(s: np.ndarray) -> np.ndarray:
        return INTENSITY * h / (s**2 + h**2) ** 1.5

    truth = sum(
        REFLECTANCE**m * unfolded(s) * s / radii for m in range(1, 9) for s in (2 * m * R - radii, 2 * m * R + radii)
    )
    found = caustic_at(scene, radii, eclat.PhotonMap(photons=1000, caustic_photons=200_000, caustic_nearest=100))
    assert found == pytest.approx(truth, rel=0.03)


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
