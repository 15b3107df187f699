# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Directional light maps against closed forms, against probes, and as the shaders of engines read them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError
from eclat.images.exr import decode_exr
from eclat.lightmap.directional import (
    FLUX,
    MOMENT,
    for_godot,
    for_unity,
    gather_harmonics,
    irradiance_for,
    with_irradiance,
)
from eclat.lightmap.gathering import GatheredTexels, Settings, TexelPoints
from eclat.measure.photometry import luminance
from eclat.methods import Path as PathMethod
from eclat.scene import Environment, Material, Mesh, PointLight, Scene, grey
from support.light_maps import lookup

HEIGHT, POWER = 1.0, 3.0
UP = np.array([0.0, 1.0, 0.0])


def plane(**scene: object) -> Scene:
    corners = np.array([[-2.0, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]])
    material = Material("diffuse", {"reflectance": grey(0.5)})
    return Scene(meshes=(Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), material),), name="plane", **scene)  # type: ignore[arg-type]


def normals(count: int) -> np.ndarray:
    found = np.random.default_rng(3).normal(size=(count, 3))
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def read(lightmap: eclat.Lightmap, points: np.ndarray) -> np.ndarray:
    """The coefficients (N, 4, 3) at points x, z of the plane, as a viewer interpolates them."""
    part = lightmap.parts[0]  # the front; under a sky the back is another
    assert part.lightmap_uvs is not None and lightmap.harmonics is not None
    positions = np.asarray(part.mesh.positions)
    planar = np.column_stack((positions[:, [0, 2]], np.ones(len(positions))))
    to_uv, *_ = np.linalg.lstsq(planar, part.lightmap_uvs, rcond=None)
    uvs = np.column_stack((points, np.ones(len(points)))) @ to_uv
    flat = lightmap.harmonics.reshape(*lightmap.harmonics.shape[:2], 12)
    return lookup(flat, uvs).reshape(-1, 4, 3)


def test_a_plane_under_an_even_sky() -> None:
    """Φ = 2π L and M = π L n, with which order 1 is exact: a plane tilted by θ sees π L (1 + cos θ) / 2 of the sky."""
    scene = plane(environment=Environment(np.full((1, 1, 3), 2.0, np.float32)))
    lightmap = eclat.bake(scene, "direct", component="direct", texel_size=0.5, samples=1024, directional=True)
    found = read(lightmap, np.array([[0.0, 0.0], [1.2, -0.7]]))
    tilted = normals(50)
    wanted = np.pi * 2.0 * (1 + tilted @ UP) / 2
    for texel in found:
        np.testing.assert_allclose(irradiance_for(texel, tilted)[:, 1], wanted, atol=0.03 * np.pi * 2)
        np.testing.assert_allclose(texel[2:] / MOMENT, 0, atol=0.06 * np.pi * 2)
        assert texel[1, 0] / MOMENT == pytest.approx(np.pi * 2.0, rel=0.002), "the irradiance of the plane is exact"


def test_a_plane_under_one_lamp() -> None:
    """A lamp of intensity I at the distance d in the direction ω has Φ = I/d² and M = Φ ω."""
    lamp = PointLight((0.3, HEIGHT, -0.2), (POWER, POWER / 2, 0.0))
    scene = plane(lights=(lamp,))
    lightmap = eclat.bake(scene, "direct", component="direct", texel_size=0.02, samples=4, directional=True)
    points = np.array([[0.0, 0.0], [0.5, 0.9], [-1.1, 0.4]])
    towards = np.array(lamp.position) - np.column_stack((points[:, 0], np.zeros(3), points[:, 1]))
    distance = np.linalg.norm(towards, axis=1)
    tilted = normals(40)
    for texel, w, d in zip(read(lightmap, points), towards / distance[:, None], distance, strict=True):
        flux = POWER / d**2
        assert texel[0, 0] / FLUX == pytest.approx(flux, rel=0.002)
        np.testing.assert_allclose(texel[1:, 0] / MOMENT, flux * w[[1, 2, 0]], atol=0.002 * flux)
        wanted = flux * (0.25 + tilted @ w / 2)
        np.testing.assert_allclose(irradiance_for(texel, tilted)[:, 0], wanted, atol=0.003 * flux)
        np.testing.assert_allclose(texel[:, 1], texel[:, 0] / 2, rtol=1e-4, atol=1e-6)
        np.testing.assert_array_equal(texel[:, 2], 0)


def test_all_light_of_a_room_is_that_of_probes_above_a_black_floor() -> None:
    """A probe sees the whole sphere: above a black floor, the part below is dark, as in a light map."""
    room = eclat.load("cornell-box")
    black = Material("diffuse", {"reflectance": grey(0.0)})
    height = 0.01
    sheet = Mesh(
        np.array([[-0.9, 0, -0.9], [-0.9, 0, 0.9], [0.9, 0, 0.9], [0.9, 0, -0.9]]) - [0, 0.98, 0],
        np.array([[0, 1, 2], [0, 2, 3]]),
        black,
    )
    scene = Scene(meshes=(*room.meshes[:6], sheet), cameras=room.cameras)
    place = np.array([[0.3, -0.98 + 1e-5, 0.2]])
    point = place[:, None].repeat(2, axis=1), UP[None, None].repeat(2, axis=1)
    points = TexelPoints(*point, point[1], np.zeros((1, 2, 2)))
    free = np.ones((1, 2), bool)
    value = eclat.irradiance(scene, place, UP[None], PathMethod(), samples=1 << 14).astype(np.float64)
    gathered = GatheredTexels(value, np.zeros((1, 2)), free[:, 0], {}, PathMethod())
    settings = Settings("total", 1 << 14, -1, 0, None, None)
    (found,) = gather_harmonics(scene, gathered, points, free, settings)
    middle = place[0] + [0, height, 0]
    bounds = (*(middle - 0.001), *(middle + 0.001))
    grid = eclat.probes(scene, "path", grid=(1, 1, 1), bounds=bounds, samples=1 << 15)
    probe = grid.coefficients.reshape(-1, 3)[:4]
    np.testing.assert_allclose(found, probe, atol=0.03 * float(probe[0].max()))
    # The plain sum of rays, which nothing corrects, has the same irradiance.
    assert np.abs(found[1] / MOMENT - value[0]).max() < 1e-4 * value.max()


