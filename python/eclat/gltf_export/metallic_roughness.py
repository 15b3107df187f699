# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Convert any material to the metallic-roughness model of glTF, with warnings about approximations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eclat.errors import warn
from eclat.gltf_export.textures import average, constant_of
from eclat.measured_brdf import normal_albedo
from eclat.scene import DEFAULTS, Material, Value, grey, rgb


def as_metallic_roughness(material: Material) -> Material:
    """Convert `material` to the kind "metallic_roughness", without `back` and `children`."""
    if material.kind == "metallic_roughness":
        return material
    if material.kind == "blend":
        return _blended(material)
    parameters = _CONVERSIONS[material.kind](material)
    if material.kind not in ("diffuse", "dielectric", "thin_dielectric", "translucent"):
        warn(f"material {material.name!r}: {material.kind} is approximated by the metallic-roughness model of glTF")
    return replace(
        material,
        kind="metallic_roughness",
        parameters=parameters,
        thin_walled=material.kind != "dielectric",
        children=(),
        back=None,
    )


def _of(material: Material, name: str) -> Value:
    return material.parameters.get(name, DEFAULTS[name])


def _diffuse(material: Material) -> dict[str, Value]:
    return {
        "base_color": _of(material, "reflectance"),
        "metallic": grey(0),
        "roughness": grey(1),
        # With a nonzero specular factor, the surface would have a dielectric coating.
        "specular": grey(0),
    }


def _translucent(material: Material) -> dict[str, Value]:
    """Return the parameters of a translucent material.

    glTF splits one diffuse component into reflection and transmission. Its factor is the fraction of the scattered light
    that is transmitted.
    """
    back, through = (constant_of(average(_of(material, name))) for name in ("reflectance", "transmittance"))
    textured = any(_of(material, name).texture is not None for name in ("reflectance", "transmittance"))
    if textured:
        warn(f"material {material.name!r}: the textures of a translucent material are replaced by their mean values")
    share = max(through) / (max(back) + max(through)) if max(through) > 0 else 0.0
    first = [x / (1 - share) if share < 1 else 0.0 for x in back]
    second = [x / share if share > 0 else 1.0 for x in through]
    return {
        "base_color": rgb(first[0], first[1], first[2]),
        "metallic": grey(0),
        "roughness": grey(1),
        "specular": grey(0),
        "diffuse_transmission": grey(share),
        "diffuse_transmission_color": rgb(second[0], second[1], second[2]),
    }


def _coated(material: Material, alpha: Value) -> dict[str, Value]:
    """Return the parameters of a diffuse base with a specular GGX lobe.

    `alpha` is the GGX roughness α. The reflectance of the lobe at normal incidence is `specular_reflectance`. In glTF,
    it is 4 % of the specular colour.
    """
    r, g, b = constant_of(average(_of(material, "specular_reflectance")))
    return {
        "base_color": _of(material, "diffuse_reflectance"),
        "metallic": grey(0),
        "roughness": alpha,
        "specular_color": rgb(r / 0.04, g / 0.04, b / 0.04),
    }


def _phong(material: Material) -> dict[str, Value]:
    exponent = constant_of(average(_of(material, "exponent")))[0]
    # α is chosen for equal curvature of both lobes at their peak: cosⁿ θ ≈ 1 − n θ²/2, and GGX is proportional to
    # 1 − 2 (θ/2)²/α² near the mirror direction.
    return _coated(material, grey(min(1.0, (1 / max(exponent, 1.0)) ** 0.5)))


def _ward(material: Material) -> dict[str, Value]:
    return _coated(material, _of(material, "alpha_u"))


def _plastic(material: Material) -> dict[str, Value]:
    return {
        "base_color": _of(material, "diffuse_reflectance"),
        "metallic": grey(0),
        "roughness": _of(material, "alpha_u"),
        "ior": _of(material, "ior"),
        "specular_color": average(_of(material, "specular_reflectance")),
    }


def _conductor(material: Material) -> dict[str, Value]:
    eta, k = (constant_of(_of(material, name)) for name in ("eta", "k"))
    # The base colour of a metal is its Fresnel reflectance at normal incidence.
    r, g, b = (((n - 1) ** 2 + x * x) / ((n + 1) ** 2 + x * x) for n, x in zip(eta, k, strict=True))
    specular = _of(material, "specular_reflectance")
    scaled = (specular.constant[0] * r, specular.constant[1] * g, specular.constant[2] * b)
    return {
        "base_color": replace(specular, constant=scaled),
        "metallic": grey(1),
        "roughness": _of(material, "alpha_u"),
    }


def _glass(material: Material) -> dict[str, Value]:
    return {
        "base_color": _of(material, "specular_transmittance"),
        "metallic": grey(0),
        "roughness": material.parameters.get("alpha_u", grey(0)),
        "ior": _of(material, "ior"),
        "transmission": grey(1),
    }


def _measured(material: Material) -> dict[str, Value]:
    """Return a diffuse surface with the albedo along the normal."""
    albedo = np.zeros(3) if material.measured is None else normal_albedo(material.measured)
    red, green, blue = np.minimum(albedo * constant_of(average(_of(material, "scale"))), 1).tolist()
    return {"base_color": rgb(red, green, blue), "metallic": grey(0), "roughness": grey(1), "specular": grey(0)}


_CONVERSIONS = {
    "diffuse": _diffuse,
    "phong": _phong,
    "ward": _ward,
    "plastic": _plastic,
    "conductor": _conductor,
    "dielectric": _glass,
    "thin_dielectric": _glass,
    "translucent": _translucent,
    "measured": _measured,
}


def _blended(material: Material) -> Material:
    """Convert a blend: two materials without textures become one with the weighted mean of their parameters.

    If one of them has a texture, only the material with the larger weight is used. A warning says which applies.
    """
    weight = constant_of(average(_of(material, "weight")))[0]
    first, second = (as_metallic_roughness(child) for child in material.children)
    chosen = second if weight > 0.5 else first
    parameters = dict(chosen.parameters)
    names = sorted(first.parameters.keys() | second.parameters.keys())
    pairs = {name: (_of(first, name), _of(second, name)) for name in names}
    if all(a.texture is None and b.texture is None for a, b in pairs.values()):
        for name, (a, b) in pairs.items():
            mixed = ((1 - weight) * x + weight * y for x, y in zip(constant_of(a), constant_of(b), strict=True))
            parameters[name] = rgb(*mixed)
        warn(
            f"material {material.name!r}: the blend is approximated by one material with the mean parameters of both of "
            "its materials"
        )
    else:
        warn(
            f"material {material.name!r}: blends of textured materials are not supported; only {chosen.name!r}, which "
            "has the larger weight, is written"
        )
    return replace(
        material,
        kind="metallic_roughness",
        parameters=parameters,
        thin_walled=chosen.thin_walled,
        normal_map=material.normal_map or chosen.normal_map,
        emission=material.emission or chosen.emission,
        children=(),
        back=None,
    )
