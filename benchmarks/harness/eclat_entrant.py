# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Éclat in the race: its irradiance cache, its radiance cache where there is gloss, and both it and paths denoised."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

import eclat
from eclat.images.denoiser import has_denoiser
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


PATHS = (4, 16, 64, 256)
"""Samples a pixel of the levels of paths."""

DENOISED_LEVELS = {0.16: 4, 0.08: 16, 0.04: 64, 0.02: 256}
"""max_error → samples a pixel of the denoised cache, a final gather: its error is nearly all noise."""


class _Denoised(Entrant):
    """Times hold everything, the denoiser too. The error is not measured: the race does that."""

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        if not has_denoiser():
            raise UnavailableError("Open Image Denoise is not installed: pip install '.[denoise]'")
        super().__init__(scene, size, threads)

    def _draw(self, options: eclat.Method, samples: int) -> Picture:
        scene = replace(self.scene)
        given: dict[str, Any] = {"samples": samples, "denoise": True, "check": False}
        return timed(
            lambda: eclat.render(scene, options, seed=SEED, size=self.size, threads=self.threads, **given).pixels
        )


class DenoisedPaths(_Denoised):
    """`Path()`, denoised."""

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        super().__init__(scene, size, threads)
        self.levels = tuple(f"{samples} samples" for samples in PATHS)

    def render(self, level: int) -> Picture:
        return self._draw(eclat.Path(), PATHS[level])


class DenoisedCache(_Denoised):
    """The irradiance cache, denoised."""

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        super().__init__(scene, size, threads)
        self.levels = tuple(f"max_error {error:g}, {samples} samples" for error, samples in DENOISED_LEVELS.items())

    def render(self, level: int) -> Picture:
        error, samples = list(DENOISED_LEVELS.items())[level]
        return self._draw(self.method(max_error=error), samples)
