# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's materials as Éclat's."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from eclat.scene import Material, grey

from . import principled  # noqa: F401  (adds its shader to the table)
from .image_nodes import ImageReader
from .links import active_output
from .node_values import NodeValues
from .notices import Notices
from .shaders import Shading
from .surfaces import Surface

PLAIN = 0.8
"""Reflectance of surfaces without a material, as in Cycles."""


@dataclass(frozen=True)
class Made:
    """A material, the names of the UV maps of its texture coordinates, "" for that which renders, and whether it has images
    that need them."""

    material: Material
    uv_maps: tuple[str, ...] = ("",)
    uses_images: bool = False


class Materials:
    """The materials of a scene, each made once."""

    def __init__(self, notices: Notices) -> None:
        self._notices = notices
        self._images = ImageReader(notices)
        self._made: dict[str, Made] = {}

    def of(self, material: Any) -> Made:
        """Return the material of a slot, which may be None."""
        if material is None:
            return Made(Material("diffuse", {"reflectance": grey(PLAIN)}, name="no material"))
        key = material.name_full
        if key not in self._made:
            self._made[key] = self._make(material)
        return self._made[key]

    def _make(self, material: Any) -> Made:
        where = f"material {material.name!r}"
        shading = Shading(NodeValues(where, self._images, self._notices))
        output = active_output(material.node_tree, "OUTPUT_MATERIAL")
        if output is None:
            r, g, b = (float(x) for x in material.diffuse_color[:3])
            return Made(Material("diffuse", {"reflectance": replace(grey(0), constant=(r, g, b))}, name=material.name))
        surface = shading.surface(output.inputs["Surface"])
        for name in ("Volume", "Displacement"):
            if output.inputs[name].is_linked:
                self._notices.add(where, f"{name.lower()} is not supported and is left out")
        found = self._finished(shading, surface)
        return Made(replace(found, name=material.name), tuple(shading.uv_maps), shading.uses_images)

    def _finished(self, shading: Shading, surface: Surface) -> Material:
        base = surface.material or Material("diffuse", {"reflectance": grey(0)})
        light = surface.emission
        return replace(
            base,
            two_sided=True,
            opacity=shading.value(surface.opacity),
            emission=None if light is None else light.value(shading.uv_set, 0.0, float("inf")),
            emission_two_sided=True,
            vertex_colors=shading.values.uses_vertex_color,
        )
