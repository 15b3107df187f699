# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Materials and textures of a scene for the page.

A material of the page has the fields

    name, two_sided, culled, vertex_colors, emission_two_sided, cutoff (−1 for none)
    hidden                            whether the eye sees through it, while mirrors show it
    diffuse, emission, opacity        values, see below; of glass, `diffuse` is the colour of what passes
    relief                            null, or the `kind` "normal" or "bump", the `scale` and the `map` of a `NormalMap`
    metallic, transmission            values by which the diffuse reflectance is reduced: (1 − metallic) (1 − transmission)
    gloss                             "none", or what it is like: "rough", "mirror" or "glass"
    mirrored, metal, alpha            the reflectance of the gloss at these cosines (32 × 3 numbers, one after another)
                                      without the metallic part, what a metal mirrors there (32 × 2 numbers a and b: a
                                      times its colour + b), and the roughness α: see `mirrors`
    coat                              the albedo of a white base below the coat, seen at the cosines 0, 1/(n − 1), …, 1
    inside                            R of the light that the coat reflects back to the base: the albedo ρ of the base
                                      looks like coat · ρ / (1 − R ρ), or, where `saturates` is false, coat · ρ / (1 − R)

and a value is `constant` (RGB), and where it varies `texture` (an index), `channel` (−1 for RGB), `uv_set`, `transform`
(two rows of three), `invert` and `square`.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from PIL import Image as PillowImage

from eclat import _core
from eclat.errors import warn
from eclat.gltf_export.metallic_roughness import as_metallic_roughness
from eclat.gltf_export.textures import average, constant_of
from eclat.measured_brdf import normal_albedo
from eclat.scene import DEFAULTS, Material, NormalMap, Texture, Value, grey, rgb
from eclat.viewer.mirrors import alpha_of, metal_shares, reflectance_of

COSINES = 32
"""Number of entries of the table `coat`."""

Json = dict[str, Any]


class PageMaterials:
    """The materials and textures of one message, each once."""

    def __init__(self) -> None:
        self.materials: list[Json] = []
        self.textures: list[Json] = []
        self.arrays: dict[str, np.ndarray] = {}
        self._numbers: dict[int, int] = {}
        self._textures: dict[int, int] = {}
        self._kept: list[object] = []  # ids are valid only while the objects exist

    def number(self, material: Material) -> int:
        """Return the index of a material, which is added if it is not there."""
        if id(material) not in self._numbers:
            self._kept.append(material)
            self._numbers[id(material)] = len(self.materials)
            self.materials.append(self._material(material))
        return self._numbers[id(material)]

    def _material(self, material: Material) -> Json:
        shown = _shown_for(material)
        parameters = {name: shown.parameters.get(name, default) for name, default in DEFAULTS.items()}
        black = grey(0.0)
        coat, inside = coat_of(shown)
        return {
            "name": material.name,
            "two_sided": material.two_sided,
            "culled": material.back_culled and not material.two_sided,
            "hidden": material.hidden_from_camera,
            "vertex_colors": material.vertex_colors,
            "emission_two_sided": material.emission_two_sided,
            "cutoff": -1 if material.alpha_cutoff is None else material.alpha_cutoff,
            "diffuse": self._value(_diffuse(shown, parameters)),
            "metallic": self._value(parameters["metallic"] if shown.kind == "metallic_roughness" else black),
            "transmission": self._value(parameters["transmission"] if shown.kind == "metallic_roughness" else black),
            "emission": self._value(material.emission or black),
            "opacity": self._value(material.opacity),
            "relief": self._relief(material.normal_map),
            "gloss": gloss_of(shown),
            "mirrored": reflectance_of(shown).ravel().tolist(),
            "metal": metal_shares(shown).ravel().tolist(),
            "alpha": alpha_of(shown),
            "coat": coat.tolist(),
            "inside": inside,
            "saturates": shown.nonlinear,
        }

    def _relief(self, relief: NormalMap | None) -> Json | None:
        if relief is None or relief.value.texture is None:
            return None
        return {"kind": relief.kind, "scale": relief.scale, "map": self._value(relief.value)}

    def _value(self, value: Value) -> Json:
        entry: Json = {"constant": list(map(float, constant_of(value)))}
        if value.texture is not None:
            entry |= {
                "texture": self._texture(value.texture),
                "channel": -1 if value.channel is None else value.channel,
                "uv_set": value.uv_set,
                "transform": [float(x) for row in value.uv_transform for x in row],
                "invert": value.invert,
                "square": value.square,
            }
        return entry

    def _texture(self, texture: Texture) -> int:
        if id(texture) not in self._textures:
            self._kept.append(texture)
            number = self._textures[id(texture)] = len(self.textures)
            image = np.asarray(texture.image)
            image = image if image.ndim == 3 else image[:, :, None]
            name = f"texture {number}"
            png = image.dtype == np.uint8
            self.arrays[name] = np.frombuffer(_png(image), np.uint8) if png else _four_halves(image, texture.srgb)
            self.textures.append(
                {
                    "array": name,
                    "png": png,
                    "srgb": texture.srgb and png,
                    "wrap": [texture.wrap_u, texture.wrap_v],
                    "nearest": texture.filter == "nearest",
                    "channels": image.shape[2],
                }
            )
        return self._textures[id(texture)]


