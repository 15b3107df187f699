# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Éclat's irradiance cache in the race, and its radiance cache where there is gloss."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import eclat
from eclat.scene import Scene
from harness.entrant import Picture, timed
from harness.unavailable import UnavailableError

LEVELS = {0.08: 4, 0.04: 8, 0.02: 16, 0.01: 32, 0.005: 64}
"""max_error → samples a pixel: the less error is allowed, the less noise may be left in the direct light."""

SEED = 1


class Entrant:
    """Every picture solves afresh, on a scene that the core has not seen: tree, cache and picture count."""

    unbiased: ClassVar[bool] = False
    method: ClassVar[type[eclat.IrradianceCache]] = eclat.IrradianceCache

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        self.scene, self.size, self.threads = scene, size, threads
        self.levels = tuple(f"max_error {error:g}, {samples} samples" for error, samples in LEVELS.items())
        self.version = f"Éclat {eclat.__version__}"

    def render(self, level: int) -> Picture:
        error, samples = list(LEVELS.items())[level]
        scene, options = replace(self.scene), self.method(max_error=error)
        return timed(
            lambda: (
                eclat.render(scene, options, samples=samples, seed=SEED, size=self.size, threads=self.threads).pixels
            )
        )


class Glossy(Entrant):
    """Raises UnavailableError where all is diffuse, so that both caches are the same."""

    method: ClassVar[type[eclat.IrradianceCache]] = eclat.RadianceCache

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        if all(mesh.material.kind == "diffuse" for mesh in scene.meshes):
            raise UnavailableError("all is diffuse: it would draw what irradiance-cache draws")
        super().__init__(scene, size, threads)
