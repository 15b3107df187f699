# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A program for a Python that has `bpy`: draws the scenes with Éclat and with Cycles, and prints their means as JSON.

With `blender/` and `python/` in PYTHONPATH, called as `compare.py FOLDER SAMPLES [NAME …]`; the folder gets the .blend
files, the pictures, and pairs of them as PNG.
"""

import json
import sys
import time
from pathlib import Path

import bpy
import numpy as np
import scenes

import eclat_blender
from eclat.images.image import LAYERS
from eclat.images.image_files import Content, encode_png


def draw(engine: str, target: Path, samples: int) -> np.ndarray:
    """Draw the scene and return its picture (H, W, 4), row 0 on top."""
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.color_mode = "RGBA"
    scene.view_settings.view_transform = "Raw"
    if engine == "CYCLES":
        cycles = scene.cycles
        cycles.device, cycles.samples = "CPU", samples
        cycles.use_denoising = cycles.use_adaptive_sampling = False
        cycles.sample_clamp_indirect = cycles.sample_clamp_direct = cycles.blur_glossy = 0.0
        cycles.light_sampling_threshold, cycles.pixel_filter_type = 0.0, "BOX"
        cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 32
    else:
        scene.eclat.method, scene.eclat.samples, scene.eclat.denoise = "path", samples, False
    scene.render.filepath = str(target)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(target))
    width, height = image.size
    flat = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(flat)
    bpy.data.images.remove(image)
    return flat.reshape(height, width, 4)[::-1]


def main(folder: Path, samples: int, names: list[str]) -> None:
    eclat_blender.register()
    found = {}
    for name in names or [make.__name__ for make in scenes.SCENES]:
        scenes.build(name)
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / f"{name}.blend"))
        before = time.perf_counter()
        ours = draw("ECLAT", folder / f"{name}-eclat.exr", samples)
        between = time.perf_counter()
        theirs = draw("CYCLES", folder / f"{name}-cycles.exr", samples)
        pair = np.hstack((ours[..., :3], theirs[..., :3])).repeat(5, axis=0).repeat(5, axis=1)
        (folder / f"{name}.png").write_bytes(encode_png(Content(pair, {}, {}), LAYERS, 0.0, "none"))
        found[name] = {
            "ours": ours.mean((0, 1)).tolist(), "theirs": theirs.mean((0, 1)).tolist(),
            "left": ours[:, :48].mean(), "left_theirs": theirs[:, :48].mean(),
            "difference": float(np.abs(ours - theirs).mean() / np.abs(theirs).mean()),
            "seconds": (between - before, time.perf_counter() - between),
        }  # fmt: skip
        a, b = np.array(found[name]["ours"]), np.array(found[name]["theirs"])
        print("MEANS", name, f"{a[:3].mean() / b[:3].mean():.4f}", np.round(a / np.maximum(b, 1e-9), 4), flush=True)
    (folder / "means.json").write_text(json.dumps(found, default=float))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3:])
