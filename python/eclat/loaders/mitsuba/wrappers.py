# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Bsdfs that contain other bsdfs: two-sided ones, masks, bumps, blends and coatings."""

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
_TRANSPARENT = ("dielectric", "thin_dielectric", "translucent")


class MaterialReader(Protocol):
    """The functions by which wrappers read the bsdfs that they contain and their own values."""

    textures: Textures

    def of(self, node: Node) -> Material:
        """The material of a bsdf."""

    def reflectance(self, node: Node, *names: str, default: float = 0.5) -> Value:
        """A colour between 0 and 1."""

    def scalar(self, node: Node, *names: str, default: float) -> Value:
        """A number that a texture may vary."""

    def roughness(self, node: Node, default: float) -> dict[str, Value]:
        """The roughness alpha_u, and alpha_v if it differs."""


def nested(node: Node) -> list[Node]:
    """The bsdfs inside a bsdf."""
    return [child for _, child in node.of_tag("bsdf")]


def _one(node: Node) -> Node:
    inside = nested(node)
    if not inside:
        raise EclatError(f"{node.where}: expected a bsdf inside, got none")
    if len(inside) > 1:
        warn(f"{node.where}: expected one bsdf inside, got {len(inside)}; the first is used")
    return inside[0]


def _texture(node: Node, name: str) -> Node:
    """The texture of a bump or normal map, under any property name."""
    given = node.get(name)
    if isinstance(given, Node):
        return given
    textures = [child for _, child in node.of_tag("texture")]
    if not textures:
        raise EclatError(f"{node.where}: expected a texture inside, got none")
    return textures[0]


def _twosided(materials: MaterialReader, node: Node) -> Material:
    inside = nested(node)
    if len(inside) not in (1, 2):
        raise EclatError(f"{node.where}: expected one or two bsdfs inside, got {len(inside)}")
    front = materials.of(inside[0])
    if front.kind in _TRANSPARENT:
        warn(f"{node.where}: a {inside[0].type} acts on both sides anyway; twosided is ignored")
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
        r, g, b = (x * y for x, y in zip(opacity.constant, other.constant, strict=True))
        return replace(inner, opacity=replace(opacity, constant=(r, g, b)))
    if opacity.texture is not None:
        warn(f"{node.where}: a textured mask in a textured mask; the inner one is ignored")
        return replace(inner, opacity=opacity)
    r, g, b = (x * y for x, y in zip(opacity.constant, other.constant, strict=True))
    return replace(inner, opacity=replace(other, constant=(r, g, b)))


def _bump(materials: MaterialReader, node: Node) -> Material:
    value = materials.textures.of(_texture(node, "bumpmap"), node, "bumpmap", "scalar")
    height = node.number("scale", default=1.0) * value.constant[0]
    inner = materials.of(_one(node))
    if value.texture is None:
        return inner  # a constant height bends no normal
    return _with_normals(inner, NormalMap(replace(value, constant=(1.0, 1.0, 1.0)), "bump", height), node)


def _normalmap(materials: MaterialReader, node: Node) -> Material:
    value = materials.textures.of(_texture(node, "normalmap"), node, "normalmap", "normal")
    return _with_normals(materials.of(_one(node)), NormalMap(value), node)


def _with_normals(inner: Material, normals: NormalMap, node: Node) -> Material:
    if inner.normal_map is not None:
        warn(f"{node.where}: a bump or normal map inside another; the outer one is used")
    return replace(inner, normal_map=normals)


def _blend(materials: MaterialReader, node: Node) -> Material:
    inside = nested(node)
    if len(inside) != 2:
        raise EclatError(f"{node.where}: expected two bsdfs inside, got {len(inside)}")
    weight = materials.scalar(node, "weight", default=0.5)
    return _blended(materials.of(inside[0]), materials.of(inside[1]), weight)


def _blended(first: Material, second: Material, weight: Value) -> Material:
    """The children keep their own sides. The blend acts on the back if one of its children does."""
    both = first.two_sided or second.two_sided
    return Material("blend", {"weight": weight}, two_sided=both, children=(first, second))


def _mixture(materials: MaterialReader, node: Node) -> Material:
    """A mixture of any number of bsdfs, as nested blends. If the weights sum to less than 1, the rest absorbs light."""
    weights = parse_numbers(node.string("weights"), f"{node.where}, weights")
    parts = [materials.of(child) for child in nested(node)]
    if not parts or len(weights) != len(parts) or len(parts) > _MAX_MIXTURE or min(weights) < 0:
        raise EclatError(
            f"{node.where}: expected 1 to {_MAX_MIXTURE} bsdfs and as many weights above 0, "
            f"got {len(parts)} and {weights[:_MAX_MIXTURE]}"
        )
    total = sum(weights)
    if total > 1.001:
        warn(f"{node.where}: the weights sum to {total:.4g}; they are scaled to 1")
    elif total < 0.999:
        parts.append(Material("diffuse", {"reflectance": grey(0.0)}, two_sided=False))
        weights.append(1 - total)
    result, so_far = parts[-1], weights[-1]
    for part, weight in zip(reversed(parts[:-1]), reversed(weights[:-1]), strict=True):
        so_far += weight
        result = _blended(part, result, grey((so_far - weight) / so_far if so_far > 0 else 0.0))
    return result


def _coating(materials: MaterialReader, node: Node) -> Material:
    """A coat over a diffuse bsdf becomes plastic. Over any other bsdf it is left out."""
    inner = materials.of(_one(node))
    ior = relative_ior(node, "bk7")
    for name in ("thickness", "sigma_a"):
        if node.get(name) not in (None, 0.0):
            warn(f"{node.where}: {name} is not supported, ignored")
    specular = materials.reflectance(node, "specular_reflectance", default=1.0)
    rough = node.type == "roughcoating"
    alpha = materials.roughness(node, 0.1)["alpha_u"] if rough else grey(0.0)
    if inner.kind != "diffuse":
        warn(f"{node.where}: {node.type} is supported over diffuse only; the {inner.kind} inside it is used alone")
        return inner
    warn(f"{node.where}: {node.type} over diffuse becomes plastic of the same index of refraction")
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