def test_the_irradiance_of_the_surface_replaces_that_of_rays() -> None:
    rng = np.random.default_rng(1)
    harmonics, values, n = rng.normal(size=(20, 4, 3)), rng.random((20, 3)), normals(20)
    changed = with_irradiance(harmonics, n, values)
    moment = changed[:, [3, 1, 2]] / MOMENT
    np.testing.assert_allclose(np.einsum("nic,ni->nc", moment, n), values)
    aside = np.cross(n, UP)
    before = harmonics[:, [3, 1, 2]] / MOMENT
    np.testing.assert_allclose(np.einsum("nic,ni->nc", moment, aside), np.einsum("nic,ni->nc", before, aside))
    np.testing.assert_array_equal(changed[:, 0], harmonics[:, 0])


def texel(directions: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Coefficients of lamps in `directions` (N, 3) that give `light` (N, 3)."""
    flux, moment = light.sum(axis=0), directions.T @ light
    return np.concatenate((flux[None] * FLUX, moment[[1, 2, 0]] * MOMENT))


def test_what_the_shader_of_godot_shows() -> None:
    """Godot multiplies the albedo by L₀ + 4 L₀ (l₁ · n), and the light that a white surface reflects is E/π."""
    w = normals(6) * [1, 0, 1] + [0, 1.2, 0]
    w /= np.linalg.norm(w, axis=1, keepdims=True)
    harmonics = texel(w, np.random.default_rng(2).random((6, 3)))
    slices = for_godot(harmonics[None, None]).reshape(4, 3).astype(np.float64)
    for n in normals(30):
        l1 = (slices[1:] - 0.5) * 2
        shown = slices[0] + 4 * slices[0] * (l1[0] * n[1] + l1[1] * n[2] + l1[2] * n[0])
        np.testing.assert_allclose(shown, irradiance_for(harmonics, n) / np.pi, rtol=1e-4, atol=1e-5)


def test_what_the_shader_of_unity_shows() -> None:
    """The surface's own normal gets the light map's value, others that of order 1, where light comes from all around."""
    w = normals(300)
    w[:, 1] = np.abs(w[:, 1])
    harmonics = texel(w, np.ones((300, 3)) * [1.0, 0.9, 0.8])
    moment = harmonics[[3, 1, 2]] / MOMENT
    irradiance = moment[1]
    packed = for_unity(harmonics[None, None], irradiance[None, None])[0, 0] / 255
    assert luminance(irradiance) > 0
    for n in (UP, *normals(30)):
        mirrored = n * [-1, 1, 1]  # Unity's axes
        shown = irradiance * (mirrored @ (packed[:3] - 0.5) + 0.5) / max(1e-4, packed[3])
        wanted = irradiance_for(harmonics, n) * irradiance / irradiance_for(harmonics, UP)
        np.testing.assert_allclose(shown, wanted, atol=0.02 * irradiance.max())


def test_files_hold_the_coefficients(tmp_path: Path) -> None:
    scene = plane(lights=(PointLight((0.3, HEIGHT, -0.2), (POWER, 1.0, 0.5)),))
    lightmap = eclat.bake(scene, "direct", component="direct", texel_size=0.2, samples=4, directional=True)
    assert lightmap.harmonics is not None
    for layout, ending in (("sh", "sh.exr"), ("godot", "godot.exr"), ("unity", "unity.png")):
        files = lightmap.save(tmp_path / "a.glb", directional=layout)
        assert files[-1] == tmp_path / f"a.lightmap.{ending}" and files[-1].is_file()
    data = (tmp_path / "a.lightmap.sh.exr").read_bytes()
    first, layers, _ = decode_exr(data, "a", lambda *size: None)
    np.testing.assert_array_equal(first, lightmap.harmonics[:, :, 0])
    for i, name in enumerate(("l1y", "l1z", "l1x")):
        np.testing.assert_array_equal(layers[name], lightmap.harmonics[:, :, 1 + i])
    stacked, _, _ = decode_exr((tmp_path / "a.lightmap.godot.exr").read_bytes(), "a", lambda *size: None)
    assert stacked.shape == (4 * lightmap.irradiance.shape[0], lightmap.irradiance.shape[1], 3)
    with pytest.raises(EclatError, match="holds no directions"):
        eclat.bake(scene, "direct", texel_size=0.5, samples=4).save(tmp_path / "b.glb", directional="sh")
    assert not list(tmp_path.glob("b*"))


def test_same_bits_on_any_number_of_threads() -> None:
    scene = eclat.load("cornell-box")
    one, two = (
        eclat.bake(scene, texel_size=0.25, samples=8, max_error=0.1, directional=True, threads=threads)
        for threads in (1, 2)
    )
    assert one.harmonics is not None and two.harmonics is not None
    np.testing.assert_array_equal(one.harmonics, two.harmonics)
    np.testing.assert_array_equal(one.irradiance, two.irradiance)
