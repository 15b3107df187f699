# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes other than Principled BSDF, and how they are mixed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from eclat.scene import Material, NormalMap, Value, grey

from .fields import Field, constant
from .links import Found, follow
from .node_values import NodeValues
from .surfaces import CLEAR, Surface, added, mixed

MOST_RADIANCE = 1e6
"""Bound on the radiance of images that glow."""


@dataclass
class Shading:
    """What the shaders of one material share: the values of its nodes, and the UV maps that its images use."""

    values: NodeValues
    uv_maps: list[str] = field(default_factory=lambda: [""])
    uses_images: bool = False

    def uv_set(self, name: str) -> int:
        """Number the UV map `name`, of which a material may have two: that which renders, and one by name."""
        self.uses_images = True
        if name not in self.uv_maps:
            if len(self.uv_maps) == 2:
                self.values.refuse(f"the UV map {name!r} is a third one, and that which renders is used instead")
                return 0
            self.uv_maps.append(name)
        return self.uv_maps.index(name)

    def value(self, found: Field, high: float = 1.0) -> Value:
        """Make an Éclat value of a field."""
        return found.value(self.uv_set, 0.0, high)

    def roughness(self, found: Field) -> Value:
        """Make the α of GGX, the square of Blender's roughness."""
        return replace(self.value(found), square=True)

    def plain(self, found: Found, name: str) -> float:
        """Return a number that Éclat cannot vary over a surface; the mean of an image, which is named."""
        got = self.values.input(found, name)
        if not got.is_constant:
            self.values.refuse(f"{name!r} cannot vary over the surface; the mean of its image is used")
        return got.number

    def unsupported(self, found: Found, *names: str) -> None:
        """Name the inputs in `names` that are not 0."""
        for name in names:
            if name in found.node.inputs:
                got = self.values.input(found, name)
                if not got.is_constant or got.number != 0:
                    self.values.refuse(f"{name!r} is not supported and is left out")

    def normal_map(self, found: Found, name: str = "Normal") -> NormalMap | None:
        """Read the Normal Map or Bump node at the input `name`."""
        if name not in found.node.inputs:
            return None
        at = follow(found.node.inputs[name], found.groups)
        if at.node is None:
            return None
        if at.node.type == "NORMAL_MAP" and at.node.space == "TANGENT":
            color = self.values.of(at.node.inputs["Color"], at.groups)
            if color.is_constant:
                return None
            return NormalMap(self.value(color), "normal", self.plain(at, "Strength"))
        if at.node.type == "BUMP":
            height = self.values.of(at.node.inputs["Height"], at.groups)
            if height.is_constant:
                return None
            sign = -1.0 if at.node.invert else 1.0
            depth = sign * self.plain(at, "Strength") * self.plain(at, "Distance")
            return NormalMap(self.value(height), "bump", depth)
        self.values.refuse(f"the normals of the node {at.node.name!r} ({at.node.bl_label}) are not supported")
        return None

    def surface(self, socket: Any, groups: tuple[Any, ...] = ()) -> Surface:
        """Read the shader at an input."""
        found = follow(socket, groups)
        if found.node is None:
            return Surface(None, None)
        maker = SHADERS.get(found.node.type)
        if maker is not None:
            return maker(self, found)
        self.values.refuse(f"the shader {found.node.name!r} ({found.node.bl_label}) is replaced by a diffuse one")
        color = self.values.input(found, "Color") if "Color" in found.node.inputs else constant(0.8)
        return Surface(Material("diffuse", {"reflectance": self.value(color)}))


def _diffuse(shading: Shading, found: Found) -> Surface:
    if shading.plain(found, "Roughness") > 0:
        shading.values.refuse("the roughness of a diffuse surface is not supported and is left out")
    color = shading.value(shading.values.input(found, "Color"))
    return Surface(Material("diffuse", {"reflectance": color}, normal_map=shading.normal_map(found)))


def _translucent(shading: Shading, found: Found) -> Surface:
    color = shading.value(shading.values.input(found, "Color"))
    return Surface(Material("translucent", {"reflectance": grey(0), "transmittance": color}))


def _glossy(shading: Shading, found: Found) -> Surface:
    """A mirror of one colour for all directions: a conductor that reflects all light, times the colour."""
    shading.unsupported(found, "Anisotropy")
    _check_distribution(shading, found, ("GGX", "MULTI_GGX"))
    parameters = {
        "eta": grey(0),
        "k": grey(1),
        "specular_reflectance": shading.value(shading.values.input(found, "Color")),
        "alpha_u": shading.roughness(shading.values.input(found, "Roughness")),
    }
    return Surface(Material("conductor", parameters, masking="correlated", normal_map=shading.normal_map(found)))


