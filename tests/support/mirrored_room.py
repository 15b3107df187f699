# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A glTF file with what is easily baked wrong: mirrored and stretched instances, two texture coordinate sets in use,
vertex colours, smooth surfaces, a sheet seen from behind, a sheet with holes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from eclat.scenes.geometry import Solid, box, extrude, icosphere
from support.gltf_files import GltfFile

HALF_TURN = [0.0, 1.0, 0.0, 0.0]
"""About y, as a quaternion."""


def save_mirrored_room(folder: Path, name: str = "mirrored.glb") -> Path:
    """A room 4 m wide, 2.5 m high, 3 m deep, its camera and a lamp inside; all materials diffuse."""
    file = GltfFile()
    checks = file.texture(_checks(), magFilter=9729, minFilter=9729)
    white = _diffuse(file, "white", (0.7, 0.68, 0.65))
    red = _diffuse(file, "red", (0.6, 0.2, 0.15))
    tinted = _diffuse(file, "tinted", (0.9, 0.9, 0.9))
    tiles = _diffuse(file, "tiles", (0.8, 0.8, 0.8), checks)
    lamp = _diffuse(file, "lamp", (0.5, 0.5, 0.5)) | {"emissiveFactor": [1, 0.9, 0.75], "doubleSided": False}
    lamp["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": 12.0}
    holes = file.texture(_holes(), magFilter=9729, minFilter=9729)
    grid = _diffuse(file, "grid", (0.7, 0.68, 0.65), holes, texture_set=0) | {"alphaMode": "MASK", "alphaCutoff": 0.5}
    for material in (white, red, tinted, tiles, lamp, grid):
        file.append("materials", material)
    number = {material["name"]: i for i, material in enumerate(file.json["materials"])}

    shell = box((-2, 0, -1.5), (2, 2.5, 1.5)).inside_out()
    file.mesh_node(_solid(file, shell, number["white"]))
    floor = np.array([[-2, 0.005, 1.5], [2, 0.005, 1.5], [2, 0.005, -1.5], [-2, 0.005, -1.5]])
    square = np.array([[0, 0], [4, 0], [4, 3], [0, 3]])
    sheet = Solid(floor, np.array([[0, 1, 2], [0, 2, 3]]))
    # The second set is the one the tiles use; the first is good for nothing.
    file.mesh_node(_solid(file, sheet, number["tiles"], TEXCOORD_0=0 * square, TEXCOORD_1=square))
    panel = np.array([[-0.5, 2.45, -0.4], [0.5, 2.45, -0.4], [0.5, 2.45, 0.4], [-0.5, 2.45, 0.4]])
    file.mesh_node(_solid(file, Solid(panel, sheet.triangles), number["lamp"]))

    # No plane of symmetry: a mirrored one cannot be turned into the first.
    wedge = extrude([(0, 0), (0.9, 0), (0, 0.7)], 0.4)
    wedges = file.append("meshes", {"primitives": [_solid(file, wedge, number["red"])]})
    for pose in (
        {"translation": [-1.7, 0, -0.9]},
        {"translation": [1.7, 0, -0.9], "scale": [-1, 1, 1]},
        {"translation": [0.15, 0.004, -0.6], "scale": [0.6, -1.1, 1.5], "rotation": HALF_TURN},
    ):
        file.append("nodes", {"mesh": wedges, **pose})
    # Seen from above through its back: turned over, the third one would lie below the floor.
    file.json["nodes"][-1]["translation"][1] += 1.1 * 0.7

    ball = icosphere(2)
    tint = np.column_stack([0.5 + 0.5 * ball.positions, np.ones(len(ball.positions))])
    balls = file.append(
        "meshes",
        {
            "primitives": [
                _solid(file, Solid(ball.positions, ball.triangles, ball.positions), number["tinted"], COLOR_0=tint)
            ]
        },
    )
    file.append("nodes", {"mesh": balls, "translation": [-0.95, 0.45, -0.35], "scale": [0.45] * 3})
    file.append("nodes", {"mesh": balls, "translation": [0.9, 0.5, -0.2], "scale": [-0.35, 0.5, 0.35]})

    # Sheets before the back wall: one turns its back to the camera, one has holes.
    screen = np.array([[0.5, 0.9, -0.9], [1.9, 0.9, -0.9], [1.9, 2.1, -0.9], [0.5, 2.1, -0.9]])
    file.mesh_node(_solid(file, Solid(screen, sheet.triangles[:, ::-1]), number["white"]))
    perforated = Solid(screen * [-1, 1, 1], sheet.triangles[:, ::-1])
    file.mesh_node(_solid(file, perforated, number["grid"], TEXCOORD_0=square / [4, 3]))

    lens = {"yfov": math.radians(62), "znear": 0.01, "aspectRatio": 4 / 3}
    camera = file.append("cameras", {"type": "perspective", "perspective": lens})
    tilt = math.radians(-14) / 2
    rotation = [math.sin(tilt), 0.0, 0.0, math.cos(tilt)]
    file.append("nodes", {"camera": camera, "translation": [0, 1.5, 1.45], "rotation": rotation})
    file.json |= {"scene": 0, "scenes": [{"nodes": list(range(len(file.json["nodes"])))}]}
    file.json["extensionsUsed"] = ["KHR_materials_specular", "KHR_materials_emissive_strength"]
    return file.save(folder, name)


def _diffuse(
    file: GltfFile, name: str, color: tuple[float, float, float], texture: int | None = None, texture_set: int = 1
) -> dict[str, Any]:
    surface: dict[str, Any] = {"baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": 1}
    if texture is not None:
        surface["baseColorTexture"] = {"index": texture, "texCoord": texture_set}
    # Without the dielectric's reflection what is left is diffuse.
    no_gloss = {"KHR_materials_specular": {"specularFactor": 0}}
    return {"name": name, "pbrMetallicRoughness": surface, "extensions": no_gloss, "doubleSided": True}


def _solid(file: GltfFile, solid: Solid, material: int, **attributes: Any) -> dict[str, Any]:
    primitive = file.primitive(solid.positions, solid.triangles.ravel(), material=material)
    bounds = file.json["accessors"][primitive["attributes"]["POSITION"]]
    bounds |= {"min": solid.positions.min(axis=0).tolist(), "max": solid.positions.max(axis=0).tolist()}
    if solid.normals is not None:
        attributes["NORMAL"] = solid.normals
    primitive["attributes"] |= {key: file.accessor(values) for key, values in attributes.items()}
    return primitive


def _checks() -> np.ndarray:
    """(8, 8, 3): light and dark squares, the lower left one bluish, so that no turning goes unseen."""
    rows, columns = np.indices((8, 8)) // 4
    checks = np.where(((rows + columns) % 2 == 0)[..., None], (230, 225, 215), (120, 110, 100)).astype(np.uint8)
    checks[4:, :4] = (90, 110, 160)
    return checks


def _holes() -> np.ndarray:
    """(8, 8, 4): white, with four places of no opacity, one of them smaller."""
    holes = np.full((8, 8, 4), 255, np.uint8)
    for row, column in ((1, 1), (1, 5), (5, 1)):
        holes[row : row + 2, column : column + 2, 3] = 0
    holes[5, 5, 3] = 0
    return holes
