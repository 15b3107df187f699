# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Export scenes to binary glTF 2.0 files.

The modules of this package are `document` (lists, buffer and chunks), `textures`, `metallic_roughness` (conversion of
other materials), `materials`, `geometry` (primitives) and `nodes` (cameras and lights).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from eclat.errors import EclatError, warn
from eclat.gltf_export.document import Document, Json, eclat_extras
from eclat.gltf_export.geometry import Part, bounding_box, primitive, reversed_sides
from eclat.gltf_export.materials import Materials
from eclat.gltf_export.nodes import camera_node, light_node
from eclat.gltf_export.textures import Textures
from eclat.scene import Material, Mesh, Scene

__all__ = ["LIGHTMAP_TEXTURE", "LightmapTexture", "Part", "back_side", "encode_glb", "scene_parts", "sides_differ"]


LIGHTMAP_TEXTURE = 0
"""The index of the first page of the light map in the list of textures; the other pages follow it."""


@dataclass(frozen=True, eq=False)
class LightmapTexture:
    """A light map to embed with the extension MOZ_lightmap.

    Parameters
    ----------
    png : a PNG file with an sRGB image.
    intensity : the factor that turns the linear values of the image into irradiance.
    extras : application-specific data for the extension object.
    """

    png: bytes
    intensity: float
    extras: dict[str, Any] = field(default_factory=dict)


def encode_glb(
    scene: Scene,
    parts: Sequence[Part] | None = None,
    *,
    lightmaps: Sequence[LightmapTexture] = (),
    lights: bool = True,
    generator: str = "eclat",
    notes: dict[str, Any] | None = None,
) -> bytes:
    """Encode a scene as a binary glTF file, in world space and with one node for each mesh.

    `eclat.load` reads the scene back. Intensities are not converted: if the scene is radiometric, the file contains W/sr
    instead of the candela that glTF specifies, and an entry in `asset.extras` tells `eclat.load` about it. Materials
    that glTF does not support are approximated, with warnings.

    Parameters
    ----------
    scene : the scene.
    parts : the meshes to write. The default is `scene_parts(scene)`.
    lightmaps : the pages of a light map to embed. Every part then needs `lightmap_uvs`, which become TEXCOORD_1, of its
        `lightmap_page`. The second set of texture coordinates of the scene becomes TEXCOORD_2.
    lights : whether to write point, spot and directional lights.
    generator : the name of the program, for `asset.generator`.
    notes : additional entries of `asset.extras.eclat`.

    Returns
    -------
    The bytes of a .glb file.

    Raises
    ------
    EclatError : a position is not finite, or the file would exceed 4 GiB.
    """
    document = Document(generator)
    textures = Textures(document, {0: 0, 1: 2 if lightmaps else 1})
    pages = [_moz_lightmap(document, textures, page, number) for number, page in enumerate(lightmaps)]
    materials = Materials(document, textures, pages)
    document.root["asset"] |= eclat_extras(photometric=scene.photometric, **(notes or {}))
    parts = scene_parts(scene) if parts is None else parts
    nodes = [_mesh_node(document, materials, part) for part in parts]
    bounds = bounding_box(parts)
    nodes += [camera_node(document, camera, bounds) for camera in scene.cameras]
    if lights:
        nodes += [light_node(document, light) for light in scene.lights]
    if scene.environment is not None:
        warn(
            "glTF does not support environments: the environment is not written, so the sky is not visible in the file; "
            "its light is only contained in a baked light map"
        )
    document.root |= {"scene": 0, "scenes": [{"name": scene.name, **({"nodes": nodes} if nodes else {})}]}
    return document.encode()


def scene_parts(scene: Scene) -> list[Part]:
    """Return the meshes of a scene as parts of a file.

    A two-sided mesh whose sides differ becomes two parts, one for each side, because `doubleSided` in glTF makes both
    sides equal.
    """
    parts: list[Part] = []
    for mesh in scene.meshes:
        if len(mesh.triangles):
            parts += split_sides(mesh) if sides_differ(mesh.material) else [Part(mesh)]
    return parts


def split_sides(mesh: Mesh) -> list[Part]:
    """Return the front side and the back side of a two-sided mesh as separate parts."""
    return [Part(mesh, one_of_two=True), Part(back_side(mesh), one_of_two=True, back=True)]


def back_side(mesh: Mesh) -> Mesh:
    """Return the back side of a two-sided mesh: a mesh with reversed triangles and normals, and the material of that
    side.
    """
    material = mesh.material.back or mesh.material
    if mesh.material.back is None and not mesh.material.emission_two_sided:
        material = replace(material, emission=None)
    return replace(reversed_sides(mesh), material=material)


def sides_differ(material: Material) -> bool:
    """Return whether a two-sided material is different on its back side, which `doubleSided` in glTF cannot express."""
    if not material.two_sided:
        return False
    return material.back is not None or (material.emission is not None and not material.emission_two_sided)


def _moz_lightmap(document: Document, textures: Textures, lightmap: LightmapTexture, page: int) -> Json:
    image = document.add("images", {"bufferView": document.view(lightmap.png), "mimeType": "image/png"})
    index = textures.texture(image, ("clamp", "clamp"), mipmaps=False)
    assert index == LIGHTMAP_TEXTURE + page, "the light map is written before the textures of the scene"
    found: Json = {"index": index, "texCoord": 1, "intensity": lightmap.intensity}
    return found | ({"extras": lightmap.extras} if lightmap.extras else {})


def _mesh_node(document: Document, materials: Materials, part: Part) -> int:
    if not np.isfinite(np.asarray(part.mesh.positions, np.float32)).all():
        raise EclatError(f"mesh {part.mesh.name!r}: expected positions that are finite in float32, got others")
    found = primitive(document, part, materials.index_of(part))
    if part.back:
        found |= eclat_extras(back_side=True)
    name = part.mesh.name
    mesh = document.add("meshes", {"name": name, "primitives": [found]})
    return document.add("nodes", {"name": part.mesh.lamp or name, "mesh": mesh})
