# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What surfaces mirror, where the page has no records of radiance for their gloss and shows an approximation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eclat.gltf_export.textures import average, constant_of
from eclat.scene import DEFAULTS, FloatArray, Material, grey

COSINES = 32
"""Number of entries of the table of reflectances."""

STEPS = (24, 64)
"""Azimuths and slopes of the facets over which reflectances of rough surfaces are averaged."""


def reflectance_of(material: Material) -> FloatArray:
    """Return the share (COSINES, 3) of light that the coat of a material mirrors, at the cosines 0, 1/(n − 1), …, 1 between
    direction and normal: Fresnel's formulas, averaged over the facets of rough surfaces, times the material's colour. The
    metallic part of metallic_roughness is not in it, because a texture may say where that is: see `metal_shares`."""
    facets = Facets.of(material)

    def color(name: str) -> FloatArray:
        return np.array(constant_of(average(material.parameters.get(name, DEFAULTS[name]))), np.float64)

    if material.kind == "conductor":
        return color("specular_reflectance") * facets.mean(lambda c: conductor_fresnel(c, color("eta"), color("k")))
    if material.kind == "plastic":
        return color("specular_reflectance") * facets.mean(lambda c: dielectric_fresnel(c, color("ior")))
    if material.kind in ("dielectric", "thin_dielectric"):
        # What both faces of a pane mirror, to and fro between them; a solid is taken for one.
        face = dielectric_fresnel(np.linspace(0, 1, COSINES)[:, None], color("ior"))
        return color("specular_reflectance") * 2 * face / (1 + face)
    if material.kind in ("phong", "ward"):
        return np.broadcast_to(color("specular_reflectance"), (COSINES, 3)).copy()
    if material.kind == "metallic_roughness":
        # KHR_materials_specular: F = specular (f0 + (1 − f0) (1 − cos)⁵), f0 of the index of refraction and the colour
        f0 = np.minimum(color("specular_color") * ((color("ior") - 1) / (color("ior") + 1)) ** 2, 1)
        return color("specular") * facets.mean(lambda c: f0 + (1 - f0) * (1 - c) ** 5)
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


def metal_shares(material: Material) -> FloatArray:
    """Return the shares (COSINES, 2) a and b of light that a metal of the colour f0 mirrors, f0 a + b, at the same cosines."""
    schlick = Facets.of(material).mean(lambda c: np.concatenate([1 - (1 - c) ** 5, (1 - c) ** 5], axis=-1))
    return schlick


@dataclass(frozen=True)
class Facets:
    """The facets of a rough surface [Walter07]. The albedo of the core's table (`core/bsdf/albedo_table.h`) is a fit for
    Schlick's reflectance; this mean holds for all."""

    alpha: float
    beckmann: bool
    correlated: bool

    @classmethod
    def of(cls, material: Material) -> Facets:
        """Return the facets of a material."""
        correlated = material.masking == "correlated" or material.kind == "metallic_roughness"
        return cls(alpha_of(material), material.distribution == "beckmann", correlated)

    def mean(self, reflectance: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Return the share (COSINES, C) of light that is mirrored where facets have a `reflectance` (..., C) of the cosine
        (..., 1) between them and the light."""
        cosines = np.linspace(0, 1, COSINES)
        if self.alpha < SMOOTH:
            return reflectance(cosines[:, None])
        mu = np.maximum(cosines, 0.5 / COSINES)[:, None, None]
        azimuths, slopes = ((np.arange(n) + 0.5) / n for n in STEPS)
        # Slopes in proportion to D(m) (m·n), of which this is the inverse distribution [Walter07 eq. 28, 35].
        squares = -np.log1p(-slopes) if self.beckmann else slopes / (1 - slopes)
        slope = self.alpha * np.sqrt(squares)[None]
        cosine = 1 / np.sqrt(1 + slope**2)
        toward = np.cos(np.pi * azimuths)[:, None]
        facing = cosine * (mu + np.sqrt(1 - mu**2) * slope * toward)  # wo · m
        leaving = 2 * facing * cosine - mu  # of the mirrored direction
        seen = (facing > 0) & (leaving > 0)
        masked = self._masking(mu, np.where(seen, leaving, 1))
        weight = np.where(seen, np.maximum(facing, 0) / (mu * cosine) * masked, 0)
        found = reflectance(np.clip(facing, 0, 1)[..., None])
        share: FloatArray = np.minimum((found * weight[..., None]).mean(axis=(1, 2)), 1)
        return share

    def _masking(self, out: FloatArray, into: FloatArray) -> FloatArray:
        """Return the share of facets that neither hides: G of Smith."""
        a, b = self._hidden(out), self._hidden(into)
        return 1 / (1 + a + b) if self.correlated else 1 / ((1 + a) * (1 + b))

    def _hidden(self, cosine: FloatArray) -> FloatArray:
        """Return Λ of Smith's masking [Heitz14]."""
        tangent = np.sqrt(np.maximum(0, 1 - cosine**2)) / cosine
        if not self.beckmann:
            found: FloatArray = (np.sqrt(1 + (self.alpha * tangent) ** 2) - 1) / 2
            return found
        a = 1 / np.maximum(self.alpha * tangent, 1e-9)
        rational: FloatArray = (1 - 1.259 * a + 0.396 * a**2) / (3.535 * a + 2.181 * a**2)
        return np.where(a < 1.6, rational, 0)


SMOOTH = 1e-3
"""Roughness α below which a surface is taken for smooth."""


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
