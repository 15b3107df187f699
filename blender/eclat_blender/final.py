# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A final picture: the scene is translated, rendered, and written to Blender's result while it grows."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import eclat
from eclat.errors import EclatError, heard_warnings

from . import passes
from .camera import scene_camera
from .film import without_background
from .notices import Notices
from .translate import translate
from .world import DrawWorld

PREVIEW_SAMPLES = 32
"""Paths per pixel of the small pictures of materials in Blender's panels."""


def draw_final(engine: Any, depsgraph: Any, draw_world: DrawWorld) -> None:
    """Render the view layer of a dependency graph into the result of a render engine.

    The engine has Blender's methods `begin_result`, `end_result`, `update_result`, `update_progress`, `update_stats`,
    `test_break`, `report` and `error_set`. Esc keeps the samples that were taken. What is not supported is reported.
    """
    with heard_warnings() as heard:
        notices = Notices()
        try:
            _Final(engine, depsgraph, draw_world, notices).run()
        except EclatError as error:
            engine.report({"ERROR"}, f"Éclat: {error}")
            engine.error_set(f"Éclat: {error}")
        for text in [*notices.texts, *dict.fromkeys(heard)]:
            engine.report({"WARNING"}, f"Éclat: {text}")


class _Final:
    def __init__(self, engine: Any, depsgraph: Any, draw_world: DrawWorld, notices: Notices) -> None:
        self.engine, self.depsgraph, self.notices = engine, depsgraph, notices
        self.draw_world = draw_world
        scene = depsgraph.scene
        self.settings, self.render = scene.eclat, scene.render
        self.size = picture_size(scene.render)
        self.crop = border(scene.render, self.size)
        self.passes = passes.wanted(depsgraph.view_layer)

    def run(self) -> None:
        engine = self.engine
        engine.update_stats("Éclat", "translating the scene")
        placed = self.depsgraph.scene.camera
        if placed is None:
            raise EclatError("the scene has no camera")
        if abs(self.render.pixel_aspect_x - self.render.pixel_aspect_y) > 1e-6:
            self.notices.add("output", "pixels that are not square are not supported; they are square")
        to_world = np.array(placed.matrix_world, float)
        self.camera = scene_camera(placed.data, to_world, self.size, self.notices)
        found = translate(self.depsgraph, self.draw_world, self.notices)
        scene = replace(found.scene, cameras=(self.camera,))
        for which in self.passes:
            engine.add_pass(which.name, len(which.channels), which.channels, layer=self.depsgraph.view_layer.name)
        try:
            image = eclat.render(
                scene, self._method(), preview=self._show, keep_partial=True, **self._quality(), **self._pixels()
            )
        except KeyboardInterrupt as stop:
            image = getattr(stop, "partial", None)
            if image is not None:
                self._write(image, self._layers(image, None), done=True)
            return
        self._write(image, self._layers(image, scene), done=True)
        self._tell(image)

    def _method(self) -> str:
        return "path" if self.engine.is_preview else self.settings.method

    def _quality(self) -> dict[str, Any]:
        if self.engine.is_preview:
            return {"samples": PREVIEW_SAMPLES}
        return quality(self.settings)

    def _pixels(self) -> dict[str, Any]:
        threads = self.render.threads if self.render.threads_mode == "FIXED" else None
        return {
            "camera": self.camera,
            "size": self.size,
            "crop": self.crop,
            "seed": self.settings.seed,
            "threads": threads,
            "progress": self._progress,
        }

    def _progress(self, phase: str, fraction: float, numbers: dict[str, float]) -> None:
        if self.engine.test_break():
            raise KeyboardInterrupt
        self.engine.update_progress(fraction)
        self.engine.update_stats("Éclat", f"{phase}: {100 * fraction:.0f} %")

    def _show(self, image: Any) -> None:
        self._write(image, self._layers(image, None), done=False)

    def _layers(self, image: Any, scene: Any) -> dict[str, np.ndarray]:
        """Make the passes. Without a `scene` the film is opaque, as in pictures that are not finished."""
        pixels, alpha = image.pixels, np.ones(image.pixels.shape[:2], np.float32)
        if self.render.film_transparent and scene is not None:
            chosen = {name: value for name, value in self._pixels().items() if name != "camera"}
            pixels, alpha = without_background(image, scene, self.camera, **chosen)
        combined = np.concatenate((pixels, alpha[..., None]), axis=-1)
        return {"Combined": combined} | {p.name: passes.layer_of(image, p, self.camera) for p in self.passes}

    def _write(self, image: Any, layers: dict[str, np.ndarray], done: bool) -> None:
        region = self.crop or (0, 0, image.width, image.height)
        x0, y0, x1, y1 = region
        low = 0 if self.render.use_crop_to_border and self.crop else image.height - y1
        left = 0 if self.render.use_crop_to_border and self.crop else x0
        result = self.engine.begin_result(left, low, x1 - x0, y1 - y0, layer=self.depsgraph.view_layer.name)
        passes.write(result, layers, region)
        if not done:
            self.engine.update_result(result)
        self.engine.end_result(result)

    def _tell(self, image: Any) -> None:
        numbers = image.metadata["statistics"]
        error = numbers.get("estimated_error", numbers.get("noise"))
        known = "" if error is None else f", error {100 * error:.1f} %"
        self.engine.report({"INFO"}, f"Éclat: {numbers['samples']:.0f} samples in {numbers['seconds']:.1f} s{known}")


def quality(settings: Any) -> dict[str, Any]:
    """Return those arguments of `eclat.render` that the panel sets."""
    found: dict[str, Any] = {"max_error": settings.max_error, "denoise": None if settings.denoise else False}
    if settings.use_time:
        found["time"] = settings.time
    elif settings.samples > 0:
        found |= {"samples": settings.samples, "denoise": settings.denoise}
    return found


def picture_size(render: Any) -> tuple[int, int]:
    """Return the width and height of the whole picture in pixels."""
    scale = render.resolution_percentage / 100
    return max(1, int(render.resolution_x * scale)), max(1, int(render.resolution_y * scale))


def border(render: Any, size: tuple[int, int]) -> tuple[int, int, int, int] | None:
    """Return the rectangle (x0, y0, x1, y1) of the render region, with y downwards, or None."""
    if not render.use_border:
        return None
    width, height = size
    x0, x1 = int(render.border_min_x * width), int(render.border_max_x * width)
    low, high = int(render.border_min_y * height), int(render.border_max_y * height)
    if x1 <= x0 or high <= low:
        return None
    return x0, height - high, x1, height - low
