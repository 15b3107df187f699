# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What surfaces mirror: closed forms, and the reflectance that paths find."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.scene import Material, grey, rgb
from eclat.viewer.mirrors import COSINES, alpha_of, conductor_fresnel, dielectric_fresnel, reflectance_of

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
    plastic = Material("plastic", {"alpha_u": grey(0.2), "specular_reflectance": grey(0.5)})
    assert reflectance_of(plastic)[-1] == pytest.approx(0.5 * 0.04) and alpha_of(plastic) == pytest.approx(0.2)
    coated = Material("metallic_roughness", {"specular": grey(0.5), "roughness": grey(0.3)})
    assert reflectance_of(coated)[-1] == pytest.approx(0.5 * 0.04) and alpha_of(coated) == pytest.approx(0.3)
    assert reflectance_of(coated)[0] == pytest.approx(0.5)
    metal = Material("conductor", {"specular_reflectance": rgb(0.9, 0.5, 0.1)})
    assert reflectance_of(metal) == pytest.approx(np.tile([0.9, 0.5, 0.1], (COSINES, 1)))
