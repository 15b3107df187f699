# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mitsuba 3 with Open Image Denoise as a peer: few paths, and a network that was trained to remove their noise.

The guides, albedo and normal of what a pixel sees, come from Mitsuba's `aov` integrator with the same paths.
"""

from __future__ import annotations

import importlib.util
from importlib.metadata import version
from typing import Any, ClassVar

import numpy as np

from eclat.scene import Scene
from harness import mitsuba_peer
from harness.entrant import Picture, Pixels, timed
from harness.unavailable import UnavailableError

SAMPLES = (4, 16, 64, 256)
GUIDES = "albedo:albedo,normal:sh_normal"


class Entrant:
    """Times hold the paths, the guides and the denoiser; Mitsuba's scene is built before, and its kernels too."""

    unbiased: ClassVar[bool] = False

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        if importlib.util.find_spec("pyoidn") is None:
            raise UnavailableError("Open Image Denoise is not installed: pip install '.[bench]' (PyPI pyoidn)")
        self.mitsuba = mitsuba_peer.start()
        mitsuba_peer.use_threads(threads)
        self.scene = mitsuba_peer.convert(self.mitsuba, scene, size)
        inner = {"type": "path", "max_depth": -1}
        self.integrator: Any = self.mitsuba.load_dict({"type": "aov", "aovs": GUIDES, "image": inner})
        self.levels = tuple(f"{samples} samples" for samples in SAMPLES)
        self.version = f"{mitsuba_peer.version(self.mitsuba)} + pyoidn {version('pyoidn')}"

    def render(self, level: int) -> Picture:
        return timed(lambda: self._draw(SAMPLES[level]))

    def _draw(self, samples: int) -> Pixels:
        layers = np.array(self.mitsuba.render(self.scene, integrator=self.integrator, spp=samples, seed=1))
        return denoise(layers[..., :3], np.clip(layers[..., 3:6], 0, 1), np.clip(layers[..., 6:9], -1, 1))


def denoise(color: Pixels, albedo: Pixels, normal: Pixels) -> Pixels:
    """Linear radiance without its noise; the best quality that Open Image Denoise offers."""
    import pyoidn

    color, albedo, normal = (np.ascontiguousarray(layer, np.float32) for layer in (color, albedo, normal))
    return np.asarray(pyoidn.denoise(color, albedo=albedo, normal=normal, hdr=True, quality="high"))
