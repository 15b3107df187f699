# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Convert BSDFs to instances of `Material`. `wrappers` converts the BSDFs that contain others."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Literal

from eclat.errors import did_you_mean, warn
from eclat.loaders.brdf_files import LARGEST_FILE, parse_brdf
from eclat.loaders.files import read_bytes
from eclat.loaders.mitsuba import wrappers
from eclat.loaders.mitsuba.kinds import PLUGINS
from eclat.loaders.mitsuba.node import Node
from eclat.loaders.mitsuba.optics import conductor_constants, relative_ior
from eclat.loaders.mitsuba.textures import Textures, peak, uses_vertex_colors
from eclat.scene import Material, Value, grey, rgb


@dataclass
class Materials:
    """The materials of a scene. Each is converted once, so that the same node always gives the same `Material`."""

    textures: Textures = field(default_factory=Textures)
    made: dict[int, Material] = field(default_factory=dict)

    def of(self, node: Node) -> Material:
        """Convert a BSDF to a material.

        A BSDF that is not supported is replaced, with a warning. Raises EclatError if a value is invalid.
        """
        if id(node) not in self.made:
            material = self._make(node)
            if uses_vertex_colors(node):
                material = replace(material, vertex_colors=True)
            self.made[id(node)] = replace(material, name=node.id or material.name)
        return self.made[id(node)]

    def _make(self, node: Node) -> Material:
        if node.type in wrappers.WRAPPERS:
            return wrappers.WRAPPERS[node.type](self, node)
        if node.type in _MAKERS:
            return _MAKERS[node.type](self, node)
        nested = wrappers.nested(node)
        if nested:
            warn(f"{node.where}: this BSDF is not supported{_suggestion(node)}; its first nested BSDF is used instead")
            return self.of(nested[0])
        warn(f"{node.where}: this BSDF is not supported{_suggestion(node)}; a diffuse BSDF is used instead")
        return _diffuse(self, node)

    def reflectance(self, node: Node, *names: str, default: float = 0.5) -> Value:
        """Return the colour in 0..1, or the texture, of the first property in `names` that `node` has."""
        return self.textures.value(node, *names, default=default, kind="reflectance")

    def scalar(self, node: Node, *names: str, default: float) -> Value:
        """Return the number, or the texture, of the first property in `names` that `node` has."""
        return self.textures.value(node, *names, default=default, kind="scalar")

    def roughness(self, node: Node, default: float) -> dict[str, Value]:
        """Return the roughness alpha_u and, if it differs, alpha_v."""
        alpha = self.scalar(node, "alpha", default=default)
        u = self.scalar(node, "alpha_u", default=0.0) if node.get("alpha_u") is not None else alpha
        v = self.scalar(node, "alpha_v", default=0.0) if node.get("alpha_v") is not None else alpha
        same = u is v or (u.texture is None and v.texture is None and u.constant == v.constant)
        return {"alpha_u": u} if same else {"alpha_u": u, "alpha_v": v}


def known_kinds() -> list[str]:
    """Return the types of BSDFs that can be converted, exactly or approximately."""
    return sorted({*_MAKERS, *wrappers.WRAPPERS})


def default_material(*, emissive: bool = False) -> Material:
    """Return the material of a shape without a BSDF, as in Mitsuba: diffuse grey, or black if the shape has an emitter."""
    return Material("diffuse", {"reflectance": grey(0.0 if emissive else 0.5)}, two_sided=False)


def _suggestion(node: Node) -> str:
    return "" if node.type in PLUGINS["bsdf"] else did_you_mean(node.type, PLUGINS["bsdf"])


def _diffuse(materials: Materials, node: Node) -> Material:
    color = materials.reflectance(node, "reflectance", "diffuse_reflectance")
    return Material("diffuse", {"reflectance": color}, two_sided=False)


