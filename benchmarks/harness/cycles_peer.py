# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Blender's Cycles (PyPI `bpy`) in the race, with its denoiser, with and without path guiding.

Its plastics and metals are not ours (`cycles_scene`), so it is judged against its own long render.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from eclat.images.image import Image
from eclat.scene import Scene
from harness import cycles_scene
from harness.entrant import Picture
from harness.unavailable import UnavailableError

SAMPLES = (4, 16, 64, 256)
MOST_BOUNCES = 64
"""More than matters in any of the scenes; Cycles needs a number."""

SEED = 1


def start() -> Any:
    """The module `bpy`. Raises UnavailableError where it is missing or has no Cycles."""
    try:
        with quiet():
            import bpy
    except ImportError as error:
        how = "pip install --no-deps bpy==5.0.1 into Python 3.11, or that of Blender's newest release into its Python"
        raise UnavailableError(f"Blender's Cycles is not installed ({error}): {how}") from error
    if not bpy.app.build_options.cycles:
        raise UnavailableError("this bpy was built without Cycles")
    return bpy


class Entrant:
    """Times hold the samples and the denoiser; scene and tree are kept from the first picture."""

    unbiased: ClassVar[bool] = False
    guided: ClassVar[bool] = False

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        self.bpy = start()
        self.size = size
        with quiet():
            cycles_scene.build(self.bpy, scene, size)
        _unclamped(self.bpy, threads)
        self.levels = tuple(f"{samples} samples" for samples in SAMPLES)
        self.version = f"Cycles {self.bpy.app.version_string}"
        self._folder = tempfile.TemporaryDirectory()

    def render(self, level: int) -> Picture:
        return self._draw(SAMPLES[level], SEED, denoised=True)

    def truth(self, samples: int, seed: int) -> Picture:
        """A part of its own reference: as it is, without denoiser and guiding."""
        return self._draw(samples, seed % (1 << 31), denoised=False)

    def _draw(self, samples: int, seed: int, denoised: bool) -> Picture:
        scene = self.bpy.context.scene
        scene.cycles.samples, scene.cycles.seed = samples, seed
        scene.cycles.use_denoising = denoised
        scene.cycles.use_guiding = denoised and self.guided
        file = Path(self._folder.name) / "picture.exr"
        scene.render.filepath = str(file)
        with quiet():
            before = time.perf_counter()
            self.bpy.ops.render.render(write_still=True)
            seconds = time.perf_counter() - before
        pixels = np.asarray(Image.load(file).pixels, np.float32)
        if pixels.shape != (self.size[1], self.size[0], 3):
            raise RuntimeError(f"expected a picture of {self.size}, got an array of {pixels.shape}")
        return Picture(pixels, seconds)


class Guided(Entrant):
    """The same with path guiding."""

    guided: ClassVar[bool] = True


def _unclamped(bpy: Any, threads: int) -> None:
    """Settings with which Cycles converges to the light of the scene, written as floats."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", threads
    scene.render.use_persistent_data = True
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.color_depth = "32"
    scene.view_settings.view_transform = "Raw"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces"):
        setattr(cycles, name, MOST_BOUNCES)
    cycles.denoiser = "OPENIMAGEDENOISE"
    cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
    cycles.denoising_prefilter = "ACCURATE"


@contextmanager
def quiet() -> Iterator[None]:
    """Keep what Blender prints from the terminal."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(number) for number in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for number in (1, 2):
            os.dup2(nowhere, number)
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for number, copy in zip((1, 2), kept, strict=True):
            os.dup2(copy, number)
            os.close(copy)
        os.close(nowhere)