def _glass(shading: Shading, found: Found) -> Surface:
    _check_distribution(shading, found, ("GGX", "MULTI_GGX"))
    color = shading.value(shading.values.input(found, "Color"))
    if found.node.type == "BSDF_REFRACTION":
        shading.values.refuse("the Refraction BSDF also reflects here, as glass does")
    parameters = {
        "specular_reflectance": color if found.node.type == "BSDF_GLASS" else grey(1),
        "specular_transmittance": color,
        "ior": grey(max(shading.plain(found, "IOR"), 1e-3)),
        "alpha_u": shading.roughness(shading.values.input(found, "Roughness")),
    }
    return Surface(Material("dielectric", parameters, normal_map=shading.normal_map(found)))


def _metal(shading: Shading, found: Found) -> Surface:
    shading.unsupported(found, "Anisotropy", "Thin Film Thickness")
    _check_distribution(shading, found, ("GGX", "MULTI_GGX"))
    alpha = shading.roughness(shading.values.input(found, "Roughness"))
    normal = shading.normal_map(found)
    if found.node.fresnel_type == "PHYSICAL_CONDUCTOR":
        eta, k = (Value(shading.values.input(found, name).color) for name in ("IOR", "Extinction"))
        parameters = {"eta": eta, "k": k, "alpha_u": alpha}
        return Surface(Material("conductor", parameters, masking="correlated", normal_map=normal))
    color = shading.value(shading.values.input(found, "Base Color"))
    parameters = {"base_color": color, "metallic": grey(1), "roughness": alpha}
    return Surface(Material("metallic_roughness", parameters, normal_map=normal))


def _check_distribution(shading: Shading, found: Found, known: tuple[str, ...]) -> None:
    kind = found.node.distribution
    if kind == "MULTI_GGX":
        shading.values.refuse("light that facets scatter several times (Multiscatter GGX) is left out")
    elif kind not in known:
        shading.values.refuse(f"the distribution {kind.replace('_', ' ').title()} is replaced by GGX")


def _transparent(shading: Shading, found: Found) -> Surface:
    color = shading.values.input(found, "Color")
    if color.is_constant and len({round(x, 6) for x in color.color}) > 1:
        shading.values.refuse("coloured transparency is not supported; its brightness is kept")
    dark = color.grey().mapped(lambda x: 1 - x.clip(0, 1))
    return Surface(None, None, dark if not color.is_constant or dark.number > 0 else CLEAR)


def _emission(shading: Shading, found: Found) -> Surface:
    return Surface(None, glow(shading, found, "Color", "Strength"))


def glow(shading: Shading, found: Found, color: str, strength: str) -> Field | None:
    """Multiply the colour and the strength of emitted light; None if there is none."""
    values = shading.values
    light = values.join(lambda c, s: c * s[..., :1], values.input(found, color), values.input(found, strength))
    if not (light.texels[..., :3] > 0).any():
        return None
    return light.mapped(lambda x: x.clip(0, MOST_RADIANCE))


def _mix(shading: Shading, found: Found) -> Surface:
    share = shading.values.input(found, 0)
    a, b = (shading.surface(found.node.inputs[index], found.groups) for index in (1, 2))
    surface, weight, fits = mixed(share, a, b)
    if not fits:
        shading.values.refuse(
            "images of different sizes or coordinates are mixed; all but one are replaced by their means"
        )
    if a.is_clear or b.is_clear:
        return replace(surface, material=b.material if a.is_clear else a.material)
    if a.material is None and b.material is None:
        return surface
    dark = Material("diffuse", {"reflectance": grey(0)})
    children = (a.material or dark, b.material or dark)
    normal = next((child.normal_map for child in children if child.normal_map is not None), None)
    blend = Material("blend", {"weight": shading.value(weight)}, children=children, normal_map=normal)
    return replace(surface, material=blend)


def _add(shading: Shading, found: Found) -> Surface:
    a, b = (shading.surface(found.node.inputs[index], found.groups) for index in (0, 1))
    surface, whole = added(a, b)
    if not whole:
        shading.values.refuse("Add Shader keeps only the first of two surfaces that reflect")
    return surface


SHADERS: dict[str, Callable[[Shading, Found], Surface]] = {
    "BSDF_DIFFUSE": _diffuse,
    "BSDF_TRANSLUCENT": _translucent,
    "BSDF_GLOSSY": _glossy,
    "BSDF_ANISOTROPIC": _glossy,
    "BSDF_GLASS": _glass,
    "BSDF_REFRACTION": _glass,
    "BSDF_METALLIC": _metal,
    "BSDF_TRANSPARENT": _transparent,
    "EMISSION": _emission,
    "MIX_SHADER": _mix,
    "ADD_SHADER": _add,
}
"""What makes a surface of each shader node; `principled` adds its own."""
