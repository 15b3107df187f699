# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Radiance caching against path tracing, with and without Open Image Denoise: error against time where surfaces are glossy.

Errors as in equal_error.py. `irradiance-cache` is the same cache with all gloss traced, which tells what records of radiance
bring. The denoised pictures are Éclat's own paths and guides, and Mitsuba 3's (which traces paths faster) where it has the
materials; both need PyPI pyoidn, and are left out without. A time that path tracing did not reach is extrapolated by error
∝ 1/√time (marked ≈); for the others nothing is. Draws docs/benchmarks/glossy-SCENE.svg. Takes about an hour the first time,
most of it for the references.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import eclat
from eclat.images.image import Image
from eclat.methods import Method
from eclat.scene import Scene
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.curves import Levels, Point, as_rows, cost_at, error_plots, from_rows, measure
from harness.denoised_peer import denoise
from harness.references import reference
from harness.scenes import BenchmarkScene
from harness.unavailable import UnavailableError
from harness.worker import Worker, WorkerError

CACHE_LEVELS = {0.08: 4, 0.04: 8, 0.02: 12, 0.01: 16, 0.005: 32}
"""max_error → samples a pixel."""

PATH_SAMPLES = (1, 4, 16, 64, 256)
DENOISED_SAMPLES = (4, 16, 64, 256)
WANTED = (0.02, 0.013, 0.01)
SEED = 1

CACHED, TRACED, PATH = "radiance-cache", "irradiance-cache", "path"
DENOISED, PEER = "path + OIDN", "Mitsuba 3 + OIDN"


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene, size = place.load(), place.size_for(settings.quick)
    truth = reference(name, scene, size, place.c, settings.reference_samples)
    shared: dict[str, Any] = {"size": size, "threads": settings.threads}
    first = slice(2 if settings.quick else None)

    def caches(method: type[eclat.IrradianceCache]) -> Levels[Image]:
        levels = list(CACHE_LEVELS.items())[first]
        return {f"max_error {e:g}, {n} samples": partial(_picture, method(max_error=e), n, shared) for e, n in levels}

    series: dict[str, Levels[Image]] = {
        CACHED: caches(eclat.RadianceCache),
        TRACED: caches(eclat.IrradianceCache),
        PATH: {f"{n} samples": partial(_picture, eclat.Path(), n, shared) for n in PATH_SAMPLES[first]},
    }
    skipped: dict[str, str] = {}
    peer: Worker | None = None
    if importlib.util.find_spec("pyoidn") is None:
        skipped[DENOISED] = skipped[PEER] = "Open Image Denoise is not installed: pip install '.[bench]' (PyPI pyoidn)"
    else:
        series[DENOISED] = {f"{n} samples": partial(_denoised, n, shared) for n in DENOISED_SAMPLES[first]}
        try:
            peer = Worker("harness.denoised_peer:Entrant", scene, size, settings.threads)
            drawn: list[Callable[[Scene], Image]] = [partial(_of_peer, peer, i) for i in range(len(peer.levels))]
            series[PEER] = dict(list(zip(peer.levels, drawn, strict=True))[first])
        except (UnavailableError, WorkerError) as reason:
            skipped[PEER] = str(reason).splitlines()[0]
    for who, reason in skipped.items():
        print(f"  {who}: skipped: {reason}", flush=True)
    try:
        points = measure(scene, series, truth.error, settings.repeats)
    finally:
        if peer is not None:
            peer.close()
    return {
        "points": {method: as_rows(found) for method, found in points.items()}, "skipped": skipped,
        "cached": _part_cached(scene, shared), "reference": truth.described(), "size": size,
    }  # fmt: skip


def _picture(options: Method, samples: int, shared: dict[str, Any], scene: Scene) -> Image:
    return eclat.render(scene, options, samples=samples, seed=SEED, check=False, **shared)


def _denoised(samples: int, shared: dict[str, Any], scene: Scene) -> Image:
    image = _picture(eclat.Path(), samples, shared, scene)
    pixels = denoise(image.pixels, np.clip(image.layers["albedo"], 0, 1), np.clip(image.layers["normal"], -1, 1))
    return Image(pixels, {}, image.metadata)


def _of_peer(peer: Worker, level: int, scene: Scene) -> Image:
    """Its scene is built already."""
    return Image(peer.render(level).pixels, {}, {"statistics": {"rays": 0}})


def _part_cached(scene: Scene, shared: dict[str, Any]) -> float:
    """Of the pixels that see gloss, as far as some of their gloss is read from records."""
    layers = _picture(eclat.RadianceCache(), 1, shared, scene).layers
    cached, traced = (layers[name] for name in ("gloss_cached", "gloss_traced"))
    glossy = float(np.maximum(cached, traced).mean())
    return float(cached.mean()) / glossy if glossy > 0 else 0.0


def tables(result: dict[str, Any]) -> str:
    times, levels, missing = [], [], []
    for name, scene in result["scenes"].items():
        points = {method: from_rows(rows) for method, rows in scene["points"].items()}
        for method, found in points.items():
            part = f"{100 * scene['cached']:.0f} %" if method == CACHED else ""
            times.append([name, method, *(_time(method, found, wanted) for wanted in WANTED), part])
            levels += [_level(name, method, point) for point in found]
        missing += [f"*{name}: {who} left out: {reason}*" for who, reason in scene["skipped"].items()]
    heads = [f"time to {100 * wanted:g} %" for wanted in WANTED]
    parts = [
        document.table(["scene", "method", *heads, "gloss cached"], times),
        document.table(["scene", "method", "level", "time", "error", "away from edges"], levels),
        "\n".join(f"![{name}: error against time](benchmarks/glossy-{name}.svg)" for name in result["scenes"]),
        *missing,
    ]
    return "\n\n".join(parts)


def _time(method: str, points: list[Point], wanted: float) -> str:
    cost = cost_at(points, wanted, slope=-2 if method == PATH else None)
    if cost is None:
        return "not reached"
    return ("≈ " if cost.extrapolated else "") + document.seconds(cost.value)


def _level(scene: str, method: str, p: Point) -> list[str]:
    away = "" if p.error_away is None else document.percent(p.error_away)
    return [scene, method, p.label, document.seconds(p.seconds), document.percent(p.error), away]


def plots(result: dict[str, Any]) -> dict[str, str]:
    return error_plots("glossy", result)


BENCHMARK = Benchmark(
    "glossy", __doc__, ("glossy-box", "glossy-box-0.4", "glossy-box-0.6", "sponza-polished", "sibenik-polished"), run,
    tables, plots, reference_samples=1024,
)  # fmt: skip

if __name__ == "__main__":
    main(BENCHMARK)
