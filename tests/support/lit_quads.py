# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Baked files made by hand: a quad that fills the picture, with a light map of known texels."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from numpy.typing import NDArray

from eclat.images.exr import encode_exr
from support.gltf_files import GltfFile

ALBEDO = (0.8, 0.5, 0.25)

LINEAR, CLAMP_TO_EDGE = 9729, 33071


def save_lit_quad(
    folder: Path,
    stem: str,
    irradiance: NDArray[np.floating[Any]],
    encoded: NDArray[np.uint8],
    intensity: float,
    *,
    materials: int = 1,
    specular: float = 0.0,
) -> Path:
    """Write `stem`.glb, .lightmap.exr and .lightmap.json: a quad of albedo `ALBEDO` that fills a square picture.

    Parameters
    ----------
    irradiance : (H, W, 3) texels of the EXR, W/m².
    encoded : (H, W, 3) sRGB texels of the embedded map, times `intensity` W/m².
    materials : the quad is cut into that many columns, each of its own material, all with the same light map.
    specular : KHR_materials_specular.specularFactor; 0 leaves the diffuse part alone.
    """
    file = GltfFile()
    light_map = file.texture(encoded, magFilter=LINEAR, minFilter=LINEAR, wrapS=CLAMP_TO_EDGE, wrapT=CLAMP_TO_EDGE)
    for i in range(materials):
        material = file.append("materials", _material(f"column {i}", light_map, intensity, specular))
        file.mesh_node(_column(file, i / materials, (i + 1) / materials, irradiance.shape[1::-1], material))
    # From a distance of 2 the picture's half height is 2 · tan(atan(1/2)) = 1: the quad's.
    lens = {"yfov": 2 * float(np.arctan(0.5)), "znear": 0.1, "aspectRatio": 1.0}
    camera = file.append("cameras", {"type": "perspective", "perspective": lens})
    file.append("nodes", {"camera": camera, "translation": [0, 0, 2]})
    file.append("scenes", {"nodes": list(range(materials + 1))})
    file.json["scene"] = 0
    file.json["extensionsUsed"] = ["MOZ_lightmap", "KHR_materials_specular"]
    file.json["asset"]["extras"] = {"eclat": {"lightmap": quote(f"{stem}.lightmap.json"), "lightmap_set": "one bake"}}
    pages = [{"exr": f"{stem}.lightmap.exr", "gltf_texture": light_map, "intensity": intensity}]
    (folder / f"{stem}.lightmap.json").write_text(
        json.dumps({"version": 1, "set": "one bake", "pages": pages}), encoding="utf-8"
    )
    (folder / f"{stem}.lightmap.exr").write_bytes(encode_exr(irradiance.astype(np.float32), {}, {}, {}))
    return file.save(folder, f"{stem}.glb")


def _material(name: str, light_map: int, intensity: float, specular: float) -> dict[str, Any]:
    extensions = {
        "MOZ_lightmap": {"index": light_map, "texCoord": 1, "intensity": intensity},
        "KHR_materials_specular": {"specularFactor": specular},
    }
    surface = {"baseColorFactor": [*ALBEDO, 1], "metallicFactor": 0, "roughnessFactor": 1}
    return {"name": name, "pbrMetallicRoughness": surface, "extensions": extensions}


def _column(file: GltfFile, left: float, right: float, size: tuple[int, int], material: int) -> dict[str, Any]:
    """The part of the quad z = 0, |x| ≤ 1, |y| ≤ 1 whose fractions of the width are left … right."""
    x, y = np.array([left, right, right, left]), np.array([0.0, 0.0, 1.0, 1.0])
    positions = np.stack([2 * x - 1, 1 - 2 * y, 0 * x], axis=1)
    # From the centres of the outermost texels to each other: interpolation then never meets an edge.
    centres = [(c * (n - 1) + 0.5) / n for c, n in zip((x, y), size, strict=True)]
    primitive = file.primitive(positions, [0, 2, 1, 0, 3, 2], material=material)
    accessor = file.json["accessors"][primitive["attributes"]["POSITION"]]
    accessor |= {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
    primitive["attributes"] |= {
        "NORMAL": file.accessor(np.tile([0.0, 0.0, 1.0], (4, 1))),
        "TEXCOORD_0": file.accessor(np.zeros((4, 2))),
        "TEXCOORD_1": file.accessor(np.stack(centres, axis=1)),
    }
    return primitive


def expected_radiance(irradiance: NDArray[np.floating[Any]], size: int) -> NDArray[np.float64]:
    """(size, size, 3): ρ/π · E at the centres of a square picture's pixels, E bilinear between the texels' centres."""
    place = (np.arange(size) + 0.5) / size
    between = np.asarray(irradiance, dtype=np.float64)
    for axis in (0, 1):
        n = between.shape[axis]
        texels = np.arange(n)
        weights = np.maximum(0.0, 1 - np.abs(place[:, None] * (n - 1) - texels))
        between = np.moveaxis(np.tensordot(weights, between, axes=(1, axis)), 0, axis)
    return np.asarray(ALBEDO) / np.pi * between
