# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Sixty frames along a flight, read from one solved cache: nothing is gathered, and nothing flickers.

The cache is solved for five views along the way and merged. A frame takes four samples a pixel, each frame with a seed of its
own. Flicker is that of indirect light alone: the points that the pixels of a frame see are looked up in the frames before and
after, away from edges, of lamps as well, where a pixel of four samples is never the same; "change" is the RMS difference to the
next frame in units of the RMS light, which holds what moving past gloss rightly changes; "flicker" is what is left of a steady
change, the second difference over √6, as large as the noise of a frame would be. Misses are diffuse vertices, and pixels whose
gloss, which could be cached, was traced.
"""

from __future__ import annotations

import time as clock
from dataclasses import replace
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

import eclat
from eclat.images.image import Image
from eclat.measure.metrics import away_from_edges
from eclat.scene import Camera
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.scenes import BenchmarkScene

FRAMES = 60
VIEWS = 5
SAMPLES = 4
PATHS: dict[str, tuple[tuple[float, float, float], float]] = {
    # How far the camera goes to the right, up and ahead, and by how many degrees it turns left meanwhile.
    "glossy-box-0.6": ((0.5, 0.15, 1.1), 6.0),
    "glossy-box-0.4": ((0.5, 0.15, 1.1), 6.0),
    "sponza-polished": ((0.3, 0.4, 4.0), 4.0),
    "sibenik-polished": ((0.5, 0.6, 6.0), -5.0),
}
FLAT = tuple[NDArray[np.float64], NDArray[np.float64]]


def along(camera: Camera, name: str, t: float, size: tuple[int, int]) -> Camera:
    """The camera at time t of 0..1, which sets out and stops gently."""
    (right, up, ahead), degrees = PATHS[name]
    ease = t * t * (3 - 2 * t)
    matrix = np.array(camera.to_world, np.float64)
    axes = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    angle = np.radians(degrees * ease)
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    matrix[:3, 3] += axes @ (ease * np.array([right, up, -ahead]))
    matrix[:3, :3] = matrix[:3, :3] @ turn
    return replace(camera, to_world=matrix, size=size, name=f"frame {t:g}")


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene, size = place.load(), place.size_for(settings.quick)
    frames = 6 if settings.quick else FRAMES
    first = scene.cameras[0]
    started = clock.perf_counter()
    common: dict[str, Any] = {"size": size, "threads": settings.threads}
    solved = [
        eclat.solve(scene, eclat.RadianceCache(), camera=along(first, name, t, size), check=False, **common)
        for t in np.linspace(0, 1, VIEWS)
    ]
    solution = reduce(eclat.merge, solved)
    solving = clock.perf_counter() - started
    cameras = [along(first, name, t, size) for t in np.linspace(0, 1, frames)]
    images: list[Image] = []
    calm: list[NDArray[np.bool_]] = []
    seconds: list[float] = []
    for i, camera in enumerate(cameras):
        before = clock.perf_counter()
        images.append(eclat.render(scene, solution, camera=camera, samples=SAMPLES, seed=i, adaptive=False, **common))
        seconds.append(clock.perf_counter() - before)
        calm.append(
            calm_pixels(images[-1], eclat.render(scene, eclat.Path(), camera=camera, samples=4, max_depth=1, **common))
        )
    return {
        "frames": frames, "size": size, "solve_seconds": solving, "records": len(solution),
        "radiance_records": len(solution.radiance or ()), "frame_seconds": float(np.median(seconds)),
        "misses": _misses(images), "traced": _traced(images), **flicker(images, cameras, calm),
    }  # fmt: skip


def _misses(images: list[Image]) -> float:
    """Diffuse vertices that no record served, per path."""
    count = sum(image.metadata["statistics"]["cache_misses"] for image in images)
    return float(count / sum(SAMPLES * image.width * image.height for image in images))


def _traced(images: list[Image]) -> float:
    """Of what pixels see of gloss, the part that was traced."""
    names = "gloss_cached", "gloss_traced"
    traced = sum(float(i.layers["gloss_traced"].mean()) for i in images)
    glossy = sum(float(np.maximum(*(i.layers[n] for n in names)).mean()) for i in images)
    return traced / glossy if glossy > 0 else 0.0


def calm_pixels(image: Image, emitted: Image) -> NDArray[np.bool_]:
    """(H, W) pixels away from edges, those between what shines and what does not included."""
    apart = np.pad(emitted.pixels.max(axis=-1), 2, mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(apart, (5, 5))
    same = around.max(axis=(-1, -2)) <= 1.01 * around.min(axis=(-1, -2))
    away = away_from_edges(image.layers["depth"], image.layers["normal"])
    return np.asarray(same & away.reshape(same.shape))


def flicker(images: list[Image], cameras: list[Camera], calm: list[NDArray[np.bool_]]) -> dict[str, float]:
    """Change and flicker of static points in `calm` pixels, everywhere and where gloss is cached."""
    sums = dict.fromkeys(("change", "flicker", "light", "points", "gloss_change", "gloss_flicker", "gloss_light"), 0.0)
    for k in range(1, len(images) - 1):
        points, seen = seen_points(images[k], cameras[k])
        seen &= calm[k]
        here = images[k].layers["indirect"].mean(axis=-1)
        earlier, was = _looked_up(images[k - 1], cameras[k - 1], calm[k - 1], points)
        later, will = _looked_up(images[k + 1], cameras[k + 1], calm[k + 1], points)
        static = seen & was & will
        gloss = static & (images[k].layers["gloss_cached"].reshape(static.shape) > 0.99)
        for prefix, where in (("", static), ("gloss_", gloss)):
            sums[prefix + "light"] += float((here[where] ** 2).sum())
            sums[prefix + "change"] += float(((later - here)[where] ** 2).sum())
            sums[prefix + "flicker"] += float(((later - 2 * here + earlier)[where] ** 2).sum() / 6)
        sums["points"] += float(static.mean()) / (len(images) - 2)

    def relative(name: str) -> float:
        light = sums["gloss_light" if name.startswith("gloss_") else "light"]
        return float(np.sqrt(sums[name] / light)) if light > 0 else 0.0

    return {n: relative(n) for n in ("change", "flicker", "gloss_change", "gloss_flicker")} | {"points": sums["points"]}


def seen_points(image: Image, camera: Camera) -> FLAT:
    """(H, W, 3) places that the middles of pixels see, and where there are any."""
    height, width = image.height, image.width
    half_width, half_height = camera.half_extent(width / height)
    x = (2 * (np.arange(width) + 0.5) / width - 1) * half_width
    y = (1 - 2 * (np.arange(height) + 0.5) / height) * half_height
    local = np.stack([*np.meshgrid(x, y), np.full((height, width), -1.0)], axis=-1)
    matrix = np.asarray(camera.to_world, np.float64)
    directions = local @ (matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)).T
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    depth = image.layers["depth"].reshape(height, width).astype(np.float64)
    met = np.isfinite(depth) & (depth > 0)
    return matrix[:3, 3] + np.where(met, depth, 1.0)[..., None] * directions, met


def _looked_up(image: Image, camera: Camera, calm: NDArray[np.bool_], points: NDArray[np.float64]) -> FLAT:
    """Mean of the channels of indirect light where `points` stand in a frame, between pixels, and where they are seen there."""
    height, width = image.height, image.width
    matrix = np.asarray(camera.to_world, np.float64)
    relative = points - matrix[:3, 3]
    local = relative @ (matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0))
    ahead = np.maximum(-local[..., 2], 1e-9)
    half_width, half_height = camera.half_extent(width / height)
    x = (local[..., 0] / ahead / half_width + 1) / 2 * width - 0.5
    y = (1 - local[..., 1] / ahead / half_height) / 2 * height - 0.5
    inside = (local[..., 2] < 0) & (x >= 0) & (y >= 0) & (x < width - 1) & (y < height - 1)
    column, row = (np.where(inside, np.floor(v), 0).astype(np.int64) for v in (x, y))
    u, v = x - column, y - row
    light = image.layers["indirect"].mean(axis=-1)
    depth = image.layers["depth"].reshape(height, width)
    found, seen = np.zeros(inside.shape), inside.copy()
    distance = np.linalg.norm(relative, axis=-1)
    for dy in (0, 1):
        for dx in (0, 1):
            weight = np.where(dx, u, 1 - u) * np.where(dy, v, 1 - v)
            found += weight * light[row + dy, column + dx]
            seen &= calm[row + dy, column + dx]
            with np.errstate(invalid="ignore"):
                seen &= np.abs(depth[row + dy, column + dx] - distance) < 0.03 * distance
    return found, seen


def tables(result: dict[str, Any]) -> str:
    rows = []
    for name, found in result["scenes"].items():
        rows.append([
            name, str(found["frames"]), f"{found['records']:,} + {found['radiance_records']:,}",
            document.seconds(found["solve_seconds"]), document.seconds(found["frame_seconds"]),
            document.percent(found["misses"]), document.percent(found["traced"]), document.percent(found["change"]),
            document.percent(found["flicker"]), document.percent(found["gloss_change"]),
            document.percent(found["gloss_flicker"]),
        ])  # fmt: skip
    header = [
        "scene", "frames", "records", "solves", "frame", "diffuse misses", "gloss traced", "change", "flicker",
        "change on gloss", "flicker on gloss",
    ]  # fmt: skip
    return document.table(header, rows)


BENCHMARK = Benchmark("fly-through", __doc__, tuple(PATHS), run, tables)

if __name__ == "__main__":
    main(BENCHMARK)
