# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read materials: metallic-roughness and its extensions [glTF 2.0, 3.9]."""

from __future__ import annotations

import copy
from dataclasses import replace

from eclat.errors import EclatError, warn
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import Element
from eclat.loaders.gltf.textures import Textures, uv_sets
from eclat.scene import Material, NormalMap, Value, grey

Rgba = tuple[float, float, float, float]

MAX_INDEX = 100.0
"""The largest refractive index. It is also used for ior = 0, which means an infinite index (KHR_materials_ior). Its
reflectance at normal incidence is 96 %."""

_GLOSSY = "KHR_materials_pbrSpecularGlossiness"

# All members of an empty object have the defaults of the specification.
_NOTHING = Element({}, "the default material")


class Materials:
    """The materials of a document. Each is converted once, or twice if it is used with and without vertex colours."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._textures = Textures(document)
        self._made: dict[tuple[int | None, bool], Material] = {}

    def changed(self, document: Document, changed: set[int]) -> Materials:
        """Return the materials of a document in which those with the indices `changed` have other values. The others and
        all textures are shared.
        """
        materials = copy.copy(self)
        materials._document = document
        materials._made = {key: made for key, made in self._made.items() if key[0] not in changed}
        return materials

    def of(self, primitive: Element, vertex_colors: bool) -> Material:
        """Return the material of a primitive. If it refers to none, this is the default material of the specification.

        Raises EclatError if the material is invalid.
        """
        elements = self._document.elements("materials")
        index = primitive.index("material", len(elements), "materials")
        key = (index, vertex_colors)
        if key not in self._made:
            element = _NOTHING if index is None else elements[index]
            name = "default" if index is None else element.text("name") or f"materials[{index}]"
            self._made[key] = self._make(element, name, vertex_colors)
        return self._made[key]

    def ignores_alpha(self, primitive: Element) -> bool:
        """Return whether the material of a primitive is opaque, so that the alpha of textures and vertex colours is
        ignored.
        """
        element = self._document.element(primitive, "material", "materials")
        return element is None or element.text("alphaMode", "OPAQUE") == "OPAQUE"

    def _make(self, element: Element, name: str, vertex_colors: bool) -> Material:
        glossy = element.extension(_GLOSSY) if element.child("pbrMetallicRoughness") is None else None
        pbr = _metallic_roughness(element, glossy)
        factor = _base_factor(pbr)
        opacity, cutoff = self._opacity(element, pbr, factor[3])
        both_sides = emits_twice = element.flag("doubleSided")
        note = element.eclat_extras()
        if note is not None and note.flag("two_sided"):
            # Éclat wrote this two-sided surface as two meshes. The mesh of the back side is not loaded.
            both_sides, emits_twice = True, note.flag("emission_two_sided")
        black = note is not None and note.flag("black_back")
        material = Material(
            name=name, two_sided=both_sides, back_culled=not (both_sides or black), opacity=opacity, alpha_cutoff=cutoff
        )
        if element.extension("KHR_materials_unlit") is not None:
            if vertex_colors:
                warn(f"{element.where}: vertex colours of unlit materials are not supported and are ignored")
            return replace(
                material,
                kind="diffuse",
                parameters={"reflectance": grey(0.0)},
                emission=self._base_color(pbr, factor),
                emission_two_sided=emits_twice,
            )
        return replace(
            material,
            kind="metallic_roughness",
            parameters=self._surface(pbr, factor) | self._dielectric(element) | self._glossy(glossy),
            thin_walled=_is_thin(element),
            vertex_colors=vertex_colors,
            normal_map=self._normal_map(element),
            emission=self._emission(element),
            # Back faces are shaded like front faces with the reversed normal, so they emit light as well.
            emission_two_sided=emits_twice,
        )

    def _base_color(self, pbr: Element, factor: Rgba) -> Value:
        return self._textures.value(pbr.child("baseColorTexture"), factor[:3], srgb=True)

    def _surface(self, pbr: Element, factor: Rgba) -> dict[str, Value]:
        texture = pbr.child("metallicRoughnessTexture")
        metallic, roughness = pbr.clamped("metallicFactor", 1.0), pbr.clamped("roughnessFactor", 1.0)
        return {
            "base_color": self._base_color(pbr, factor),
            "metallic": self._textures.value(texture, (metallic,) * 3, channel=2),
            "roughness": self._textures.value(texture, (roughness,) * 3, channel=1, square=True),
        }

    def _dielectric(self, element: Element) -> dict[str, Value]:
        """Return the parameters that the extensions ior, specular, transmission and diffuse_transmission set."""
        parameters: dict[str, Value] = {}
        ior = element.extension("KHR_materials_ior")
        if ior is not None:
            parameters["ior"] = grey(_index_of_refraction(ior))
        specular = element.extension("KHR_materials_specular")
        if specular is not None:
            factor = specular.clamped("specularFactor", 1.0)
            color = specular.color("specularColorFactor", (1, 1, 1))
            parameters["specular"] = self._textures.value(specular.child("specularTexture"), (factor,) * 3, channel=3)
            parameters["specular_color"] = self._textures.value(
                specular.child("specularColorTexture"), color, srgb=True
            )
        transmission = element.extension("KHR_materials_transmission")
        if transmission is not None:
            factor = transmission.clamped("transmissionFactor", 0.0)
            parameters["transmission"] = self._textures.value(
                transmission.child("transmissionTexture"), (factor,) * 3, channel=0
            )
        diffuse = element.extension("KHR_materials_diffuse_transmission")
        if diffuse is not None:
            factor = diffuse.clamped("diffuseTransmissionFactor", 0.0)
            color = diffuse.color("diffuseTransmissionColorFactor", (1, 1, 1))
            parameters["diffuse_transmission"] = self._textures.value(
                diffuse.child("diffuseTransmissionTexture"), (factor,) * 3, channel=3
            )
            parameters["diffuse_transmission_color"] = self._textures.value(
                diffuse.child("diffuseTransmissionColorTexture"), color, srgb=True
            )
        return parameters

    def _glossy(self, glossy: Element | None) -> dict[str, Value]:
        """Return the parameters of a specular-glossiness material.

        The material becomes non-metallic with a refractive index so high that the specular colour is the reflectance at
        normal incidence.
        """
        if glossy is None:
            return {}
        warn(f"{glossy.where}: the specular-glossiness material is approximated by a metallic-roughness material")
        texture, gloss = glossy.child("specularGlossinessTexture"), glossy.clamped("glossinessFactor", 1.0)
        specular = self._textures.value(texture, glossy.color("specularFactor", (1, 1, 1)), srgb=True)
        roughness = self._textures.value(texture, (1.0, 1.0, 1.0), srgb=True, channel=3, square=True)
        if roughness.texture is None:
            roughness = replace(roughness, constant=(1 - gloss,) * 3)
        elif gloss != 1:
            warn(
                f"{glossy.at('glossinessFactor')}: a glossinessFactor other than 1 is not supported together with a "
                "texture; 1 is used instead"
            )
        return {
            "metallic": grey(0.0),
            "roughness": replace(roughness, invert=roughness.texture is not None),
            "ior": grey(MAX_INDEX),
            "specular_color": specular,
        }

    def _opacity(self, element: Element, pbr: Element, alpha: float) -> tuple[Value, float | None]:
        """Return the opacity, and the alpha cutoff if alphaMode is MASK, otherwise None."""
        mode = element.text("alphaMode", "OPAQUE")
        if mode not in ("OPAQUE", "MASK", "BLEND"):
            raise EclatError(f"{element.at('alphaMode')}: expected OPAQUE, MASK or BLEND, got {mode[:20]!r}")
        if mode == "OPAQUE":
            return grey(1.0), None
        opacity = self._textures.value(pbr.child("baseColorTexture"), (alpha,) * 3, srgb=True, channel=3)
        return opacity, element.number("alphaCutoff", 0.5) if mode == "MASK" else None

    def _normal_map(self, element: Element) -> NormalMap | None:
        info = element.child("normalTexture")
        if info is None:
            return None
        value = self._textures.value(info, (1.0, 1.0, 1.0), neutral=(0.5, 0.5, 1.0))
        if value.texture is None:
            return None
        if value.texture.image.shape[2] < 3:
            warn(f"{info.where}: expected an RGB image as the normal map, got a grey one; it is ignored")
            return None
        return NormalMap(value, scale=info.number("scale", 1.0))

    def _emission(self, element: Element) -> Value | None:
        extension = element.extension("KHR_materials_emissive_strength")
        strength = 1.0 if extension is None else max(extension.number("emissiveStrength", 1.0), 0.0)
        r, g, b = (strength * v for v in element.color("emissiveFactor", (0, 0, 0)))
        if not max(r, g, b) > 0:
            return None
        return self._textures.value(element.child("emissiveTexture"), (r, g, b), srgb=True)


def used_uv_sets(material: Material) -> set[int]:
    """Return the numbers of the texture coordinate sets that the textures of a material use."""
    normal = material.normal_map.value if material.normal_map else None
    return uv_sets(*material.parameters.values(), material.opacity, material.emission, normal)


def _metallic_roughness(element: Element, glossy: Element | None) -> Element:
    """Return the object with the base colour, metalness and roughness of a material.

    For a specular-glossiness material, `glossy`, the diffuse colour takes the place of the base colour.
    """
    if glossy is None:
        return element.child("pbrMetallicRoughness") or Element({}, element.where)
    names = {"baseColorFactor": "diffuseFactor", "baseColorTexture": "diffuseTexture"}
    return Element({ours: glossy.data.get(theirs) for ours, theirs in names.items()}, glossy.where)


def _base_factor(pbr: Element) -> Rgba:
    r, g, b, a = pbr.levels("baseColorFactor", (1, 1, 1, 1), high=1.0)
    return r, g, b, a


def _is_thin(element: Element) -> bool:
    """Return whether the surface is thin-walled, so that it does not refract: KHR_materials_volume or its thickness is
    absent.
    """
    volume = element.extension("KHR_materials_volume")
    if volume is None:
        return True
    if volume.color("attenuationColor", (1, 1, 1)) != (1, 1, 1) and volume.data.get("attenuationDistance") is not None:
        warn(f"{volume.where}: attenuation in a volume is not supported and is ignored, so that the volume is clear")
    return volume.number("thicknessFactor", 0.0) <= 0


def _index_of_refraction(extension: Element) -> float:
    ior = extension.number("ior", 1.5)
    if ior == 0:
        return MAX_INDEX
    return extension.clamped("ior", 1.5, 1.0, MAX_INDEX)
