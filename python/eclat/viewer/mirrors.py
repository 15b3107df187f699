# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What surfaces mirror, where the page has no records of radiance for their gloss and shows an approximation."""

from __future__ import annotations

import numpy as np

from eclat.gltf_export.textures import average, constant_of
from eclat.scene import DEFAULTS, FloatArray, Material, grey

COSINES = 32
"""Number of entries of the table of reflectances."""


def reflectance_of(material: Material) -> FloatArray:
    """Return the share (COSINES, 3) of light that the coat of a material mirrors, at the cosines 0, 1/(n − 1), …, 1 between
    direction and normal: Fresnel's formulas for a smooth interface, times the material's colour. The metallic part of
    metallic_roughness is not in it, because a texture may say where that is."""
    cosines = np.linspace(0, 1, COSINES)[:, None]

    def color(name: str) -> FloatArray:
        return np.array(constant_of(average(material.parameters.get(name, DEFAULTS[name]))), np.float64)

    if material.kind == "conductor":
        return color("specular_reflectance") * conductor_fresnel(cosines, color("eta"), color("k"))
    if material.kind == "plastic":
        return color("specular_reflectance") * dielectric_fresnel(cosines, color("ior"))
    if material.kind in ("dielectric", "thin_dielectric"):
        # What both faces of a pane mirror, to and fro between them; a solid is taken for one.
        face = dielectric_fresnel(cosines, color("ior"))
        return color("specular_reflectance") * 2 * face / (1 + face)
    if material.kind in ("phong", "ward"):
        return np.broadcast_to(color("specular_reflectance"), (COSINES, 3)).copy()
    if material.kind == "metallic_roughness":
        # KHR_materials_specular: F = specular (f0 + (1 − f0) (1 − cos)⁵), f0 of the index of refraction and the colour
        f0 = np.minimum(color("specular_color") * ((color("ior") - 1) / (color("ior") + 1)) ** 2, 1)
        return color("specular") * (f0 + (1 - f0) * (1 - cosines) ** 5)
    return np.zeros((COSINES, 3))


def alpha_of(material: Material) -> float:
    """Return the mean roughness α of the gloss of a material. For Phong it is that of the GGX lobe of the same width."""

    def mean(name: str) -> float:
        return float(np.mean(constant_of(average(material.parameters.get(name, DEFAULTS[name])))))

    if material.kind in ("dielectric", "thin_dielectric"):
        return float(np.mean(constant_of(average(material.parameters.get("alpha_u", grey(0))))))
    if material.kind == "phong":
        return float(np.sqrt(2 / (mean("exponent") + 2)))
    return mean("roughness" if material.kind == "metallic_roughness" else "alpha_u")


def dielectric_fresnel(cosines: FloatArray, ior: FloatArray) -> FloatArray:
    """Return the reflectance of a smooth dielectric of the relative index of refraction `ior` for unpolarised light."""
    inside2 = 1 - (1 - cosines**2) / ior**2
    inside = np.sqrt(np.maximum(0, inside2))
    parallel = (ior * cosines - inside) / (ior * cosines + inside + 1e-12)
    across = (cosines - ior * inside) / (cosines + ior * inside + 1e-12)
    found: FloatArray = np.where(inside2 <= 0, 1.0, (parallel**2 + across**2) / 2)
    return found


def conductor_fresnel(cosines: FloatArray, eta: FloatArray, k: FloatArray) -> FloatArray:
    """Return the reflectance of a smooth conductor of the complex index of refraction η + i k for unpolarised light."""
    # Snell's law with a complex index: the dielectric formulas hold with complex cosines inside.
    index = eta + 1j * k
    inside = np.sqrt(1 - (1 - cosines**2) / index**2)
    parallel = (index * cosines - inside) / (index * cosines + inside)
    across = (cosines - index * inside) / (cosines + index * inside)
    found: FloatArray = (np.abs(parallel) ** 2 + np.abs(across) ** 2) / 2
    return found
