# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of a viewport, which a thread of its own refines until the view or the scene changes."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

import eclat
from eclat.errors import EclatError
from eclat.scene import Camera, Scene

STEPS = (2, 8, 32, 128, 512)
"""Paths per pixel after each step. They are even, because denoised pictures are made of two halves."""

FIRST_SIDE = 160
"""Longer side in pixels of the picture that is shown first."""


class Refiner:
    """Draws pictures of a scene, ever finer, in a thread. `picture` is the latest, (H, W, 3), row 0 on top.

    `changed` is called from the thread after every picture. `render` is `eclat.render` or stands in for it.
    """

    def __init__(self, changed: Callable[[], None], render: Callable[..., Any] = eclat.render) -> None:
        self._changed, self._render = changed, render
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self.picture: np.ndarray | None = None
        self.samples = 0
        self.error = ""

    @property
    def busy(self) -> bool:
        """Whether finer pictures are to come."""
        return self._thread is not None and self._thread.is_alive()

    def start(self, scene: Scene, camera: Camera, size: tuple[int, int], denoise: bool) -> None:
        """Stop what is drawn and draw `scene` as `camera` sees it, with `size` (width, height)."""
        self.stop()
        self._stop = threading.Event()
        self.samples, self.error = 0, ""
        arguments = (replace(scene, cameras=(camera,)), camera, size, denoise, self._stop)
        self._thread = threading.Thread(target=self._refine, args=arguments, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop drawing, and wait until the thread has ended."""
        self.cancel()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def cancel(self) -> None:
        """Ask the thread to end, without waiting for it."""
        self._stop.set()

    def _refine(
        self, scene: Scene, camera: Camera, size: tuple[int, int], denoise: bool, stop: threading.Event
    ) -> None:
        def progress(phase: str, fraction: float, numbers: dict[str, float]) -> None:
            if stop.is_set():
                raise KeyboardInterrupt

        take = {"camera": camera, "halves": True, "denoise": denoise, "progress": progress, "adaptive": False}
        try:
            shrink = min(1.0, FIRST_SIDE / max(size))
            small = (max(1, round(size[0] * shrink)), max(1, round(size[1] * shrink)))
            self._show(self._render(scene, "path", samples=STEPS[0], size=small, **take), 0, stop)
            image = None
            for samples in STEPS:
                more = {"size": size} if image is None else {"continued": image}
                if image is not None:
                    del take["halves"], take["adaptive"]
                    take |= {"halves": None, "adaptive": None}
                image = self._render(scene, "path", samples=samples, continuable=True, **more, **take)
                self._show(image, samples, stop)
        except KeyboardInterrupt:
            return
        except EclatError as error:
            self.error = str(error)
            self._changed()

    def _show(self, image: Any, samples: int, stop: threading.Event) -> None:
        if stop.is_set():
            raise KeyboardInterrupt
        self.picture, self.samples = image.pixels, samples
        self._changed()
