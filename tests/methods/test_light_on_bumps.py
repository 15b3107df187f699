# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Methods on floors with normal maps, against `path`, which is right with shading normals by definition."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.methods import Method
from eclat.scene import Camera, Environment, Material, Mesh, NormalMap, Scene, Texture, Value, grey, look_at
from eclat.scenes.geometry import box


def bumpy_room(amplitude: float) -> Scene:
    """A white room lit by a lamp that looks down from the height of a table; normals of the floor swing by `amplitude`."""
    y, x = np.mgrid[0:128, 0:128] / 128 * 2 * np.pi
    bent = np.stack([amplitude * np.sin(6 * x), amplitude * np.cos(5 * y)], -1)
    normals = np.dstack([bent, np.sqrt(1 - (bent**2).sum(-1))])
    relief = NormalMap(Value((1, 1, 1), Texture(((normals + 1) * 127.5).astype(np.uint8))))

    def quad(corners: list[tuple[float, float, float]], material: Material) -> Mesh:
        uvs = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
        return Mesh(np.array(corners, float), np.array([(0, 1, 2), (0, 2, 3)]), material, uvs=uvs)

    white = Material("diffuse", {"reflectance": grey(0.8)})
    walls = box((-1.5, 0, -1.5), (1.5, 2, 1.5)).inside_out()
    room = Mesh(walls.positions, walls.triangles, white, normals=walls.normals)
    lamp = quad(
        [(-1.2, 1, -1.2), (-0.8, 1, -1.2), (-0.8, 1, -0.8), (-1.2, 1, -0.8)],
        Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(60.0)),
    )
    floor = quad(
        [(-1.5, 0.01, 1.5), (1.5, 0.01, 1.5), (1.5, 0.01, -1.5), (-1.5, 0.01, -1.5)],
        Material("diffuse", {"reflectance": grey(0.6)}, normal_map=relief),
    )
    camera = Camera(look_at((0.3, 1.3, 1.4), (0, 0.5, -0.3), (0, 1, 0)), fov=75.0, size=(24, 24))
    return Scene(meshes=(room, lamp, floor), cameras=(camera,))


@pytest.mark.slow
def test_photon_maps_lose_no_light_on_bumps() -> None:
    """Within 1 %; photons that left above the shading normal only, and weights of flat rays bounded by 4, lost 3.7 and 6.6 %."""
    scene = bumpy_room(0.6)
    truth = eclat.render(scene, eclat.Path(), samples=512).pixels.mean()
    for options in (eclat.PhotonMap(), eclat.PhotonMap(progressive=True, photons=20_000)):
        assert eclat.render(scene, options, samples=64).pixels.mean() == pytest.approx(truth, rel=0.01)


METHODS: dict[str, Method] = {
    "irradiance-cache": eclat.IrradianceCache(),
    "radiance-cache": eclat.RadianceCache(),
    "photon-map": eclat.PhotonMap(photons=20_000),
    "radiosity": eclat.Radiosity(patches=500),
    "patches": eclat.Radiosity(patches=500, gather=0),
}


@pytest.mark.parametrize("method", METHODS)
def test_a_bumpy_ground_under_an_even_sky(method: str) -> None:
    """A normal that bends by α loses the light below it: (1 + cos α) / 2 of π is left, to the caches and patches as well,
    which were 11 % too bright."""
    amplitude, floor = 0.6, bumpy_room(0.6).meshes[-1]
    above = Camera(look_at((0, 3, 0), (0, 0, 0.01), up=(0, 0, -1)), fov=40.0, size=(24, 24))
    scene = Scene((floor,), environment=Environment(np.ones((1, 1, 3), np.float32)), cameras=(above,))
    y, x = np.mgrid[0:128, 0:128] / 128 * 2 * np.pi
    cosines = np.sqrt(1 - (amplitude * np.sin(6 * x)) ** 2 - (amplitude * np.cos(5 * y)) ** 2)
    # The picture shows 2.2 m of a texture of 3 m, which differs from the whole by less than 1 %.
    found = eclat.render(scene, METHODS[method], samples=64, seed=1).pixels.mean()
    assert found == pytest.approx(0.6 * (1 + cosines.mean()) / 2, rel=0.015)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["irradiance-cache", "radiance-cache", "radiosity", "patches"])
def test_a_bumpy_floor_of_a_room(method: str) -> None:
    """Light from all sides but an even sky's: the lower half of the picture, the floor, was 4 % too bright with caches, and
    43 % too dark straight from patches, which mixed in those of the dark floor a centimetre below."""
    scene = bumpy_room(0.6)
    truth = eclat.render(scene, eclat.Path(), samples=1024).pixels[12:].mean()
    assert eclat.render(scene, METHODS[method], samples=64).pixels[12:].mean() == pytest.approx(truth, rel=0.025)
