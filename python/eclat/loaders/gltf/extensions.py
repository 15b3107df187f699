# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The supported extensions, and the warning that names the others."""

from __future__ import annotations

from typing import Any

from eclat.errors import warn
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import printable

SUPPORTED = frozenset(
    {
        "KHR_lights_punctual",
        "KHR_materials_diffuse_transmission",
        "KHR_materials_emissive_strength",
        "KHR_materials_ior",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_specular",
        "KHR_materials_transmission",
        "KHR_materials_unlit",
        "KHR_materials_volume",
        "KHR_mesh_quantization",
        "KHR_node_visibility",
        "KHR_texture_transform",
        "EXT_mesh_gpu_instancing",
        "EXT_texture_avif",
        "EXT_texture_webp",
        "MSFT_texture_dds",
    }
)

WITH_OWN_ERROR = frozenset(
    {
        "KHR_draco_mesh_compression",
        "KHR_texture_basisu",
        "EXT_meshopt_compression",
        "KHR_meshopt_compression",
        "MESHOPT_compression",
    }
)
"""Compressions: harmless where the file has the plain data too, and an error at the element where it has not."""

HARMLESS = frozenset({"KHR_xmp", "KHR_xmp_json_ld", "MOZ_lightmap"})
"""Say nothing about the picture, or what we compute ourselves."""


def warn_of_unsupported(document: Document) -> None:
    """Warn, once for each kind, of extensions and animations in the file that are ignored."""
    used, required = (set(document.root.texts(name)) for name in ("extensionsUsed", "extensionsRequired"))
    known = SUPPORTED | WITH_OWN_ERROR | HARMLESS
    essential = sorted(required - known)
    optional = sorted((used | _found(document.root.data)) - known - required)
    if essential:
        warn(f"{document.name}: requires extensions that are not supported; expect differences: {_shown(essential)}")
    if optional:
        warn(f"{document.name}: extensions that are not supported are ignored: {_shown(optional)}")
    if document.root.data.get("animations"):
        warn(f"{document.name}: animations are not supported and ignored")


def _found(root: dict[str, Any]) -> set[str]:
    """The names of all extensions that objects in the file carry, whether declared or not."""
    names: set[str] = set()
    stack: list[Any] = [root]
    while stack:
        value = stack.pop()
        if isinstance(value, dict):
            extensions = value.get("extensions")
            if isinstance(extensions, dict):
                names.update(extensions)
            stack.extend(value.values())
        elif isinstance(value, list):
            stack.extend(item for item in value if isinstance(item, dict | list))
    return names


def _shown(names: list[str]) -> str:
    """A list of at most ten names, each shortened if it is long."""
    more = f" and {len(names) - 10} more" if len(names) > 10 else ""
    return ", ".join(printable(name[:60]) for name in names[:10]) + more
