# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Convert BSDFs that contain other BSDFs: two-sided ones, masks, bump and normal maps, blends and coatings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

from eclat.errors import EclatError, warn
from eclat.loaders.mitsuba.node import Node, parse_numbers
from eclat.loaders.mitsuba.optics import relative_ior
from eclat.loaders.mitsuba.textures import Textures
from eclat.scene import Material, NormalMap, Value, grey

_MAX_MIXTURE = 32
"""The largest number of BSDFs in a mixture. Real scenes have two or three."""
_TRANSPARENT = ("dielectric", "thin_dielectric", "translucent")
"""The kinds of materials that transmit light and are therefore two-sided in any case."""


class MaterialReader(Protocol):
    """The interface through which this module converts the nested BSDFs and the properties of a BSDF.

    `Materials` implements it. All methods raise EclatError for values that are invalid.
    """

    textures: Textures

    def of(self, node: Node) -> Material:
        """Convert the BSDF `node` to a material."""

    def reflectance(self, node: Node, *names: str, default: float = 0.5) -> Value:
        """Return the colour in 0..1, or the texture, of the first property in `names` that `node` has."""

    def scalar(self, node: Node, *names: str, default: float) -> Value:
        """Return the number, or the texture, of the first property in `names` that `node` has."""

    def roughness(self, node: Node, default: float) -> dict[str, Value]:
        """Return the roughness alpha_u and, if it differs, alpha_v."""


def nested(node: Node) -> list[Node]:
    """Return the BSDFs inside a BSDF."""
    return [child for _, child in node.of_tag("bsdf")]


def _one(node: Node) -> Node:
    inside = nested(node)
    if not inside:
        raise EclatError(f"{node.where}: expected one nested BSDF, got none")
    if len(inside) > 1:
        warn(f"{node.where}: expected one nested BSDF, got {len(inside)}; the first one is used")
    return inside[0]


def _texture(node: Node, name: str) -> Node:
    """Return the texture of a bump or normal map: the property `name`, or the first nested texture of any name."""
    given = node.get(name)
    if isinstance(given, Node):
        return given
    textures = [child for _, child in node.of_tag("texture")]
    if not textures:
        raise EclatError(f"{node.where}: expected a nested texture, got none")
    return textures[0]


def _twosided(materials: MaterialReader, node: Node) -> Material:
    inside = nested(node)
    if len(inside) not in (1, 2):
        raise EclatError(f"{node.where}: expected one or two nested BSDFs, got {len(inside)}")
    front = materials.of(inside[0])
    if front.kind in _TRANSPARENT:
        warn(f"{node.where}: twosided is ignored, because the BSDF {inside[0].type!r} is always two-sided")
        return front
    back = _on_both_sides(materials.of(inside[1])) if len(inside) == 2 else None
    return replace(_on_both_sides(front), back=back)


def _on_both_sides(material: Material) -> Material:
    children = tuple(_on_both_sides(child) for child in material.children)
    return replace(material, two_sided=True, children=children)


def _mask(materials: MaterialReader, node: Node) -> Material:
    opacity = materials.scalar(node, "opacity", default=0.5)
    inner = materials.of(_one(node))
    other = inner.opacity
    if other.texture is None:
        return replace(inner, opacity=replace(opacity, constant=_times(opacity, other.constant[0])))
    if opacity.texture is not None:
        warn(f"{node.where}: textured masks inside each other are not supported; the inner one is ignored")
        return replace(inner, opacity=opacity)
    return replace(inner, opacity=replace(other, constant=_times(other, opacity.constant[0])))


def _bump(materials: MaterialReader, node: Node) -> Material:
    value = materials.textures.of(_texture(node, "bumpmap"), node, "bumpmap", "scalar")
    height = node.number("scale", default=1.0) * value.constant[0]
    inner = materials.of(_one(node))
    if value.texture is None:
        return inner  # a constant height does not change normals
    return _with_normals(inner, NormalMap(replace(value, constant=(1.0, 1.0, 1.0)), "bump", height), node)


def _normalmap(materials: MaterialReader, node: Node) -> Material:
    value = materials.textures.of(_texture(node, "normalmap"), node, "normalmap", "normal")
    return _with_normals(materials.of(_one(node)), NormalMap(value), node)


def _with_normals(inner: Material, normals: NormalMap, node: Node) -> Material:
    if inner.normal_map is not None:
        warn(f"{node.where}: bump or normal maps inside each other are not supported; the inner one is ignored")
    return replace(inner, normal_map=normals)


def _blend(materials: MaterialReader, node: Node) -> Material:
    inside = nested(node)
    if len(inside) != 2:
        raise EclatError(f"{node.where}: expected two nested BSDFs, got {len(inside)}")
    weight = materials.scalar(node, "weight", default=0.5)
    return _blended(materials.of(inside[0]), materials.of(inside[1]), weight, node)