def gloss_of(material: Material) -> str:
    """Return what kind of gloss a material has: "none", "rough", "mirror" or "glass"."""

    def largest(name: str) -> float:
        return max(constant_of(material.parameters.get(name, DEFAULTS[name])))

    if material.kind in ("diffuse", "translucent"):
        return "none"
    if material.kind in ("dielectric", "thin_dielectric"):
        return "glass"
    if material.kind == "metallic_roughness":
        if largest("transmission") > 0.5:
            return "glass"
        if largest("specular") == 0 and largest("metallic") == 0:
            return "none"
        return "mirror" if largest("roughness") < SHARP else "rough"
    if material.kind in ("phong", "ward") and largest("specular_reflectance") == 0:
        return "none"
    return "mirror" if material.kind in ("conductor", "plastic") and largest("alpha_u") < SHARP else "rough"


SHARP = 0.05
"""Roughness α below which a reflection looks like a mirror."""


def coat_of(material: Material) -> tuple[np.ndarray, float]:
    """Return the albedo (COSINES,) of a white base below the coat of a material, and the share of diffuse light that the
    coat reflects back to the base."""
    cosines = np.linspace(0, 1, COSINES, dtype=np.float32)
    p = {name: average(material.parameters.get(name, default)) for name, default in DEFAULTS.items()}
    largest = {name: max(constant_of(value)) for name, value in p.items()}
    if material.kind == "plastic":
        beckmann = material.distribution == "beckmann"
        albedos, inside = _core.plastic_coat(largest["ior"], largest["alpha_u"], beckmann, cosines)
        return np.asarray(albedos), inside
    if material.kind == "metallic_roughness":
        color = np.array(constant_of(p["specular_color"]))
        at_normal = ((largest["ior"] - 1) / (largest["ior"] + 1)) ** 2
        f0 = float(np.minimum(color * at_normal, 1).max()) * largest["specular"]
        return np.asarray(_core.coupled_coat(largest["roughness"], f0, largest["specular"], cosines)), 0.0
    return np.ones(COSINES, np.float32), 0.0


def _shown_for(material: Material) -> Material:
    """Return the material that the page shows in place of one: itself, or for blends and measured ones an approximation."""
    if material.kind == "blend":
        return as_metallic_roughness(material)
    if material.kind != "measured":
        return material
    warn(
        f"material {material.name!r} is measured: shown as matte with its albedo along the normal, and where no record lies "
        "by direct light only; the overlay of what is approximated marks such places"
    )
    albedo = np.zeros(3) if material.measured is None else normal_albedo(material.measured)
    scale = constant_of(average(material.parameters.get("scale", DEFAULTS["scale"])))
    return replace(material, kind="diffuse", parameters={"reflectance": rgb(*np.minimum(albedo * scale, 1).tolist())})


def _diffuse(material: Material, parameters: dict[str, Value]) -> Value:
    if material.kind in ("diffuse", "translucent"):
        return parameters["reflectance"]
    if material.kind in ("phong", "ward"):
        return parameters["diffuse_reflectance"]
    if material.kind == "metallic_roughness":
        return parameters["base_color"]
    if material.kind == "plastic":
        return parameters["diffuse_reflectance"]
    if material.kind in ("dielectric", "thin_dielectric"):
        return parameters["specular_transmittance"]
    return grey(0.0)


def _png(image: np.ndarray) -> bytes:
    file = io.BytesIO()
    PillowImage.fromarray(image[..., 0] if image.shape[2] == 1 else image).save(file, format="PNG")
    return file.getvalue()


def _four_halves(image: np.ndarray, srgb: bool) -> np.ndarray:
    from eclat.images.tone import srgb_decode

    channels: Sequence[int] = {1: (0, 0, 0), 2: (0, 0, 0, 1), 3: (0, 1, 2), 4: (0, 1, 2, 3)}[image.shape[2]]
    four = np.ones((*image.shape[:2], 4), np.float32)
    four[..., : len(channels)] = image[..., channels]
    if srgb:
        four[..., :3] = srgb_decode(four[..., :3])
    return np.clip(four, -65000, 65000).astype(np.float16)
