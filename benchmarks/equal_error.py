# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Irradiance caching against path tracing: error against time, and the times at which their errors are equal.

Each picture's error is its relative RMSE over all pixels (eclat.measure.metrics), measured against two independent path-traced
references whose noise cancels. The cache runs with max_error 0.08 to 0.005, the pixels with the more samples the less
error is allowed; the path tracer with 1 to 256 samples. Time counts from arrays in memory to the float picture: tree,
solve and render. Where the path tracer never reached an error, its time is extrapolated by error ∝ 1/√time (marked ≈).
Also draws docs/benchmarks/error-SCENE.svg. Takes about an hour the first time, most of it for the references.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import eclat
from eclat.images.image import Image
from eclat.scene import Scene
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.curves import Point, as_rows, cost_at, error_plots, from_rows, measure
from harness.references import reference
from harness.scenes import BenchmarkScene

CACHE_LEVELS = {0.08: 4, 0.04: 8, 0.02: 16, 0.01: 32, 0.005: 64}
"""max_error → samples a pixel."""

PATH_SAMPLES = (1, 4, 16, 64, 256)
SEED = 1


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene, size = place.load(), place.size_for(settings.quick)
    truth = reference(name, scene, size, place.c, settings.reference_samples)
    shared: dict[str, Any] = {"size": size, "threads": settings.threads}
    cache_levels = list(CACHE_LEVELS.items())[: 3 if settings.quick else None]
    path_samples = PATH_SAMPLES[: 3 if settings.quick else None]
    series = {
        "irradiance-cache": {
            f"max_error {e:g}, {n} samples": partial(_picture, eclat.IrradianceCache(max_error=e), n, shared)
            for e, n in cache_levels
        },
        "path": {f"{n} samples": partial(_picture, eclat.Path(), n, shared) for n in path_samples},
    }
    points = measure(scene, series, truth.error, settings.repeats)
    return {
        "points": {method: as_rows(found) for method, found in points.items()},
        "reference": truth.described(), "size": size,
    }  # fmt: skip


def _picture(options: eclat.IrradianceCache | eclat.Path, samples: int, shared: dict[str, Any], scene: Scene) -> Image:
    return eclat.render(scene, options, samples=samples, seed=SEED, **shared)


def tables(result: dict[str, Any]) -> str:
    rows = []
    for name, scene in result["scenes"].items():
        path = from_rows(scene["points"]["path"])
        rows += [_row(name, "path", p, "", "") for p in path]
        for p in from_rows(scene["points"]["irradiance-cache"]):
            traced = cost_at(path, p.error, slope=-2)
            if traced is None or p.error == 0:
                rows.append(_row(name, "irradiance-cache", p, "", ""))
                continue
            mark = "≈ " if traced.extrapolated else ""
            time, factor = document.seconds(traced.value), document.ratio(traced.value / p.seconds)
            rows.append(_row(name, "irradiance-cache", p, mark + time, mark + factor))
    header = ["scene", "method", "level", "time", "error", "away from edges", "path at that error", "path : cache"]
    pictures = "\n".join(f"![{name}: error against time](benchmarks/error-{name}.svg)" for name in result["scenes"])
    return f"{document.table(header, rows)}\n\n{pictures}"


def _row(scene: str, method: str, p: Point, traced: str, factor: str) -> list[str]:
    away = "" if p.error_away is None else document.percent(p.error_away)
    return [scene, method, p.label, document.seconds(p.seconds), document.percent(p.error), away, traced, factor]


def plots(result: dict[str, Any]) -> dict[str, str]:
    return error_plots("error", result)


BENCHMARK = Benchmark(
    "equal-error", __doc__, ("cornell-box", "door-ajar", "sponza", "sibenik", "atrium"), run, tables, plots,
    reference_samples=1024,
)  # fmt: skip

if __name__ == "__main__":
    main(BENCHMARK)
