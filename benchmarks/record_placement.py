# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Where records lie, and how much error is left at equal numbers of them, by what their radius follows.

The comparison of Schwarzhaupt, Jensen and Jarosz (2012): the Cornell box, one bounce, gathers of about 4000 rays, as many
records for each metric, reached by bisection on `spacing`. The error is that of the one-bounce light alone, against two
path-traced references. Takes some minutes on an idle machine.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Picture

import eclat
from eclat.images.image import Image
from eclat.images.record_overlay import visible_pixels
from eclat.images.tone import to_display
from eclat.scene import Scene
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.machine import ROOT
from harness.scenes import BenchmarkScene

RECORDS = 1700
SIDE = 256
DEPTH = 3
"""Edges of a path: the camera's, one bounce, the light's."""

ROWS = 36
"""Of a gather: 4068 rays, the paper has 4096."""

LARGEST = 150 / 1800
"""Of the picture's width: the paper's bound of the split sphere, 150 of 1800 pixels."""

FROM_LAMP = 6
"""Pixels beside the lamp that the second error leaves out. It hangs 1 cm under the ceiling, whose light ends behind it."""

PAGE = ROOT / "docs" / "algorithms" / "record_placement.md"
PICTURE = ROOT / "docs" / "pictures" / "record-placement.jpg"
SEED = 1
SAMPLES = 32
"""A pixel, of each picture: at edges pixels are noisy, however good records are."""

UNBOUNDED: dict[str, Any] = {
    "largest_pixels": 1e5, "gradient_limit": False, "obstacle_limit": False, "neighbor_clamping": False,
    "adaptive": False, "relaxation": 1.0,
}  # fmt: skip
SPLIT_SPHERE: dict[str, Any] = UNBOUNDED | {"metric": "harmonic", "weight": "split-sphere"}

COMPETITORS: dict[str, tuple[dict[str, Any], float]] = {
    "split sphere, pure": (SPLIT_SPHERE, 0.22),
    "split sphere, bounded": (SPLIT_SPHERE | {"gradient_limit": True, "largest_pixels": LARGEST * SIDE}, 0.27),
    "radiometric Hessian": (UNBOUNDED | {"metric": "radiometric", "balanced": "absolute"}, 1.5),
    "geometric Hessian": (UNBOUNDED | {"metric": "geometric", "balanced": "absolute"}, 1.0),
    "occlusion Hessian": (UNBOUNDED | {"metric": "occlusion", "balanced": "absolute"}, 1.7),
    "occlusion Hessian, even squares": (UNBOUNDED | {"metric": "occlusion"}, 0.82),
    "harmonic mean, our guards": ({"metric": "harmonic", "adaptive": False}, 0.75),
    "least distance, our guards": ({"metric": "minimum", "adaptive": False}, 0.94),
    "occlusion Hessian, our guards": ({"adaptive": False}, 1.08),
    "occlusion Hessian, all defaults": ({}, 4.5),
}
"""Name → options, and a spacing to begin with. The first five are the paper's; the guards are Éclat's defaults."""


def solve_for(scene: Scene, settings: Settings, name: str, side: int, records: int) -> eclat.Solution:
    """A solution with `records` records within 2 %, or the nearest of eight attempts: by the secant in logarithms."""
    fields, spacing = COMPETITORS[name]
    rows = 12 if settings.quick else ROWS
    attempts: list[tuple[float, float, eclat.Solution]] = []
    for _ in range(8):
        options = eclat.IrradianceCache(**fields | {"rows": rows, "least_pixels": 0.25, "spacing": spacing})
        found = eclat.solve(
            scene, options, size=(side, side), max_depth=DEPTH, seed=SEED, check=False, threads=settings.threads
        )
        attempts.append((math.log(spacing), math.log(len(found) / records), found))
        if abs(attempts[-1][1]) < 0.02:
            break
        slope = -1.3
        if len(attempts) > 1 and attempts[-1][0] != attempts[-2][0]:
            slope = (attempts[-1][1] - attempts[-2][1]) / (attempts[-1][0] - attempts[-2][0])
        log_spacing = attempts[-1][0] - attempts[-1][1] / min(-0.3, max(-2.5, slope))
        spacing = float(np.clip(math.exp(log_spacing), 0.02, 8))
    return min(attempts, key=lambda a: abs(a[1]))[2]


