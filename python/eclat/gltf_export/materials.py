# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Write materials [glTF 2.0, 3.9; KHR_materials_ior, _specular, _transmission, _volume, _emissive_strength]."""

from __future__ import annotations

from collections.abc import Sequence

from eclat.errors import warn
from eclat.gltf_export.document import Document, Json, eclat_extras
from eclat.gltf_export.geometry import Part
from eclat.gltf_export.metallic_roughness import as_metallic_roughness
from eclat.gltf_export.textures import Textures, constant_of, square_root, texels
from eclat.scene import DEFAULTS, Material, Value

THICKNESS = 1e-3
"""The thickness in metres of a refractive volume. It only needs to be positive, because a ray tracer uses the thickness of
the mesh. A thickness of 0 would mean a thin-walled surface."""


class Materials:
    """The materials of a document. Each is written only once."""

    def __init__(self, document: Document, textures: Textures, lightmaps: Sequence[Json]) -> None:
        """Prepare to write into `document`. `lightmaps` are the MOZ_lightmap objects of the pages, if there are any."""
        self._document = document
        self._textures = textures
        self._lightmaps = lightmaps
        self._written: dict[tuple[int, bool, int], int] = {}
        self._kept: list[Material] = []

    def index_of(self, part: Part) -> int:
        """Write the material of a part, unless it has been written before for the same page, and return its index."""
        material = part.mesh.material
        page = part.lightmap_page if self._lightmaps else 0
        key = (id(material), part.one_of_two, page)
        if key not in self._written:
            self._kept.append(material)
            json = self._material(material, part.one_of_two)
            if self._lightmaps:
                json.setdefault("extensions", {})[self._document.use("MOZ_lightmap")] = dict(self._lightmaps[page])
            self._written[key] = self._document.add("materials", json)
        return self._written[key]

    def _material(self, original: Material, one_of_two: bool) -> Json:
        material = as_metallic_roughness(original)
        factor = [min(c, 1.0) for c in constant_of(self._of(material, "base_color"))]
        if max(constant_of(self._of(material, "base_color"))) > 1:
            warn(f"material {material.name!r}: the base colour has components above 1, which are clipped to 1")
        if original.hidden_from_camera:
            warn(f"material {original.name!r}: glTF hides nothing from cameras; the surface is visible")
        json: Json = {
            "name": material.name,
            "pbrMetallicRoughness": {"baseColorFactor": [*factor, self._alpha(material)]} | self._surface(material),
            "extensions": self._extensions(material),
        }
        json |= self._opacity(material) | self._emission(material) | self._normal(material)
        if one_of_two:
            emits_twice = material.emission is not None and material.emission_two_sided
            json |= eclat_extras(two_sided=True, emission_two_sided=emits_twice)
        elif material.two_sided:
            json["doubleSided"] = True
        elif not material.back_culled:
            json |= eclat_extras(black_back=True)
        if not json["extensions"]:
            del json["extensions"]
        return json

    def _of(self, material: Material, name: str) -> Value:
        return material.parameters.get(name, DEFAULTS[name])

    def _alpha(self, material: Material) -> float:
        return min(max(constant_of(material.opacity)[0], 0.0), 1.0)

    def _surface(self, material: Material) -> Json:
        color, metallic = self._of(material, "base_color"), self._of(material, "metallic")
        roughness = square_root(self._of(material, "roughness"))
        json: Json = {
            "metallicFactor": min(metallic.constant[0], 1.0),
            "roughnessFactor": min(roughness.constant[0], 1.0),
        }
        info = self._textures.color(color, None if _opaque(material) else material.opacity)
        if info is not None:
            json["baseColorTexture"] = info
        info = self._textures.channels({1: roughness, 2: metallic})
        if info is not None:
            json["metallicRoughnessTexture"] = info
        return json

    def _opacity(self, material: Material) -> Json:
        if _opaque(material):
            return {}
        if material.alpha_cutoff is None:
            return {"alphaMode": "BLEND"}
        return {"alphaMode": "MASK", "alphaCutoff": material.alpha_cutoff}

    def _emission(self, material: Material) -> Json:
        """Return the emission as a factor of at most 1. `_extensions` writes the strength that multiplies it."""
        emission = material.emission
        if emission is None or max(constant_of(emission)) <= 0:
            return {}
        scale = 1.0 if emission.texture is None else max(1.0, float(texels(emission).max(initial=0)))
        r, g, b = (c * scale for c in constant_of(emission))
        strength = max(r, g, b)
        json: Json = {"emissiveFactor": [r / strength, g / strength, b / strength]}
        info = self._textures.color(emission, scale=scale)
        if info is not None:
            json["emissiveTexture"] = info
        return json

    def _normal(self, material: Material) -> Json:
        if material.normal_map is None:
            return {}
        if material.normal_map.kind == "bump":
            warn(f"material {material.name!r}: glTF does not support bump maps; the bump map is left out")
            return {}
        value = material.normal_map.value
        info = self._textures.channels({i: _channel(value, i) for i in range(3)})
        if info is None:
            return {}
        return {"normalTexture": info | {"scale": material.normal_map.scale}}

    def _extensions(self, material: Material) -> Json:
        json: Json = {}
        ior = constant_of(self._of(material, "ior"))[0]
        if ior != 1.5:
            json[self._document.use("KHR_materials_ior")] = {"ior": max(ior, 1.0)}
        specular = self._specular(material)
        if specular:
            json[self._document.use("KHR_materials_specular")] = specular
        json |= self._transmission(material) | self._diffuse_transmission(material)
        strength = 0.0
        if material.emission is not None:
            strength = max(constant_of(material.emission))
            if material.emission.texture is not None:
                strength *= max(1.0, float(texels(material.emission).max(initial=0)))
        if strength > 0 and strength != 1:
            json[self._document.use("KHR_materials_emissive_strength")] = {"emissiveStrength": strength}
        return json

    def _specular(self, material: Material) -> Json:
        factor, color = self._of(material, "specular"), self._of(material, "specular_color")
        json: Json = {}
        if factor.constant[0] != 1:
            json["specularFactor"] = min(factor.constant[0], 1.0)
        if constant_of(color) != (1.0, 1.0, 1.0):
            json["specularColorFactor"] = list(constant_of(color))
        for name, info in (
            ("specularTexture", self._textures.channels({3: factor})),
            ("specularColorTexture", self._textures.color(color)),
        ):
            if info is not None:
                json[name] = info
        return json

    def _transmission(self, material: Material) -> Json:
        value = self._of(material, "transmission")
        if value.constant[0] <= 0:
            return {}
        json: Json = {"transmissionFactor": min(value.constant[0], 1.0)}
        info = self._textures.channels({0: value})
        if info is not None:
            json["transmissionTexture"] = info
        found: Json = {self._document.use("KHR_materials_transmission"): json}
        if not material.thin_walled:
            found[self._document.use("KHR_materials_volume")] = {"thicknessFactor": THICKNESS}
        return found

    def _diffuse_transmission(self, material: Material) -> Json:
        value, color = self._of(material, "diffuse_transmission"), self._of(material, "diffuse_transmission_color")
        if value.constant[0] <= 0:
            return {}
        json: Json = {"diffuseTransmissionFactor": min(value.constant[0], 1.0)}
        if constant_of(color) != (1.0, 1.0, 1.0):
            json["diffuseTransmissionColorFactor"] = list(constant_of(color))
        for name, info in (
            ("diffuseTransmissionTexture", self._textures.channels({3: value})),
            ("diffuseTransmissionColorTexture", self._textures.color(color)),
        ):
            if info is not None:
                json[name] = info
        return {self._document.use("KHR_materials_diffuse_transmission"): json}


def _opaque(material: Material) -> bool:
    return material.opacity.texture is None and constant_of(material.opacity)[0] >= 1


def _channel(value: Value, index: int) -> Value:
    """Return one channel of a normal map as a separate value. The constant factor of a normal map is always 1."""
    return Value((1.0, 1.0, 1.0), value.texture, index, value.uv_set, value.uv_transform)
