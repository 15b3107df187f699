# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Export to glTF 2.0: `encode_glb` makes a binary file of a `Scene`.

The parts: `document` (lists, buffer, chunks), `textures`, `metallic_roughness` (other materials as glTF's), `materials`,
`geometry` (primitives), `nodes` (cameras and lights).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from eclat.errors import EclatError, warn
from eclat.gltf_export.document import Document, Json, extras
from eclat.gltf_export.geometry import Part, bounds_of, primitive, reversed_sides
from eclat.gltf_export.materials import Materials
from eclat.gltf_export.nodes import camera_node, light_node
from eclat.gltf_export.textures import Textures
from eclat.scene import Material, Mesh, Scene

__all__ = ["LIGHTMAP_TEXTURE", "LightmapTexture", "Part", "back_of", "encode_glb", "parts_of", "sides_differ"]


LIGHTMAP_TEXTURE = 0
"""The light map's index among the textures of a file that has one."""


@dataclass(frozen=True, eq=False)
class LightmapTexture:
    """A light map that is embedded as MOZ_lightmap: `png`, an sRGB image whose linear values times `intensity` are
    irradiance; `extras` go beside it."""

    png: bytes
    intensity: float
    extras: dict[str, Any] = field(default_factory=dict)


def encode_glb(
    scene: Scene,
    parts: Sequence[Part] | None = None,
    *,
    lightmap: LightmapTexture | None = None,
    lights: bool = True,
    generator: str = "eclat",
    notes: dict[str, Any] | None = None,
) -> bytes:
    """A binary glTF file of `scene`, all in world space, one node a mesh; `eclat.load` gives the scene back.

    Numbers stay what they are: where the scene is radiometric, intensities in W/sr stand where glTF means candela, and a
    note of ours in the file says so to `eclat.load`. Materials that glTF does not know are approximated, with warnings.

    Parameters
    ----------
    parts : the meshes to write, `parts_of(scene)` where None.
    lightmap : needs `lightmap_uvs` in every part; they become TEXCOORD_1, and the scene's second set TEXCOORD_2.
    lights : whether punctual and directional lights are written.
    notes : for programs that know us, under `asset.extras.eclat`.

    Raises
    ------
    EclatError : positions that are not finite, or more than 4 GiB.
    """
    document = Document(generator)
    textures = Textures(document, {0: 0, 1: 1 if lightmap is None else 2})
    materials = Materials(document, textures, None if lightmap is None else _moz_lightmap(document, textures, lightmap))
    document.root["asset"] |= extras(photometric=scene.photometric, **(notes or {}))
    parts = parts_of(scene) if parts is None else parts
    nodes = [_mesh_node(document, materials, part) for part in parts]
    bounds = bounds_of(parts)
    nodes += [camera_node(document, camera, bounds) for camera in scene.cameras]
    if lights:
        nodes += [light_node(document, light) for light in scene.lights]
    if scene.environment is not None:
        warn(
            "glTF has no environments: the file contains the light of the environment in its light map, but no visible sky"
        )
    document.root |= {"scene": 0, "scenes": [{"name": scene.name, **({"nodes": nodes} if nodes else {})}]}
    return document.encode()


def parts_of(scene: Scene) -> list[Part]:
    """The scene's meshes; those whose sides differ, which glTF's `doubleSided` cannot say, as two sheets back to back."""
    parts: list[Part] = []
    for mesh in scene.meshes:
        if len(mesh.triangles):
            parts += sides_of(mesh) if sides_differ(mesh.material) else [Part(mesh)]
    return parts


def sides_of(mesh: Mesh) -> list[Part]:
    """The front and the back of a two-sided mesh as separate parts."""
    return [Part(mesh, one_of_two=True), Part(back_of(mesh), one_of_two=True, back=True)]


def back_of(mesh: Mesh) -> Mesh:
    """The back of a two-sided mesh: the mesh turned over, with the material of that side."""
    material = mesh.material.back or mesh.material
    if mesh.material.back is None and not mesh.material.emission_two_sided:
        material = replace(material, emission=None)
    return replace(reversed_sides(mesh), material=material)


def sides_differ(material: Material) -> bool:
    """Whether a two-sided material differs on its back, which glTF's `doubleSided` cannot express."""
    if not material.two_sided:
        return False
    return material.back is not None or (material.emission is not None and not material.emission_two_sided)


def _moz_lightmap(document: Document, textures: Textures, lightmap: LightmapTexture) -> Json:
    image = document.add("images", {"bufferView": document.view(lightmap.png), "mimeType": "image/png"})
    index = textures.texture(image, ("clamp", "clamp"), mipmaps=False)
    assert index == LIGHTMAP_TEXTURE, "it is written before the scene's own"
    found: Json = {"index": index, "texCoord": 1, "intensity": lightmap.intensity}
    return found | ({"extras": lightmap.extras} if lightmap.extras else {})


def _mesh_node(document: Document, materials: Materials, part: Part) -> int:
    if not np.isfinite(np.asarray(part.mesh.positions, np.float32)).all():
        raise EclatError(f"mesh {part.mesh.name!r}: expected finite positions")
    found = primitive(document, part, materials.index(part.mesh.material, one_of_two=part.one_of_two))
    if part.back:
        found |= extras(back_side=True)
    name = part.mesh.name
    mesh = document.add("meshes", {"name": name, "primitives": [found]})
    return document.add("nodes", {"name": name, "mesh": mesh})
