# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Registering the classes of the add-on with Blender, and its engine with Blender's own panels."""

from __future__ import annotations

import bpy

from .bake import ECLAT_OT_bake_light_maps
from .engine import EclatRenderEngine
from .panels import PANELS
from .settings import EclatLayerSettings, EclatSceneSettings

CLASSES = (EclatSceneSettings, EclatLayerSettings, EclatRenderEngine, ECLAT_OT_bake_light_maps, *PANELS)

HIDDEN = {"VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes", "RENDER_PT_simplify", "RENDER_PT_freestyle"}
"""Blender's panels of settings that Éclat does not read."""


def register() -> None:
    """Register all classes, and show Blender's panels for the engine that others show for their own."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.eclat = bpy.props.PointerProperty(type=EclatSceneSettings)
    bpy.types.ViewLayer.eclat = bpy.props.PointerProperty(type=EclatLayerSettings)
    for panel in _shared_panels():
        panel.COMPAT_ENGINES.add(EclatRenderEngine.bl_idname)


def unregister() -> None:
    """Undo `register`."""
    for panel in _shared_panels():
        panel.COMPAT_ENGINES.discard(EclatRenderEngine.bl_idname)
    del bpy.types.ViewLayer.eclat
    del bpy.types.Scene.eclat
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)


def _shared_panels() -> list[type]:
    """Blender's own panels that every engine may show: lamps, cameras, materials, worlds, output."""
    return [
        panel
        for panel in bpy.types.Panel.__subclasses__()
        if "BLENDER_RENDER" in getattr(panel, "COMPAT_ENGINES", ()) and panel.__name__ not in HIDDEN
    ]
