#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Radiosity of the Cornell box in three steps: the patches as they were solved, light between them, and a final gather.

Run it as `examples/radiosity.py [FILE]`; it writes radiosity.jpg, or that file, in about half a minute.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

import eclat
from eclat.images.tone import srgb_encode
from eclat.scenes import build

SIZE = 400
EXPOSURE = 1.6


def to_bytes(radiance: np.ndarray) -> np.ndarray:
    """sRGB of linear radiance, 0..255."""
    encoded: np.ndarray = (255 * srgb_encode(np.clip(EXPOSURE * radiance, 0, 1)) + 0.5).astype(np.uint8)
    return encoded


def patches_as_polygons(scene: eclat.Scene, solution: eclat.RadiositySolution) -> Image.Image:
    """Each patch in one colour, its edges drawn, the farthest first."""
    camera = scene.cameras[0]
    to_world = np.asarray(camera.to_world, dtype=np.float64)
    eye, to_camera = to_world[:3, 3], np.linalg.inv(to_world)
    corners = solution.corners
    seen = np.einsum("nk,nk->n", solution.normals, eye - corners.mean(axis=1)) > 0
    local = corners @ to_camera[:3, :3].T + to_camera[:3, 3]
    depth = -local[..., 2]
    seen &= (depth > 1e-3).all(axis=1)
    scale = SIZE / 2 / np.tan(np.radians(camera.fov) / 2)
    pixels = np.stack([SIZE / 2 + scale * local[..., 0] / depth, SIZE / 2 - scale * local[..., 1] / depth], axis=-1)
    colors = to_bytes(solution.radiosity / np.pi)
    picture = Image.new("RGB", (SIZE, SIZE))
    draw = ImageDraw.Draw(picture)
    # The lamp hangs too close below the ceiling for an order by depth.
    for i in np.lexsort((-depth.max(axis=1), solution.emitted.max(axis=1) > 0)):
        if seen[i]:
            color = tuple(int(c) for c in colors[i])
            draw.polygon([tuple(p) for p in pixels[i]], fill=color, outline=tuple(3 * c // 4 for c in color))
    return picture


def main() -> None:
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("radiosity.jpg")
    scene = build("cornell-box")
    direct = eclat.solve(scene, eclat.Radiosity(patches=4000, gather=0))
    gathered = replace(direct, options=replace(direct.options, gather=8))
    pictures = [patches_as_polygons(scene, direct)]
    for solution, samples in ((direct, 16), (gathered, 64)):
        image = eclat.render(scene, solution, samples=samples, size=(SIZE, SIZE))
        pictures.append(Image.fromarray(to_bytes(image.pixels)))
    page = Image.new("RGB", (3 * SIZE + 20, SIZE), "white")
    for k, picture in enumerate(pictures):
        page.paste(picture, (k * (SIZE + 10), 0))
    page.save(out, quality=88)


if __name__ == "__main__":
    main()
