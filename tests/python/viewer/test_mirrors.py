# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What surfaces mirror: closed forms, and the reflectance that paths find."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, Environment, Material, Mesh, Scene, grey, look_at, rgb
from eclat.viewer.mirrors import COSINES, alpha_of, conductor_fresnel, dielectric_fresnel, metal_shares, reflectance_of

COSINE = np.linspace(0, 1, COSINES)[:, None]


def test_dielectrics_at_normal_incidence_grazing_and_at_brewsters_angle() -> None:
    ior = np.array([1.5])
    found = dielectric_fresnel(COSINE, ior)[:, 0]
    assert found[-1] == pytest.approx(((1.5 - 1) / (1.5 + 1)) ** 2) and found[0] == pytest.approx(1)
    assert (np.diff(found) < 0).all()
    # At Brewster's angle only light across the plane of incidence is reflected, by cos²(2θ), halved.
    brewster = np.arctan(1.5)
    at = dielectric_fresnel(np.array([[np.cos(brewster)]]), ior)
    assert at[0, 0] == pytest.approx(0.5 * np.cos(2 * brewster) ** 2)
    # From inside there is total reflection.
    assert dielectric_fresnel(np.array([[0.5]]), np.array([1 / 1.5]))[0, 0] == 1


def test_conductors_without_absorption_are_dielectrics_and_others_follow_the_closed_form() -> None:
    clear = conductor_fresnel(COSINE[1:], np.array([1.5]), np.array([0.0]))
    np.testing.assert_allclose(clear, dielectric_fresnel(COSINE[1:], np.array([1.5])), atol=1e-9)
    eta, k = np.array([0.2, 1.5]), np.array([3.9, 2.0])
    normal = conductor_fresnel(np.ones((1, 1)), eta, k)
    np.testing.assert_allclose(normal[0], ((eta - 1) ** 2 + k**2) / ((eta + 1) ** 2 + k**2))
    assert conductor_fresnel(np.zeros((1, 1)), eta, k)[0] == pytest.approx(1)
    assert conductor_fresnel(COSINE, np.zeros(3), np.ones(3)) == pytest.approx(1)  # reflects all light


def test_each_kind_of_material_mirrors_what_it_says() -> None:
    assert (reflectance_of(Material("diffuse")) == 0).all()
    phong = Material("phong", {"specular_reflectance": rgb(0.1, 0.2, 0.3), "exponent": grey(50.0)})
    assert reflectance_of(phong) == pytest.approx(np.tile([0.1, 0.2, 0.3], (COSINES, 1)))
    assert alpha_of(phong) == pytest.approx(np.sqrt(2 / 52))
    plastic = Material("plastic", {"specular_reflectance": grey(0.5)})
    assert reflectance_of(plastic)[-1] == pytest.approx(0.5 * 0.04) and alpha_of(plastic) == 0
    rough = replace(plastic, parameters={"alpha_u": grey(0.2)})
    assert reflectance_of(rough)[-1] == pytest.approx(0.04, rel=0.05) and alpha_of(rough) == pytest.approx(0.2)
    coated = Material("metallic_roughness", {"specular": grey(0.5), "roughness": grey(0.3)})
    assert reflectance_of(coated)[-1] == pytest.approx(0.5 * 0.04, rel=0.15) and alpha_of(coated) == pytest.approx(0.3)
    smooth = replace(coated, parameters={"specular": grey(0.5), "roughness": grey(0)})
    assert reflectance_of(smooth)[0] == pytest.approx(0.5)
    metal = Material("conductor", {"specular_reflectance": rgb(0.9, 0.5, 0.1)})
    assert reflectance_of(metal) == pytest.approx(np.tile([0.9, 0.5, 0.1], (COSINES, 1)))


def found_by_paths(material: Material, cosine: float) -> np.ndarray:
    """What a square of the material reflects below a white sky, seen at the cosine from its normal."""
    corners = np.array([[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]], float)
    square = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), material, name="square")
    eye = (0.0, 10 * cosine, 10 * np.sqrt(1 - cosine**2))
    camera = Camera(look_at(eye, (0, 0, 0)), fov=0.5, size=(8, 8))
    scene = Scene((square,), (), environment=Environment(np.ones((1, 1, 3), np.float32)), cameras=(camera,))
    return np.asarray(eclat.render(scene, eclat.Path(), samples=1024).pixels.mean(axis=(0, 1)))


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("alpha", [0.15, 0.5])
@pytest.mark.parametrize("cosine", [4 / 31, 20 / 31])
def test_rough_surfaces_mirror_as_much_as_paths_find(distribution: str, alpha: float, cosine: float) -> None:
    rough = {"alpha_u": grey(alpha)}
    coat = Material("plastic", {**rough, "diffuse_reflectance": grey(0)}, distribution=distribution)
    metal = Material(
        "conductor",
        {**rough, "alpha_v": grey(alpha), "eta": rgb(0.2, 0.9, 1.5), "k": rgb(3.9, 2.4, 2.0)},
        distribution=distribution,
    )
    for material in (coat, metal):
        expected = reflectance_of(material)[round(31 * cosine)]
        np.testing.assert_allclose(found_by_paths(material, cosine), expected, rtol=0.02)


def test_rough_metals_mirror_as_much_as_paths_find() -> None:
    for cosine in (4 / 31, 20 / 31):
        parameters = {"base_color": rgb(0.9, 0.5, 0.1), "metallic": grey(1), "roughness": grey(0.4)}
        metal = Material("metallic_roughness", parameters)
        a, b = metal_shares(metal)[round(31 * cosine)]
        np.testing.assert_allclose(found_by_paths(metal, cosine), np.array((0.9, 0.5, 0.1)) * a + b, rtol=0.02)