def _roughdiffuse(materials: Materials, node: Node) -> Material:
    node.get("alpha", "use_fast_approx")
    warn(f"{node.where}: the roughness of roughdiffuse is not supported; a smooth diffuse BSDF is used instead")
    return _diffuse(materials, node)


def _difftrans(materials: Materials, node: Node) -> Material:
    color = materials.reflectance(node, "transmittance", "reflectance")
    return Material("translucent", {"reflectance": grey(0.0), "transmittance": color})


def _hk(materials: Materials, node: Node) -> Material:
    warn(f"{node.where}: scattering layers (hk) are not supported; a diffuse BSDF with their albedo is used instead")
    return Material("diffuse", {"reflectance": materials.reflectance(node, "albedo", "reflectance")}, two_sided=False)


def _conductor(materials: Materials, node: Node) -> Material:
    eta, k = conductor_constants(node)
    parameters = {
        "eta": rgb(*eta),
        "k": rgb(*k),
        "specular_reflectance": materials.reflectance(node, "specular_reflectance", default=1.0),
    }
    if node.type == "conductor":
        return Material("conductor", parameters, two_sided=False)
    parameters |= materials.roughness(node, 0.1)
    return Material("conductor", parameters, two_sided=False, distribution=_distribution(node))


def _dielectric(materials: Materials, node: Node) -> Material:
    parameters = {
        "specular_reflectance": materials.reflectance(node, "specular_reflectance", default=1.0),
        "specular_transmittance": materials.reflectance(node, "specular_transmittance", default=1.0),
        "ior": grey(relative_ior(node, "bk7")),
    }
    if node.type == "thindielectric":
        return Material("thin_dielectric", parameters)
    if node.type == "dielectric":
        return Material("dielectric", parameters)
    parameters |= materials.roughness(node, 0.1)
    return Material("dielectric", parameters, distribution=_distribution(node))


def _plastic(materials: Materials, node: Node) -> Material:
    parameters = {
        "diffuse_reflectance": materials.reflectance(node, "diffuse_reflectance"),
        "specular_reflectance": materials.reflectance(node, "specular_reflectance", default=1.0),
        "ior": grey(relative_ior(node, "polypropylene")),
    }
    rough = node.type != "plastic"
    if rough:
        parameters["alpha_u"] = materials.roughness(node, 0.1)["alpha_u"]
    nonlinear = node.boolean("nonlinear", default=False)
    distribution = _distribution(node) if rough else "ggx"
    return Material("plastic", parameters, two_sided=False, nonlinear=nonlinear, distribution=distribution)


def _measured(materials: Materials, node: Node) -> Material:
    """Convert a measured BRDF. Its property `scale` and the type merl are additions of Éclat."""
    path = node.file("filename")
    brdf = parse_brdf(read_bytes(path, where=f"{node.where}, filename", limit=LARGEST_FILE), path.name)
    scale = materials.reflectance(node, "scale", default=1.0)
    return Material("measured", {"scale": scale}, two_sided=False, measured=brdf)


def _phong(materials: Materials, node: Node) -> Material:
    colors = _energy(materials, node)
    return Material("phong", colors | {"exponent": materials.scalar(node, "exponent", default=30.0)}, two_sided=False)


def _ward(materials: Materials, node: Node) -> Material:
    colors = _energy(materials, node)
    variant = node.string("variant", default="balanced").lower()
    roughness = materials.roughness(node, 0.1)
    roughness.setdefault("alpha_v", roughness["alpha_u"])
    if variant == "ward":
        warn(
            f"{node.where}: the variant 'ward' is not supported, because it loses energy at grazing angles; "
            "the variant 'balanced' is used instead"
        )
    parameters = colors | roughness
    return Material("ward", parameters, two_sided=False, ward_variant="duer" if variant == "ward-duer" else "bounded")


