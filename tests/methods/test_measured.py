# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Measured materials in every method. What was measured is a diffuse surface, so that the truth is known: the picture with a
diffuse material by path tracing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.measured_brdf import MERL_SHAPE, MerlBrdf
from eclat.scene import Environment, Material, Mesh, Scene, rgb
from eclat.scenes import build
from eclat.scenes.geometry import icosphere

SIZE = (48, 48)
COLOR = (0.6, 0.4, 0.2)


def constant_brdf(color: tuple[float, float, float], name: str = "constant") -> MerlBrdf:
    """A diffuse surface, as MERL would have measured it."""
    return MerlBrdf(np.broadcast_to(np.reshape(color, (3, 1, 1, 1)) / np.pi, MERL_SHAPE).astype(np.float32), name)


MEASURED = Material("measured", name="measured", measured=constant_brdf(COLOR))
DIFFUSE = Material("diffuse", {"reflectance": rgb(*COLOR)}, name="diffuse")


def with_floor(material: Material) -> Scene:
    """The Cornell box with another floor and other blocks."""
    box = build("cornell-box")
    meshes = [
        replace(mesh, material=material) if "block" in mesh.name or "box" in mesh.name or "floor" in mesh.name else mesh
        for mesh in box.meshes
    ]
    assert sum(mesh.material is material for mesh in meshes) >= 2
    return replace(box, meshes=tuple(meshes))


@pytest.fixture(scope="module")
def truth() -> eclat.Image:
    return eclat.render(with_floor(DIFFUSE), eclat.Path(), samples=512, size=SIZE)


METHODS = (
    eclat.Path(),
    eclat.IrradianceCache(max_error=0.03),
    eclat.RadianceCache(max_error=0.03),
    eclat.PhotonMap(photons=100_000, caustic_photons=20_000),
    eclat.Radiosity(patches=3000),
)


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
@pytest.mark.filterwarnings("ignore:radiosity treats all surfaces as diffuse")
def test_every_method_agrees_with_the_diffuse_material(method: eclat.Method, truth: eclat.Image) -> None:
    image = eclat.render(with_floor(MEASURED), method, samples=64, size=SIZE)
    assert image.pixels.mean(axis=(0, 1)) == pytest.approx(truth.pixels.mean(axis=(0, 1)), rel=0.03)
    # By quarters of the picture, so that the floor counts for itself.
    quarters, wanted = (p.pixels.reshape(4, 12, 4, 12, 3).mean(axis=(1, 3)) for p in (image, truth))
    np.testing.assert_allclose(quarters, wanted, rtol=0.12, atol=0.01)


def test_the_albedo_guides_the_denoiser(truth: eclat.Image) -> None:
    image = eclat.render(with_floor(MEASURED), eclat.Direct(), samples=4, size=SIZE)
    np.testing.assert_allclose(image["albedo"].mean(axis=(0, 1)), truth["albedo"].mean(axis=(0, 1)), rtol=0.02)


def furnace(material: Material) -> np.ndarray:
    """The mean of the middle of a picture of a ball in a sky of radiance 1."""
    ball = icosphere(3)
    sky = Environment(np.ones((1, 1, 3), np.float32))
    scene = Scene((Mesh(ball.positions, ball.triangles, material),), environment=sky)
    image = eclat.render(scene, eclat.Path(), samples=64, size=(16, 16))
    return image.pixels[6:10, 6:10].mean(axis=(0, 1))


def test_a_scale_multiplies_what_was_measured() -> None:
    half = replace(MEASURED, parameters={"scale": rgb(0.5, 0.5, 0.5)})
    np.testing.assert_allclose(furnace(MEASURED), COLOR, rtol=0.02)
    np.testing.assert_allclose(furnace(half), np.multiply(COLOR, 0.5), rtol=0.02)


def test_a_back_that_was_not_measured_is_black() -> None:
    inside_out = icosphere(3)
    sky = Environment(np.ones((1, 1, 3), np.float32))
    one_sided = replace(MEASURED, two_sided=False)
    mesh = Mesh(inside_out.positions, inside_out.triangles[:, ::-1], one_sided)
    image = eclat.render(Scene((mesh,), environment=sky), eclat.Path(), samples=4, size=(16, 16))
    assert image.pixels[8, 8].max() == 0


def test_more_light_than_arrives_is_told() -> None:
    bright = replace(MEASURED, measured=constant_brdf((1.5, 0.5, 0.5), "lamp paint"))
    with pytest.warns(EclatWarning, match=r"'lamp paint' reflects up to 1(49|5.) % of the light, which no surface can"):
        furnace(bright)


def test_a_material_without_a_measurement_is_refused() -> None:
    with pytest.raises(
        EclatError, match=r"material 'bare': expected `measured` as eclat\.load_brdf returns it, got None"
    ):
        furnace(Material("measured", name="bare"))
