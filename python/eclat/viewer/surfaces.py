# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The scene as the page draws it: meshes, materials, lights and cameras in one message."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from eclat.bridge.compiled import compiled
from eclat.errors import heard_warnings
from eclat.gltf_export import Part
from eclat.scene import Material, Scene
from eclat.viewer.lamps import cameras_of, lights_of
from eclat.viewer.materials import PageMaterials
from eclat.viewer.messages import encode_message


def scene_message(scene: Scene, parts: Sequence[Part], *, exposure: float = 0.0) -> bytes:
    """Encode the scene.

    Parameters
    ----------
    parts : the meshes to draw, with coordinates in the light map if there is one.
    exposure : the exposure in stops with which the page begins.
    """
    center = compiled(scene).center
    materials = PageMaterials()
    arrays: dict[str, np.ndarray] = {}
    with heard_warnings() as heard:
        meshes = [_mesh(number, part, materials, arrays, center) for number, part in enumerate(parts)]
    content = {
        "name": scene.name or "scene",
        "center": center.tolist(),
        "up": list(map(float, scene.up)),
        "photometric": scene.photometric,
        "exposure": exposure,
        "cameras": cameras_of(scene, center),
        "lights": lights_of(scene, center),
        "sky": sky_of(scene, arrays),
        "materials": materials.materials,
        "textures": materials.textures,
        "meshes": meshes,
        "notes": sorted({*heard, *scene.warnings}),
    }
    return encode_message("scene", content, arrays | materials.arrays)


def sky_of(scene: Scene, arrays: dict[str, np.ndarray]) -> dict[str, Any] | None:
    """Add the environment's image to the arrays and return its rotation; None if the scene has no environment."""
    if scene.environment is None:
        return None
    image = np.asarray(scene.environment.image)
    texels = np.ones((*image.shape[:2], 4), np.float16)
    texels[..., :3] = np.clip(image, 0, 65000)
    arrays["sky"] = texels
    return {"array": "sky", "to_world": [float(x) for x in np.asarray(scene.environment.to_world).ravel()]}


def _mesh(
    number: int, part: Part, materials: PageMaterials, arrays: dict[str, np.ndarray], center: np.ndarray
) -> dict[str, Any]:
    mesh = part.mesh
    given = {
        "positions": np.asarray(mesh.positions, np.float64) - center,
        "normals": mesh.normals,
        "uvs": mesh.uvs,
        "uvs2": mesh.uvs2,
        "tangents": mesh.tangents if _reads_tangents(mesh.material) else None,
        "colors": mesh.colors if mesh.material.vertex_colors else None,
        "light_uvs": part.lightmap_uvs,
    }
    names = {}
    for name, values in given.items():
        if values is not None:
            names[name] = f"mesh {number} {name}"
            arrays[names[name]] = np.asarray(values, np.float32)
    names["triangles"] = f"mesh {number} triangles"
    arrays[names["triangles"]] = np.asarray(mesh.triangles, np.uint32)
    # Where the back is a mesh of its own, each of both is drawn from its front only.
    return {
        "name": mesh.name,
        "material": materials.number(mesh.material),
        "front_only": part.one_of_two,
        "back": part.back,
        "arrays": names,
    }


def _reads_tangents(material: Material) -> bool:
    return material.normal_map is not None and material.normal_map.kind == "normal"