def _energy(materials: Materials, node: Node) -> dict[str, Value]:
    """Return the diffuse and the specular reflectance.

    Both are scaled down, with a warning, if their sum exceeds 1 at the brightest texels of their textures.
    """
    diffuse = materials.reflectance(node, "diffuse_reflectance")
    specular = materials.reflectance(node, "specular_reflectance", default=0.2)
    total = float((peak(diffuse) + peak(specular)).max())
    if total > 1:
        warn(
            f"{node.where}: expected diffuse_reflectance + specular_reflectance of at most 1, got {total:.4g}; both are "
            "divided by this sum"
        )
        diffuse, specular = (_scaled(value, 1 / total) for value in (diffuse, specular))
    return {"diffuse_reflectance": diffuse, "specular_reflectance": specular}


def _scaled(value: Value, factor: float) -> Value:
    r, g, b = (float(x) * factor for x in value.constant)
    return replace(value, constant=(r, g, b))


_PRINCIPLED_IGNORED = (
    "anisotropic",
    "spec_tint",
    "sheen",
    "sheen_tint",
    "clearcoat",
    "clearcoat_gloss",
    "flatness",
)


def _principled(materials: Materials, node: Node) -> Material:
    ignored = [name for name in _PRINCIPLED_IGNORED if node.get(name) not in (None, 0, 0.0)]
    if ignored:
        warn(f"{node.where}: these properties of {node.type} are not supported and are ignored: {', '.join(ignored)}")
    thin = node.type == "principledthin"
    transmission = materials.scalar(node, "spec_trans", default=0.0)
    transparent = transmission.texture is not None or max(transmission.constant) > 0
    parameters = {
        "base_color": materials.reflectance(node, "base_color"),
        "metallic": materials.scalar(node, "metallic", default=0.0),
        # GGX α is the square of Disney's roughness.
        "roughness": replace(materials.scalar(node, "roughness", default=0.5), square=True),
        "ior": grey(_principled_ior(node)),
        "transmission": transmission,
    }
    if thin:
        # Mitsuba counts from 0 to 2: from 0, where all of the diffuse light is reflected, to 2, where all goes through.
        through = materials.scalar(node, "diff_trans", default=0.0)
        parameters["diffuse_transmission"] = _scaled(through, 0.5)
        parameters["diffuse_transmission_color"] = parameters["base_color"]
    return Material("metallic_roughness", parameters, two_sided=transparent or thin, thin_walled=thin)


def _principled_ior(node: Node) -> float:
    """Return the refractive index of a principled BSDF.

    It is `eta`, or it is computed from `specular`, whose range 0..1 means a reflectance of 0..8 % at normal incidence.
    """
    if node.get("eta") is not None:
        return relative_ior(node, "bk7")
    root = math.sqrt(0.08 * min(max(node.number("specular", default=0.5), 0.0), 1.0))
    return 2 / (1 - root) - 1


def _distribution(node: Node) -> Literal["ggx", "beckmann"]:
    """Return the microfacet distribution. The default is Beckmann, as in Mitsuba."""
    name = node.string("distribution", default="beckmann").lower()
    if name == "ggx":
        return "ggx"
    if name != "beckmann":
        warn(f"{node.where}, distribution: expected ggx or beckmann, got {name[:40]!r}; beckmann is used")
    return "beckmann"


_MAKERS: dict[str, Callable[[Materials, Node], Material]] = {
    "diffuse": _diffuse,
    "lambertian": _diffuse,
    "roughdiffuse": _roughdiffuse,
    "difftrans": _difftrans,
    "hk": _hk,
    "conductor": _conductor,
    "roughconductor": _conductor,
    "dielectric": _dielectric,
    "thindielectric": _dielectric,
    "roughdielectric": _dielectric,
    "plastic": _plastic,
    "roughplastic": _plastic,
    "pplastic": _plastic,
    "measured": _measured,
    "merl": _measured,
    "phong": _phong,
    "ward": _ward,
    "principled": _principled,
    "principledthin": _principled,
}
