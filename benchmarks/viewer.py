# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How close the page of `eclat view` is to `eclat render` with the same records, at cameras along a path, and what it costs.

Says for each scene the relative RMSE of the page's linear picture against `render` away from edges (of shapes and of lamps),
apart for surfaces without gloss and for gloss from records; then records, bytes, fragments of splats per pixel, and the
seconds of a picture by headless Chromium with software WebGL. With --growth it says how soon a page that begins without
records gets its first ones, when the view is finished, and what a solve of it takes. The pictures go into --folder, those
of the page beside those of `render`.

    python benchmarks/viewer.py cornell-box glossy-box-0.4 --cameras 10 --width 128
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import replace
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image as PillowImage

import eclat
from eclat.images.tone import to_display
from eclat.measure.metrics import relative_rmse
from eclat.methods.records.solution import Solution
from eclat.scene import Camera, Scene
from eclat.viewer.contents import GLOSS, RECORDS, SCENE
from eclat.viewer.contents import LIGHT as LIGHT_MAP
from fly_through import calm_pixels
from harness.machine import ROOT
from harness.scenes import SCENES

sys.path.insert(0, str(ROOT / "tests"))
from support.browser import look_at_page

SUPERSAMPLING = 3
"""The page takes one sample of a pixel, and `render` averages over it, so that the page draws larger pictures."""

SAMPLES = 32
"""Samples a pixel of each of two pictures of `render`, whose noise cancels from the error."""

VIEWS = 4
"""Number of cameras along the path that the records are solved for."""

PATHS: dict[str, tuple[tuple[float, float, float], float]] = {
    "cornell-box": ((0.3, 0.1, 0.6), 10.0),
    "glossy-box-0.4": ((0.3, 0.1, 0.6), 6.0),
    "glossy-box-0.6": ((0.3, 0.1, 0.6), 6.0),
    "atrium": ((1.0, 0.4, 3.0), 8.0),
    "sibenik-polished": ((0.5, 0.6, 4.0), -5.0),
    "living-room": ((0.2, 0.1, 0.8), -8.0),
}
"""How far the camera goes to the right, up and ahead in metres, and by how many degrees it turns left meanwhile."""

GLOSSY = ("glossy-box-0.4", "glossy-box-0.6", "sibenik-polished")


def cameras_along(scene: Scene, name: str, count: int, size: tuple[int, int]) -> tuple[Camera, ...]:
    """Return cameras along the path from the first camera of the scene."""
    (right, up, ahead), degrees = PATHS[name]
    matrix = np.array(scene.cameras[0].to_world, np.float64)
    axes = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    cameras = []
    for t in np.linspace(0, 1, count):
        angle = np.radians(degrees * t)
        turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
        moved = matrix.copy()
        moved[:3, 3] += axes @ (t * np.array([right, up, -ahead]))
        moved[:3, :3] = matrix[:3, :3] @ turn
        cameras.append(replace(scene.cameras[0], to_world=moved, size=size, name=f"camera {t:.2f}"))
    return tuple(cameras)


