# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine that Blender calls."""

from __future__ import annotations

from typing import Any

import bpy

from . import passes
from .final import draw_final
from .sky import draw_world
from .viewport_draw import ViewportDrawing


class EclatRenderEngine(bpy.types.RenderEngine):
    """Renders pictures and viewports with Éclat."""

    bl_idname = "ECLAT"
    bl_label = "Éclat"
    bl_use_preview = True
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True

    _viewport: ViewportDrawing | None = None

    def render(self, depsgraph: Any) -> None:
        draw_final(self, depsgraph, draw_world)

    def update_render_passes(self, scene: Any = None, renderlayer: Any = None) -> None:
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for which in passes.wanted(renderlayer):
            self.register_pass(scene, renderlayer, which.name, len(which.channels), which.channels, which.kind)

    def view_update(self, context: Any, depsgraph: Any) -> None:
        if self._viewport is None:
            self._viewport = ViewportDrawing(self)
        self._viewport.update(context, depsgraph)

    def view_draw(self, context: Any, depsgraph: Any) -> None:
        if self._viewport is not None:
            self._viewport.draw(context, depsgraph)

    def __del__(self) -> None:
        try:
            viewport = self._viewport
        except ReferenceError:  # Blender has freed its part of the engine; the thread ends at its next redraw.
            return
        if viewport is not None:
            viewport.close()