def one_bounce(scene: Scene, what: Any, side: int, samples: int, seed: int, threads: int) -> Image:
    return eclat.render(
        scene, what, samples=samples, size=(side, side), max_depth=DEPTH, seed=seed, threads=threads, check=False
    )


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene = place.load()
    side, records = (64, 200) if settings.quick else (SIDE, RECORDS)
    references = [
        one_bounce(scene, eclat.Path(), side, settings.reference_samples, s, settings.threads) for s in (8, 9)
    ]
    a, b = (r.layers["indirect"] for r in references)
    truth = (a + b) / 2
    lamp = references[0].layers["direct"].max(axis=2) > 4
    rows, columns = np.nonzero(lamp)
    beside = np.zeros_like(lamp)
    beside[
        max(0, rows.min() - FROM_LAMP) : rows.max() + FROM_LAMP + 1,
        max(0, columns.min() - FROM_LAMP) : columns.max() + FROM_LAMP + 1,
    ] = True
    found: dict[str, Any] = {}
    tiles = []
    for label in COMPETITORS:
        solution = solve_for(scene, settings, label, side, records)
        pair = [one_bounce(scene, solution, side, SAMPLES, SEED + s, settings.threads) for s in (0, 1)]
        squares = ((pair[0].layers["indirect"] - a) * (pair[1].layers["indirect"] - b)).mean(axis=2)
        misses = pair[0].metadata["statistics"].get("cache_misses", 0) / (SAMPLES * side * side)
        found[label] = {
            "records": len(solution), "spacing": solution.options.spacing, "misses": misses,
            "error": _relative(squares, truth), "error_off_lamp": _relative(squares[~beside], truth),
        }  # fmt: skip
        print(label, found[label], flush=True)
        tiles.append(_tile(scene, solution, pair, truth))
    if not settings.quick:
        PICTURE.parent.mkdir(exist_ok=True)
        Picture.fromarray(_montage(tiles)).save(PICTURE, quality=80)
    return {"placements": found, "size": (side, side), "reference_samples": settings.reference_samples}


def _relative(squares: NDArray[np.float32], truth: NDArray[np.float32]) -> float:
    """RMS error in units of the picture's mean one-bounce light."""
    return float(math.sqrt(max(0.0, float(squares.mean()))) / truth.mean())


def _tile(scene: Scene, solution: eclat.Solution, pair: list[Image], truth: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Records as dots on the light that they show, above their error: red too bright, blue too dark, white at ± 20 %."""
    shown = replace(pair[0], pixels=pair[0].layers["indirect"]).pixels
    light = to_display(0.4 * shown, exposure=float(np.log2(0.3 / truth.mean())))
    for x, y in visible_pixels(pair[0], scene.cameras[0], solution.positions):
        light[y, x] = (255, 255, 255)
    error = sum(p.layers["indirect"] for p in pair).mean(axis=2) / 2 - truth.mean(axis=2)
    error = np.clip(5 * error / (truth.mean(axis=2) + 0.1 * truth.mean()), -1, 1)
    map_ = np.stack([255 * np.clip(error, 0, 1), 0 * error, 255 * np.clip(-error, 0, 1)], axis=2).astype(np.uint8)
    return np.concatenate([light, map_])


def _montage(tiles: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """The paper's five, then the others, two tiles deep each."""
    blank = np.zeros_like(tiles[0])
    rows = [tiles[:5], tiles[5:]]
    return np.concatenate([np.concatenate([*row, *[blank] * (5 - len(row))], axis=1) for row in rows])


def tables(result: dict[str, Any]) -> str:
    (scene,) = result["scenes"].values()
    placements = scene["placements"]
    best = placements["occlusion Hessian"]["error_off_lamp"]
    rows = [
        [label, f"{p['records']:,}", f"{p['spacing']:.3g}", document.percent(p["error"]),
         document.percent(p["error_off_lamp"]), document.ratio(p["error_off_lamp"] / best), document.percent(p["misses"])]
        for label, p in placements.items()
    ]  # fmt: skip
    header = [
        "radius follows",
        "records",
        "spacing",
        "error, all pixels",
        "off the lamp",
        "ratio, off the lamp",
        "misses",
    ]
    return document.table(header, rows)


BENCHMARK = Benchmark("record-placement", __doc__, ("cornell-box",), run, tables, reference_samples=512, page=PAGE)

if __name__ == "__main__":
    main(BENCHMARK)
