# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A program for a Blender of its own: draws the world of a file with Cycles.

Called as `panorama.py -- world.blend world.npz width height`. The file that it writes holds `sky`, an equirectangular image
of the radiance without the discs of suns, row 0 on top and +x in its centre, and for a sun `direction`, the unit vector
towards it, `irradiance`, which it causes on a surface that faces it, and `angle`, its diameter in radians.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

SAMPLES = 4
"""Paths per pixel of a panorama, each of which sees the world at once."""

SUN_SAMPLES = 16
"""Paths per pixel of a sun."""

SUN_PIXELS = 128
"""Side in pixels of the picture of a sun. Its rim then passes through one pixel in seventy of its disc, and 16 samples a
pixel leave 0.1 % of its light uncertain."""

SUN_MARGIN = 2.0
"""Width of that picture over the diameter of the sun, for which the place in the panorama is good enough."""


def main(library: str, target: str, width: int, height: int) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(library) as (found, wanted):
        wanted.worlds = found.worlds
    scene = bpy.context.scene
    world = scene.world = wanted.worlds[0]
    camera = bpy.data.cameras.new("camera")
    placed = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(placed)
    scene.camera = placed
    configure(scene)
    suns = [node for node in world.node_tree.nodes if node.type == "TEX_SKY" and getattr(node, "sun_disc", False)]
    shot = Path(target).with_suffix(".exr")
    with_suns = panorama(scene, width, height, shot) if suns else None
    switch(suns, False)
    sky = panorama(scene, width, height, shot)
    arrays = {"sky": sky}
    if with_suns is not None and len(suns) == 1:
        disc = np.maximum(with_suns - sky, 0).sum(axis=-1)
        if disc.max() > 0:
            direction = brightest(disc)
            angle = float(suns[0].sun_size)
            arrays |= {"direction": direction, "angle": angle}
            arrays["irradiance"] = sun_irradiance(scene, suns, direction, angle, shot)
    np.savez(target, **arrays)


def configure(scene):
    scene.render.engine = "CYCLES"
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.film_transparent = False
    scene.view_settings.view_transform = "Raw"
    cycles = scene.cycles
    cycles.device, cycles.samples = "CPU", SAMPLES
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.pixel_filter_type = "BOX"


def switch(suns, on):
    for node in suns:
        node.sun_disc = on


def panorama(scene, width, height, shot):
    """Draw the whole world, (H, W, 3)."""
    camera = scene.camera.data
    camera.type = "PANO"
    holder = camera if hasattr(camera, "panorama_type") else camera.cycles
    holder.panorama_type = "EQUIRECTANGULAR"
    scene.camera.rotation_euler = (np.pi / 2, 0, -np.pi / 2)  # Looking along +x, with +z up.
    return shoot(scene, width, height, shot)


def brightest(disc):
    """Return the unit vector towards the centre of the light in an equirectangular image (H, W)."""
    height, width = disc.shape
    polar = (np.arange(height) + 0.5) / height * np.pi
    azimuth = np.pi - (np.arange(width) + 0.5) / width * 2 * np.pi
    light = disc * np.sin(polar)[:, None]
    x = (light * np.sin(polar)[:, None] * np.cos(azimuth)).sum()
    y = (light * np.sin(polar)[:, None] * np.sin(azimuth)).sum()
    z = (light * np.cos(polar)[:, None]).sum()
    return np.array((x, y, z)) / np.linalg.norm((x, y, z))


def sun_irradiance(scene, suns, direction, angle, shot):
    """Integrate the radiance of a sun, less the sky's behind it, over the solid angles of a narrow picture."""
    from mathutils import Vector

    camera = scene.camera.data
    camera.type, camera.sensor_fit = "PERSP", "HORIZONTAL"
    scene.cycles.samples = SUN_SAMPLES
    camera.angle = max(SUN_MARGIN * angle, 0.01)
    scene.camera.rotation_euler = Vector(direction).to_track_quat("-Z", "Y").to_euler()
    pictures = []
    for on in (True, False):
        switch(suns, on)
        pictures.append(shoot(scene, SUN_PIXELS, SUN_PIXELS, shot))
    side = 2 * np.tan(camera.angle / 2)
    at = ((np.arange(SUN_PIXELS) + 0.5) / SUN_PIXELS - 0.5) * side
    cosine = 1 / np.sqrt(1 + at[None, :] ** 2 + at[:, None] ** 2)
    solid_angle = (side / SUN_PIXELS) ** 2 * cosine**3
    return ((pictures[0] - pictures[1]) * solid_angle[..., None]).sum(axis=(0, 1))


def shoot(scene, width, height, shot):
    """Render what the camera sees, (H, W, 3), row 0 on top."""
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.filepath = str(shot)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(shot))
    flat = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(flat)
    bpy.data.images.remove(image)
    return flat.reshape(height, width, 4)[::-1, :, :3]


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :]
    main(given[0], given[1], int(given[2]), int(given[3]))
