# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of the engine in the properties of the render, the view layer, materials, lamps and worlds."""

from __future__ import annotations

from typing import Any

import bpy

from .passes import PASSES


class _Panel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {"ECLAT"}  # noqa: RUF012  (Blender reads a plain set)

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine in cls.COMPAT_ENGINES


class ECLAT_PT_quality(_Panel, bpy.types.Panel):  # noqa: N801  (Blender's rule for names)
    """The method and how good the picture is to be."""

    bl_label = "Éclat"
    bl_context = "render"

    def draw(self, context: Any) -> None:
        layout, settings = self.layout, context.scene.eclat
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(settings, "method")
        layout.prop(settings, "max_error")
        column = layout.column(heading="Limit Time")
        column.prop(settings, "use_time", text="")
        row = column.row()
        row.active = settings.use_time
        row.prop(settings, "time")
        row = layout.row()
        row.active = not settings.use_time
        row.prop(settings, "samples")
        layout.prop(settings, "denoise")
        layout.prop(settings, "seed")
        layout.prop(context.scene.render, "film_transparent", text="Transparent Film")


class ECLAT_PT_bake(_Panel, bpy.types.Panel):  # noqa: N801
    """Light maps of the selected objects."""

    bl_label = "Light Maps"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw(self, context: Any) -> None:
        layout, settings = self.layout, context.scene.eclat
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("bake_component", "bake_size", "bake_margin", "bake_samples"):
            layout.prop(settings, name)
        layout.operator("eclat.bake_light_maps")


class ECLAT_PT_passes(_Panel, bpy.types.Panel):  # noqa: N801
    """The passes of the view layer."""

    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context: Any) -> None:
        layout, view_layer = self.layout, context.view_layer
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        for which in PASSES:
            column.prop(view_layer.eclat if which.own else view_layer, which.switch)


class _Surface(_Panel):
    """The node at the surface output of a material, lamp or world, with its inputs."""

    bl_label = "Surface"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine in cls.COMPAT_ENGINES and cls.owner(context) is not None

    @staticmethod
    def owner(context: Any) -> Any:
        raise NotImplementedError

    def draw(self, context: Any) -> None:
        tree = self.owner(context).node_tree
        kinds = ("OUTPUT_MATERIAL", "OUTPUT_WORLD", "OUTPUT_LIGHT")
        output = None if tree is None else next((node for node in tree.nodes if node.type in kinds), None)
        if output is None:
            self.layout.label(text="No output node", icon="INFO")
            return
        self.layout.use_property_split = True
        self.layout.template_node_view(tree, output, output.inputs["Surface"])


class ECLAT_PT_material(_Surface, bpy.types.Panel):  # noqa: N801
    """The surface of a material."""

    bl_context = "material"

    @staticmethod
    def owner(context: Any) -> Any:
        return context.material


class ECLAT_PT_world(_Surface, bpy.types.Panel):  # noqa: N801
    """The surface of a world."""

    bl_context = "world"

    @staticmethod
    def owner(context: Any) -> Any:
        return context.world


class ECLAT_PT_light(_Panel, bpy.types.Panel):  # noqa: N801
    """The power, colour and size of a lamp."""

    bl_label = "Light"
    bl_context = "data"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine in cls.COMPAT_ENGINES and context.light is not None

    def draw(self, context: Any) -> None:
        layout, light = self.layout, context.light
        layout.use_property_split = True
        layout.prop(light, "type", expand=True)
        layout.prop(light, "color")
        layout.prop(light, "energy", text="Strength" if light.type == "SUN" else "Power")
        names = {
            "POINT": ("shadow_soft_size",),
            "SPOT": ("shadow_soft_size", "spot_size", "spot_blend"),
            "SUN": ("angle",),
            "AREA": ("shape", "size", "size_y")
            if getattr(light, "shape", "") in ("RECTANGLE", "ELLIPSE")
            else ("shape", "size"),
        }
        for name in names[light.type]:
            layout.prop(light, name)


PANELS = (ECLAT_PT_quality, ECLAT_PT_bake, ECLAT_PT_passes, ECLAT_PT_material, ECLAT_PT_world, ECLAT_PT_light)
