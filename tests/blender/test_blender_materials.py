# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders of Blender as materials of Éclat."""

import numpy as np
import pytest

from eclat_blender.materials import Materials
from eclat_blender.notices import Notices
from support.blender_standins import image_node, link, material, node, principled


def made(stuff):
    notices = Notices()
    return Materials(notices).of(stuff).material, notices.texts


def test_a_principled_surface_has_the_reflectance_of_its_level():
    found, texts = made(material(principled(Base_Color=(0.2, 0.4, 0.6, 1), Roughness=0.3, Specular_IOR_Level=1.0)))
    ior = found.parameters["ior"].constant[0]
    assert ((ior - 1) / (ior + 1)) ** 2 == pytest.approx(2 * 0.04)
    assert found.parameters["base_color"].constant == pytest.approx((0.2, 0.4, 0.6))
    assert found.parameters["roughness"].constant[0] == pytest.approx(0.3) and found.parameters["roughness"].square
    assert found.two_sided and found.emission is None and texts == []


def test_glass_takes_the_root_of_its_colour_at_each_surface():
    found, _ = made(material(principled(Base_Color=(0.25, 1, 1, 1), Transmission_Weight=1.0)))
    assert found.kind == "metallic_roughness" and not found.thin_walled
    assert found.parameters["base_color"].constant[0] == pytest.approx(0.5)
    assert found.parameters["transmission"].constant[0] == 1


def test_half_transmission_is_a_blend_of_an_opaque_part_and_glass():
    found, _ = made(material(principled(Transmission_Weight=0.5, Metallic=0.2)))
    weight, opaque, glass = found.parameters["weight"].constant[0], *found.children
    assert weight == pytest.approx(0.5 * 0.8)
    assert (1 - weight) * opaque.parameters["metallic"].constant[0] == pytest.approx(0.2)
    assert glass.parameters["metallic"].constant[0] == 0 and opaque.parameters["transmission"].constant[0] == 0


def test_emission_is_colour_times_strength_on_both_sides():
    found, _ = made(material(principled(Emission_Color=(1, 0.5, 0, 1), Emission_Strength=4.0)))
    assert (
        found.emission is not None and found.emission.constant == pytest.approx((4, 2, 0)) and found.emission_two_sided
    )


def test_alpha_of_an_image_is_the_opacity():
    texels = np.ones((2, 2, 4))
    texels[0, 0, 3] = 0.0
    shader, source = principled(), image_node(texels)
    link(source, "Alpha", shader, "Alpha")
    found, _ = made(material(shader, source))
    assert found.opacity.texture is not None and found.opacity.texture.image[0, 0, 0] == 0


def test_clear_mixed_with_a_surface_is_opacity_and_with_glow_keeps_its_radiance():
    clear = node("BSDF_TRANSPARENT", {"Color": (1, 1, 1, 1)}, {"BSDF": (0, 0, 0, 1)})
    glow = node("EMISSION", {"Color": (1, 1, 1, 1), "Strength": 3.0}, {"Emission": (0, 0, 0, 1)})
    mix = node("MIX_SHADER", {"Fac": 0.25, "A": (0, 0, 0, 1), "B": (0, 0, 0, 1)}, {"Shader": (0, 0, 0, 1)})
    link(clear, "BSDF", mix, 1)
    link(glow, "Emission", mix, 2)
    found, texts = made(material(mix, clear, glow, output="Shader"))
    assert found.opacity.constant[0] == pytest.approx(0.25) and texts == []
    assert found.emission is not None and found.emission.constant[0] == pytest.approx(3)


def test_two_surfaces_are_blended():
    parts = [
        node("BSDF_DIFFUSE", {"Color": (c, c, c, 1), "Roughness": 0.0, "Normal": (0, 0, 0)}, {"BSDF": (0, 0, 0, 1)})
        for c in (0.2, 0.8)
    ]
    mix = node("MIX_SHADER", {"Fac": 0.3, "A": (0, 0, 0, 1), "B": (0, 0, 0, 1)}, {"Shader": (0, 0, 0, 1)})
    for index, part in enumerate(parts):
        link(part, "BSDF", mix, 1 + index)
    found, _ = made(material(mix, *parts, output="Shader"))
    assert found.kind == "blend" and found.parameters["weight"].constant[0] == pytest.approx(0.3)
    assert [c.parameters["reflectance"].constant[0] for c in found.children] == pytest.approx([0.2, 0.8])


def test_a_rough_mirror_reflects_its_colour_in_all_directions():
    shader = node(
        "BSDF_GLOSSY", {"Color": (0.9, 0.45, 0.0, 1), "Roughness": 0.4, "Anisotropy": 0.0, "Normal": (0, 0, 0)},
        {"BSDF": (0, 0, 0, 1)}, distribution="GGX",
    )  # fmt: skip
    found, _ = made(material(shader))
    assert (found.kind, found.masking) == ("conductor", "correlated")
    p = {name: value.constant for name, value in found.parameters.items()}
    assert (p["eta"], p["k"]) == ((0, 0, 0), (1, 1, 1)), "which reflects all light in all directions"
    assert p["specular_reflectance"] == pytest.approx((0.9, 0.45, 0.0))


def test_what_is_left_out_is_named():
    _, texts = made(material(principled(Coat_Weight=0.5, Sheen_Weight=0.1)))
    assert texts == [
        "material 'stuff': 'Sheen Weight' is not supported and is left out",
        "material 'stuff': 'Coat Weight' is not supported and is left out",
    ]
    toon = node("BSDF_TOON", {"Color": (0.3, 0.3, 0.3, 1)}, {"BSDF": (0, 0, 0, 1)})
    found, texts = made(material(toon))
    assert found.kind == "diffuse" and found.parameters["reflectance"].constant[0] == pytest.approx(0.3)
    assert "is replaced by a diffuse one" in texts[0]
