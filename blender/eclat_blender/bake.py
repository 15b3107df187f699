# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator that bakes light maps of the selected objects, in their own UV maps."""

from __future__ import annotations

from typing import Any

import bpy

from eclat.errors import EclatError, heard_warnings

from .light_maps import LightMaps
from .notices import Notices
from .sky import draw_world
from .translate import translate


class ECLAT_OT_bake_light_maps(bpy.types.Operator):  # noqa: N801  (Blender's rule for names)
    """Bake the light that falls on the selected objects into images, by their UV maps that render"""

    bl_idname = "eclat.bake_light_maps"
    bl_label = "Bake Selected Objects"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: Any) -> bool:
        return any(thing.type == "MESH" for thing in context.selected_objects)

    def execute(self, context: Any) -> set[str]:
        chosen = [thing.name_full for thing in context.selected_objects if thing.type == "MESH"]
        notices, made = Notices(), 0
        manager = context.window_manager
        manager.progress_begin(0, len(chosen))
        with heard_warnings() as heard:
            try:
                found = translate(context.evaluated_depsgraph_get(), draw_world, notices)
                maps = LightMaps(found, context.scene.eclat)
                for done, name in enumerate(chosen):
                    pixels = maps.bake(name)
                    manager.progress_update(done + 1)
                    if pixels is not None:
                        _store(f"{name} light map", pixels)
                        made += 1
            except EclatError as error:
                self.report({"ERROR"}, f"Éclat: {error}")
            finally:
                manager.progress_end()
        for text in [*notices.texts, *dict.fromkeys(heard)]:
            self.report({"WARNING"}, f"Éclat: {text}")
        if made:
            self.report({"INFO"}, f"Éclat: {made} light maps of irradiance in W/m²")
        return {"FINISHED"} if made else {"CANCELLED"}


def _store(name: str, pixels: Any) -> None:
    """Keep linear RGB (H, W, 3), row 0 on top, as an image that is packed into the file."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.get(name)
    if image is not None and tuple(image.size) != (width, height):
        bpy.data.images.remove(image)
        image = None
    if image is None:
        image = bpy.data.images.new(name, width, height, alpha=False, float_buffer=True, is_data=True)
    import numpy as np

    opaque = np.dstack((pixels, np.ones((height, width), np.float32)))[::-1]
    image.pixels.foreach_set(np.ascontiguousarray(opaque, np.float32).reshape(-1))
    image.update()
    image.pack()
