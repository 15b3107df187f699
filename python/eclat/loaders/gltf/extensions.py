# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The extensions that the loader supports, and the warning about those that it does not support."""

from __future__ import annotations

from typing import Any

from eclat.errors import warn
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import printable

SUPPORTED = frozenset(
    {
        "KHR_animation_pointer",
        "KHR_draco_mesh_compression",
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
        "KHR_meshopt_compression",
        "KHR_node_visibility",
        "KHR_texture_basisu",
        "KHR_texture_transform",
        "EXT_lights_ies",
        "EXT_mesh_gpu_instancing",
        "EXT_meshopt_compression",
        "EXT_texture_avif",
        "EXT_texture_webp",
        "MESHOPT_compression",
        "MSFT_texture_dds",
    }
)
"""The supported extensions."""

IGNORED_SILENTLY = frozenset({"KHR_xmp", "KHR_xmp_json_ld", "MOZ_lightmap"})
"""The extensions that need no warning, because they contain metadata or baked light, which do not affect the image."""


def warn_about_unsupported(document: Document) -> None:
    """Warn about the extensions in the file that are ignored."""
    used, required = (set(document.root.texts(name)) for name in ("extensionsUsed", "extensionsRequired"))
    known = SUPPORTED | IGNORED_SILENTLY
    essential = sorted(required - known)
    optional = sorted((used | _found(document.root.data)) - known - required)
    if essential:
        warn(
            f"{document.name}: the file requires extensions that are not supported, so the image may be wrong: "
            f"{_shown(essential)}"
        )
    if optional:
        warn(f"{document.name}: these extensions are not supported and are ignored: {_shown(optional)}")


def _found(root: dict[str, Any]) -> set[str]:
    """Return the names of all extensions in the objects of the file, whether they are declared or not."""
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
    """Join at most ten `names` for a message, each shortened to 60 characters."""
    more = f" and {len(names) - 10} more" if len(names) > 10 else ""
    return ", ".join(printable(name[:60]) for name in names[:10]) + more