def _blended(first: Material, second: Material, weight: Value, node: Node) -> Material:
    """Blend two materials: `weight` is the share of `second`.

    Each of them keeps its own sides, and the blend is two-sided if one of them is. Light that one of them lets straight
    through, because it is a mask or null, passes the blend, too.
    """
    both = first.two_sided or second.two_sided
    opacity, weight = _blended_opacity(first.opacity, second.opacity, weight, node)
    maps = [child.normal_map for child in (first, second) if child.normal_map is not None]
    if len({id(one) for one in maps}) > 1 or len(maps) == 1:
        warn(
            f"{node.where}: bump and normal maps of only one part of a {node.type} are not supported; that of the first part "
            "that has one is used for all of it"
        )
    children = tuple(replace(child, opacity=grey(1.0), normal_map=None) for child in (first, second))
    normal_map = maps[0] if maps else None
    return Material(
        "blend", {"weight": weight}, two_sided=both, children=children, opacity=opacity, normal_map=normal_map
    )


def _blended_opacity(first: Value, second: Value, weight: Value, node: Node) -> tuple[Value, Value]:
    """Return the opacity of a blend of two opacities, (1 − w) a + w b, and the share of the second material in what is
    opaque, w b / ((1 − w) a + w b). Where a texture keeps a `Value` from holding these, there is a warning.
    """
    if _same(first, second):
        return first, weight
    if first.texture is None and second.texture is None:
        a, b = first.constant[0], second.constant[0]
        if weight.texture is None:
            w = weight.constant[0]
            opaque = (1 - w) * a + w * b
            return grey(opaque), grey(w * b / opaque if opaque > 0 else 0.0)
        if a == 0:
            return replace(weight, constant=_times(weight, b)), grey(1.0)
        if b == 0 and weight.constant[0] == 1:
            return replace(weight, constant=(a, a, a), invert=not weight.invert), grey(0.0)
    warn(
        f"{node.where}: a mask inside a {node.type} is not supported beside a texture of the weight or another mask; the "
        "blend is opaque"
    )
    return grey(1.0), weight


def _same(a: Value, b: Value) -> bool:
    return a is b or (a.texture is None and b.texture is None and a.constant == b.constant)


def _times(value: Value, factor: float) -> tuple[float, float, float]:
    r, g, b = value.constant
    return r * factor, g * factor, b * factor


def _mixture(materials: MaterialReader, node: Node) -> Material:
    """Convert a mixture of several BSDFs to nested blends. If the weights add up to less than 1, the rest absorbs."""
    weights = parse_numbers(node.string("weights"), f"{node.where}, weights")
    parts = [materials.of(child) for child in nested(node)]
    if not parts or len(weights) != len(parts) or len(parts) > _MAX_MIXTURE or min(weights) < 0:
        raise EclatError(
            f"{node.where}: expected 1 to {_MAX_MIXTURE} nested BSDFs and the same number of non-negative weights, "
            f"got {len(parts)} BSDFs and the weights {weights[:_MAX_MIXTURE]}"
        )
    total = sum(weights)
    if total > 1.001:
        warn(f"{node.where}: expected weights whose sum is at most 1, got {total:.4g}; they are scaled to a sum of 1")
    elif total < 0.999:
        parts.append(Material("diffuse", {"reflectance": grey(0.0)}, two_sided=False))
        weights.append(1 - total)
    result, so_far = parts[-1], weights[-1]
    for part, weight in zip(reversed(parts[:-1]), reversed(weights[:-1]), strict=True):
        so_far += weight
        result = _blended(part, result, grey((so_far - weight) / so_far if so_far > 0 else 0.0), node)
    return result


def _coating(materials: MaterialReader, node: Node) -> Material:
    """Convert a coating: over a diffuse BSDF it becomes plastic, and over any other BSDF it is left out."""
    inner = materials.of(_one(node))
    ior = relative_ior(node, "bk7")
    for name in ("thickness", "sigma_a"):
        if node.get(name) not in (None, 0.0):
            warn(f"{node.where}: the property {name} is not supported and is ignored")
    specular = materials.reflectance(node, "specular_reflectance", default=1.0)
    rough = node.type == "roughcoating"
    alpha = materials.roughness(node, 0.1)["alpha_u"] if rough else grey(0.0)
    if inner.kind != "diffuse":
        warn(
            f"{node.where}: {node.type} is only supported over a diffuse BSDF, got {inner.kind}, which is used without "
            "the coating"
        )
        return inner
    warn(f"{node.where}: {node.type} over a diffuse BSDF is replaced by plastic with the same refractive index")
    base = inner.parameters.get("reflectance", grey(0.5))
    parameters = {"diffuse_reflectance": base, "specular_reflectance": specular, "ior": grey(ior), "alpha_u": alpha}
    beckmann = rough and node.string("distribution", default="beckmann").lower() != "ggx"
    return replace(inner, kind="plastic", parameters=parameters, distribution="beckmann" if beckmann else "ggx")


def _null(materials: MaterialReader, node: Node) -> Material:
    return Material("diffuse", {"reflectance": grey(0.0)}, opacity=grey(0.0))


WRAPPERS: dict[str, Callable[[MaterialReader, Node], Material]] = {
    "twosided": _twosided,
    "mask": _mask,
    "bump": _bump,
    "bumpmap": _bump,
    "normalmap": _normalmap,
    "blendbsdf": _blend,
    "mixturebsdf": _mixture,
    "coating": _coating,
    "roughcoating": _coating,
    "null": _null,
}
