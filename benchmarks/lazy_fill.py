# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The lecture's lazy fill against the passes: records and time at equal error, on one thread.

On demand, pixel by pixel in scanline order, a record is made wherever none serves the pixel; the passes go from coarse
to fine, each against a frozen cache. Both place by the same test, gather by the same code, trace all paths to their end
(no far cache) and are read whole afterwards, which favours the lazy fill: read while it grows, as in the lecture, its
first records would be extrapolated farther than the last ones. The error is that of the records alone, without the
noise of pixels. "on demand" is what the lazy fill needs at the same error. Takes about half an hour.
"""

from __future__ import annotations

import time
from functools import partial
from typing import Any

import eclat
from eclat.scene import Scene
from harness import document, probed_core
from harness.benchmark import Benchmark, Settings, main
from harness.curves import as_rows, cost_at, from_rows, measure
from harness.references import reference
from harness.scenes import BenchmarkScene

MAX_ERRORS = (0.16, 0.08, 0.04, 0.02, 0.01)
SAMPLES = 64
"""A pixel, of the two pictures that tell the error of the records alone."""

SEED = 1


def prepare() -> list[str]:
    probed_core.install()
    return []


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene, size = place.load(), place.size_for(settings.quick)
    truth = reference(name, scene, size, place.c, settings.reference_samples)
    wanted = [eclat.IrradianceCache(max_error=e, far_records=0) for e in MAX_ERRORS[: 3 if settings.quick else None]]

    def judge(solution: eclat.Solution) -> tuple[float, float | None]:
        seeds = (SEED, SEED + 1)
        pair = (eclat.render(scene, solution, samples=SAMPLES, size=size, seed=s) for s in seeds)
        return truth.cache_error(*pair), None

    series = {
        "on demand": {f"{o.max_error:g}": partial(_fill_lazily, o, size) for o in wanted},
        "passes": {f"{o.max_error:g}": partial(_fill_in_passes, o, size) for o in wanted},
    }
    points = measure(scene, series, judge, settings.repeats)
    rows = {order: as_rows(found) for order, found in points.items()}
    return {"points": rows, "reference": truth.described(), "size": size}


def _fill_in_passes(options: eclat.IrradianceCache, size: tuple[int, int], scene: Scene) -> eclat.Solution:
    return eclat.solve(scene, options, size=size, seed=SEED, threads=1)


def _fill_lazily(options: eclat.IrradianceCache, size: tuple[int, int], scene: Scene) -> eclat.Solution:
    core = probed_core.install()
    from eclat.bridge.compiled import compiled
    from eclat.methods.records.laws import core_options
    from eclat.methods.records.solution import solved_from_core

    before = time.perf_counter()
    prepared, progress = compiled(scene), core.Progress()
    camera = prepared.camera(scene.cameras[0], size)
    caches = core.fill_lazily(prepared.core, camera, core_options(options, seed=SEED, threads=1), progress)
    statistics = {
        "records": float(caches.near_count),
        "far_records": 0.0,
        "rays": float(progress.rays),
        "seconds": time.perf_counter() - before,
    }
    return solved_from_core(scene, options, caches, statistics, max_depth=-1, complete=True)


def tables(result: dict[str, Any]) -> str:
    rows = []
    for name, scene in result["scenes"].items():
        lazy = from_rows(scene["points"]["on demand"])
        for order, found in scene["points"].items():
            for p in from_rows(found):
                costs = [cost_at(lazy, p.error, key) for key in ("records", "seconds")]
                own = (p.records, p.seconds)
                factors = [
                    "" if cost is None or order == "on demand" else document.ratio(cost.value / mine)
                    for cost, mine in zip(costs, own, strict=True)
                ]
                rows.append([name, order, p.label, f"{p.records:,}", document.seconds(p.seconds),
                             document.percent(p.error), *factors])  # fmt: skip
    header = ["scene", "fill", "max_error", "records", "time", "cache alone", "records, on demand : passes",
              "time, on demand : passes"]  # fmt: skip
    return document.table(header, rows)


BENCHMARK = Benchmark(
    "lazy-fill", __doc__, ("cornell-box", "sponza", "sibenik"), run, tables, prepare=prepare, reference_samples=1024
)

if __name__ == "__main__":
    main(BENCHMARK)
