# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A program for a Blender of its own: draws the world of a file with Cycles as an equirectangular image.

Called as `panorama.py -- world.blend picture.npy width height`.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

SAMPLES = 16
"""Paths per pixel, which see the world at once; they smooth the rim of a sun."""


def main(library: str, target: str, width: int, height: int) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(library) as (found, wanted):
        wanted.worlds = found.worlds
    scene = bpy.context.scene
    scene.world = wanted.worlds[0]
    camera = bpy.data.cameras.new("camera")
    camera.type = "PANO"
    holder = camera if hasattr(camera, "panorama_type") else camera.cycles
    holder.panorama_type = "EQUIRECTANGULAR"
    placed = bpy.data.objects.new("camera", camera)
    placed.rotation_euler = (np.pi / 2, 0, -np.pi / 2)  # Looking along +x, with +z up.
    scene.collection.objects.link(placed)
    scene.camera = placed
    _settings(scene, width, height)
    picture = Path(target).with_suffix(".exr")
    scene.render.filepath = str(picture)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(picture))
    flat = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(flat)
    np.save(target, flat.reshape(height, width, 4)[::-1, :, :3])


def _settings(scene, width, height):
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.film_transparent = False
    scene.view_settings.view_transform = "Raw"
    cycles = scene.cycles
    cycles.device, cycles.samples = "CPU", SAMPLES
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.pixel_filter_type = "BOX"


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :]
    main(given[0], given[1], int(given[2]), int(given[3]))
