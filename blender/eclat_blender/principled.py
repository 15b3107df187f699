# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Principled BSDF as Éclat's material of base colour, metalness and roughness."""

from __future__ import annotations

import math

import numpy as np

from eclat.scene import Material, Value, grey

from .fields import Field
from .links import Found
from .shaders import SHADERS, Shading, glow
from .surfaces import CLEAR, Surface

LEFT_OUT = (
    "Subsurface Weight",
    "Anisotropic",
    "Sheen Weight",
    "Coat Weight",
    "Thin Film Thickness",
    "Diffuse Roughness",
)
"""Inputs that Éclat's materials do not have; they are named where they are not 0."""

LEAST_SHARE = 1e-3
"""Share of the opaque part below which its metalness no longer matters."""

USUAL_LEVEL = 0.5
"""Blender's specular level at which the index of refraction alone determines the reflectance."""


def principled(shading: Shading, found: Found) -> Surface:
    """Read a Principled BSDF.

    The light that it transmits takes the square root of the base colour at each of the two surfaces that it crosses, so
    glass is a material of its own, which is blended with the opaque part.
    """
    shading.unsupported(found, *LEFT_OUT)
    if found.node.distribution == "MULTI_GGX":
        shading.values.refuse("light that facets scatter several times (Multiscatter GGX) is left out")
    values = shading.values
    color, metallic, transmission = (
        values.input(found, name).mapped(lambda x: x.clip(0, 1))
        for name in ("Base Color", "Metallic", "Transmission Weight")
    )
    glass = values.join(lambda t, m: t * (1 - m), transmission, metallic)
    metal = values.join(lambda m, g: m / np.maximum(1 - g, LEAST_SHARE), metallic, glass)
    normal = shading.normal_map(found)

    def part(base: Field, metal: Field, share: float) -> Material:
        parameters = {
            "base_color": shading.value(base),
            "metallic": shading.value(metal),
            "roughness": shading.roughness(values.input(found, "Roughness")),
            "transmission": grey(share),
            **_specular(shading, found, share == 0),
        }
        return Material("metallic_roughness", parameters, thin_walled=False, normal_map=normal)

    root = color.mapped(np.sqrt)
    if glass.is_constant and glass.number <= 0:
        material = part(color, metal, 0)
    elif glass.is_constant and glass.number >= 1:
        material = part(root, CLEAR, 1)
    else:
        children = (part(color, metal, 0), part(root, CLEAR, 1))
        material = Material("blend", {"weight": shading.value(glass)}, children=children, normal_map=normal)
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
