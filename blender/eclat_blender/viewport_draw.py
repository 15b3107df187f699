# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The viewport: translates the scene when it changes, and draws the latest picture of its `Refiner`."""

from __future__ import annotations

from typing import Any

import numpy as np

from .camera import view_camera
from .notices import Notices
from .sky import draw_world
from .translate import translate
from .viewport import Refiner


class ViewportDrawing:
    """What one viewport shows."""

    def __init__(self, engine: Any, refiner: Refiner | None = None) -> None:
        self._engine = engine
        self._refiner = refiner or Refiner(self._redraw)
        self._scene: Any = None
        self._view: tuple[Any, ...] | None = None
        self._texture: tuple[Any, Any] | None = None
        self._told: set[str] = set()

    def update(self, context: Any, depsgraph: Any) -> None:
        """Translate the scene anew."""
        self._refiner.stop()
        notices = Notices()
        self._scene = translate(depsgraph, draw_world, notices).scene
        for text in notices.texts:
            if text not in self._told:
                self._told.add(text)
                self._engine.report({"WARNING"}, f"Éclat: {text}")
        self._view = None

    def draw(self, context: Any, depsgraph: Any) -> None:
        """Show the latest picture; start anew if the view is another."""
        region, view = context.region, context.region_data
        size = (region.width, region.height)
        matrices = np.array(view.view_matrix, float), np.array(view.window_matrix, float)
        wanted = (size, matrices[0].tobytes(), matrices[1].tobytes())
        if wanted != self._view and self._scene is not None:
            self._view = wanted
            camera = view_camera(matrices[0], matrices[1], size)
            self._refiner.start(self._scene, camera, size, depsgraph.scene.eclat.denoise)
        status = self._refiner.error or f"{self._refiner.samples} paths per pixel"
        self._engine.update_stats("Éclat", status)
        if self._refiner.picture is not None:
            self._show(self._refiner.picture, depsgraph.scene, size)

    def close(self) -> None:
        """Stop drawing."""
        self._refiner.stop()

    def _redraw(self) -> None:
        try:
            self._engine.tag_redraw()
        except ReferenceError:  # Blender has freed the engine, so nobody looks any more.
            self._refiner.cancel()

    def _show(self, picture: np.ndarray, scene: Any, size: tuple[int, int]) -> None:
        import gpu
        from gpu_extras.presets import draw_texture_2d

        if self._texture is None or self._texture[0] is not picture:
            height, width = picture.shape[:2]
            opaque = np.dstack((picture, np.ones((height, width), np.float32)))[::-1]
            flat = np.ascontiguousarray(opaque, np.float32).reshape(-1)
            buffer = gpu.types.Buffer("FLOAT", flat.size, flat)
            self._texture = picture, gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)
        gpu.state.blend_set("ALPHA_PREMULT")
        self._engine.bind_display_space_shader(scene)
        draw_texture_2d(self._texture[1], (0, 0), *size)
        self._engine.unbind_display_space_shader()
        gpu.state.blend_set("NONE")