def averaged(pixels: np.ndarray, times: int) -> np.ndarray:
    height, width, channels = pixels.shape
    return pixels.reshape(height // times, times, width // times, times, channels).mean(axis=(1, 3))


def run(name: str, count: int, width: int, max_error: float, folder: Path | None) -> dict[str, Any]:
    """Solve the scene for some of the cameras, look at all, and compare."""
    place = SCENES[name]
    size = place.size_for(quick=False, side=width)
    scene = place.load()
    cameras = cameras_along(scene, name, count, size)
    scene = replace(scene, cameras=cameras)
    method = (eclat.RadianceCache if name in GLOSSY else eclat.IrradianceCache)(max_error=max_error)
    chosen = sorted({round(i) for i in np.linspace(0, count - 1, min(VIEWS, count))})
    solved = [eclat.solve(scene, method, camera=cameras[i], size=size, check=False) for i in chosen]
    solution = reduce(eclat.merge, solved)
    asked = [
        {"camera": i, "width": SUPERSAMPLING * size[0], "height": SUPERSAMPLING * size[1], "work": i == 0}
        for i in range(count)
    ]
    with eclat.view(scene, solution) as viewer:
        page = look_at_page(viewer.url, asked)
        files = viewer.contents.messages()
    rows = []
    for i, (camera, large, marked) in enumerate(zip(cameras, page.pictures, page.approximated, strict=True)):
        shown = averaged(large, SUPERSAMPLING)
        approximated = averaged(marked[..., None].astype(float), SUPERSAMPLING)[..., 0] > 0
        rows.append(compare(scene, solution, camera, shown, approximated, i) | {"camera": i})
        if folder is not None:
            save(folder / f"{name}-{i}.png", shown, rows[-1].pop("reference"))
        rows[-1].pop("reference", None)
    fields = [row[kind] for kind in ("matte", "gloss") for row in rows if row[kind] is not None]
    return {
        "scene": name, "size": size, "records": len(solution), "gloss records": len(solution.radiance or ()),
        "bytes": {kind: len(files[kind]) for kind in (SCENE, LIGHT_MAP, RECORDS, GLOSS)},
        "work": page.work[0], "seconds": page.seconds[0], "messages": page.messages, "rows": rows,
        "worst": max(fields, default=None),
    }  # fmt: skip


def compare(
    scene: Scene, solution: Solution, camera: Camera, shown: np.ndarray, approximated: np.ndarray, number: int
) -> dict[str, Any]:
    """Compare a picture of the page with two of `render`, but for the pixels (H, W) that the page marks as approximated."""
    a, b = (
        eclat.render(scene, solution, camera=camera, samples=SAMPLES, seed=2 * number + half, adaptive=False)
        for half in range(2)
    )
    emitted = eclat.render(scene, eclat.Path(), camera=camera, samples=4, max_depth=1, adaptive=False)
    calm = calm_pixels(a, emitted) & (emitted.pixels.max(axis=-1) <= 0)
    cached, traced = (a.layers.get(f"gloss_{kind}", np.zeros(calm.shape)) for kind in ("cached", "traced"))
    calm &= ~approximated  # records of irradiance alone leave no layers that tell gloss
    kinds = {"matte": calm & (cached <= 0) & (traced <= 0), "gloss": calm & (cached > 0.99)}
    least = 0.005 * calm.size
    found: dict[str, Any] = {
        kind: relative_rmse(shown, a.pixels, b.pixels, mask=mask) if mask.sum() > least else None
        for kind, mask in kinds.items()
    }
    shares = {f"{kind} share": float(mask.mean()) for kind, mask in kinds.items()}
    return found | shares | {"reference": (a.pixels + b.pixels) / 2}


def save(file: Path, shown: np.ndarray, reference: np.ndarray) -> None:
    """Write the page's picture beside the reference, and their difference by tenfold."""
    exposure = 0.4 / max(1e-6, float(np.median(reference[reference.max(axis=-1) > 0])))
    difference = 0.5 + 10 * exposure * (shown - reference) / 2
    parts = [exposure * shown, exposure * reference, difference]
    pixels = np.concatenate([np.asarray(to_display(part.clip(0, None)), np.float64) for part in parts], axis=1)
    scaled = pixels if pixels.max() > 1 else 255 * pixels
    file.parent.mkdir(parents=True, exist_ok=True)
    PillowImage.fromarray(scaled.clip(0, 255).astype(np.uint8)).save(file)


def growth(name: str, width: int, max_error: float) -> dict[str, Any]:
    """Measure how soon a page that begins without records has light, and when its view is finished."""
    from websockets.sync.client import connect

    place = SCENES[name]
    size = place.size_for(quick=False, side=width)
    scene = place.load()
    method = eclat.IrradianceCache(max_error=max_error)
    with eclat.view(scene, method, samples=16, texel_size=0.2) as viewer:
        camera = scene.cameras[0]
        matrix = np.array(camera.to_world, np.float64)
        matrix[:3, :3] /= np.linalg.norm(matrix[:3, :3], axis=0)
        matrix[:3, 3] -= viewer.solution.center
        half = np.tan(np.radians(camera.fov) / 2)
        view = {
            "to_world": matrix.ravel().tolist(), "half_extent": [half * size[0] / size[1], half],
            "shift": [0, 0], "orthographic": False, "size": size,
        }  # fmt: skip
        address = viewer.url.replace("http:", "ws:") + "live"
        origin = viewer.url.rsplit("/", 2)[0]
        with connect(address, origin=origin, max_size=None) as page:
            page.send(json.dumps({"kind": "wish", "view": view}))
            started = time.perf_counter()
            first = 0.0
            while True:
                message = page.recv(timeout=600)
                if isinstance(message, bytes):
                    first = first or time.perf_counter() - started
                    continue
                state = json.loads(message)
                if state["records"] > 0 and not state["solving"]:
                    break
            finished = time.perf_counter() - started
        records = len(viewer.solution)
    started = time.perf_counter()
    anew = eclat.solve(scene, method, size=size, check=False)
    return {
        "scene": name, "size": size, "first": first, "finished": finished, "records": records,
        "anew": time.perf_counter() - started, "anew records": len(anew),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", choices=PATHS)
    parser.add_argument("--cameras", type=int, default=10)
    parser.add_argument("--width", type=int, default=128)
    parser.add_argument("--max-error", type=float, default=0.02)
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--growth", action="store_true")
    asked = parser.parse_args()
    for name in asked.scenes:
        if asked.growth:
            print(json.dumps(growth(name, asked.width, asked.max_error)), flush=True)
        else:
            print(json.dumps(run(name, asked.cameras, asked.width, asked.max_error, asked.folder)), flush=True)


if __name__ == "__main__":
    main()
