# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The far end of gather rays: paths traced on against a coarse cache or photons at what the rays meet, at equal error.

The same scene is solved at several max_error with far_records = 0 (every path traced to its end), with the default, with
four times as many, and with photons (not where there is an image of the environment). Time is `solve`, tree included; the
error is that of the records alone, without the noise of pixels. "traced on" is what tracing on costs at the same error.
Takes about half an hour, the first time longer.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import eclat
from eclat.methods.records.laws import core_options
from eclat.scene import Scene
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.curves import as_rows, cost_at, from_rows, measure
from harness.references import reference
from harness.scenes import BenchmarkScene

MAX_ERRORS = (0.08, 0.04, 0.02, 0.01, 0.005)
SAMPLES = 64
"""A pixel, of the two pictures that tell the error of the records alone."""

SEED = 1
FAR_ENDS = {
    "traced on": (0, 0),
    "far cache, default": (1, 0),
    "far cache, 4 × default": (4, 0),
    "50 000 photons": (0, 50_000),
    "200 000 photons": (0, 200_000),
}
"""Name → candidates for far records, in units of what max_error asks for, and photons."""


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene, size = place.load(), place.size_for(settings.quick)
    truth = reference(name, scene, size, place.c, settings.reference_samples)
    shared: dict[str, Any] = {"size": size, "threads": settings.threads}
    wanted = MAX_ERRORS[: 3 if settings.quick else None]

    def judge(solution: eclat.Solution) -> tuple[float, float | None]:
        return truth.cache_error(
            *(eclat.render(scene, solution, samples=SAMPLES, seed=s, **shared) for s in (SEED, SEED + 1))
        ), None

    series = {
        far_end: {f"{e:g}": partial(_solve, _options(e, far, photons), shared) for e in wanted}
        for far_end, (far, photons) in list(FAR_ENDS.items())[: 2 if settings.quick else None]
        if not photons or scene.environment is None
    }
    points = measure(scene, series, judge, settings.repeats)
    rows = {far_end: as_rows(found) for far_end, found in points.items()}
    return {"points": rows, "reference": truth.described(), "size": size}


def _options(max_error: float, far: int, photons: int) -> eclat.IrradianceCache:
    options = eclat.IrradianceCache(max_error=max_error, far_photons=photons)
    return replace(options, far_records=far * core_options(options).far_records)


def _solve(options: eclat.IrradianceCache, shared: dict[str, Any], scene: Scene) -> eclat.Solution:
    return eclat.solve(scene, options, seed=SEED, **shared)


def tables(result: dict[str, Any]) -> str:
    rows = []
    for name, scene in result["scenes"].items():
        traced_on = from_rows(scene["points"]["traced on"])
        for far_end, found in scene["points"].items():
            for p in from_rows(found):
                cost = cost_at(traced_on, p.error)
                factor = "" if cost is None else document.ratio(cost.value / p.seconds)
                rows.append([name, far_end, p.label, f"{p.records:,}", f"{p.rays / 1e6:.1f} M",
                             document.seconds(p.seconds), document.percent(p.error), factor])  # fmt: skip
    header = ["scene", "far end", "max_error", "records", "rays", "solve", "cache alone", "traced on : this"]
    return document.table(header, rows)


BENCHMARK = Benchmark("far-end", __doc__, ("cornell-box", "sponza", "sibenik"), run, tables, reference_samples=1024)

if __name__ == "__main__":
    main(BENCHMARK)
