# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Principled BSDF as Éclat's material of base colour, metalness and roughness."""

from __future__ import annotations

import math

from eclat.scene import Material, Value, grey

from .fields import Field
from .links import Found
from .shaders import SHADERS, Shading, glow
from .surfaces import Surface

LEFT_OUT = ("Subsurface Weight", "Anisotropic", "Sheen Weight", "Coat Weight", "Thin Film Thickness", "Diffuse Roughness")
"""Inputs that Éclat's materials do not have; they are named where they are not 0."""

USUAL_LEVEL = 0.5
"""Blender's specular level at which the index of refraction alone determines the reflectance."""


def principled(shading: Shading, found: Found) -> Surface:
    """Read a Principled BSDF."""
    shading.unsupported(found, *LEFT_OUT)
    if found.node.distribution == "MULTI_GGX":
        shading.values.refuse("light that facets scatter several times (Multiscatter GGX) is left out")
    values = shading.values
    transmission = values.input(found, "Transmission Weight")
    clear = transmission.is_constant and transmission.number <= 0
    parameters = {
        "base_color": shading.value(values.input(found, "Base Color")),
        "metallic": shading.value(values.input(found, "Metallic")),
        "roughness": shading.roughness(values.input(found, "Roughness")),
        "transmission": shading.value(transmission),
        **_specular(shading, found, clear),
    }
    material = Material(
        "metallic_roughness", parameters, thin_walled=False, normal_map=shading.normal_map(found)
    )
    opacity = values.input(found, "Alpha").mapped(lambda x: x.clip(0, 1))
    return Surface(material, glow(shading, found, "Emission Color", "Emission Strength"), opacity)


def _specular(shading: Shading, found: Found, opaque: bool) -> dict[str, Value]:
    """Return the index of refraction and the colour of reflections.

    Blender's level scales the reflectance at normal incidence. For an opaque surface an index with the scaled reflectance
    stands for both; where light is transmitted, the index also bends it, so the level scales the colour.
    """
    values = shading.values
    ior = max(shading.plain(found, "IOR"), 1.0)
    level = values.input(found, "Specular IOR Level")
    tint = values.input(found, "Specular Tint")
    if level.is_constant and level.number <= 0:
        return {"ior": grey(ior), "specular": grey(0)}
    if level.is_constant and opaque:
        reflectance = min(((ior - 1) / (ior + 1)) ** 2 * level.number / USUAL_LEVEL, 0.99)
        root = math.sqrt(reflectance)
        return {"ior": grey((1 + root) / (1 - root)), "specular_color": shading.value(tint)}
    scaled: Field = values.join(lambda t, s: t * s[..., :1] / USUAL_LEVEL, tint, level)
    return {"ior": grey(ior), "specular_color": shading.value(scaled, 1 / USUAL_LEVEL)}


SHADERS["BSDF_PRINCIPLED"] = principled
