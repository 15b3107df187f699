# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Does the cache converge to the reference? Its true error, step by step of `refine`, against the time of all steps.

A coarse solve is refined to half its error again and again, in a small picture. The error is that of the records over all
pixels, free of the noise of pixels and of the references. Takes about ten minutes, and once as long for the references.
"""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter
from typing import Any

import eclat
from eclat.report.svg_plot import log_log_plot
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.references import reference
from harness.scenes import BenchmarkScene

START = eclat.IrradianceCache(max_error=0.08)
STEPS, QUICK_STEPS = 4, 2
SIDE, QUICK_SIDE = 64, 16
"""Pixels of the longer side."""

SAMPLES, QUICK_SAMPLES = 1024, 8
"""A pixel, of the two pictures that tell the true error of the records."""

SEED = 1


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene, size = place.load(), place.size_for(False, QUICK_SIDE if settings.quick else SIDE)
    truth = reference(name, scene, size, place.c, settings.reference_samples)
    shared: dict[str, Any] = {"size": size, "threads": settings.threads}
    steps: list[dict[str, float]] = []
    seconds = rays = 0.0
    fresh = replace(scene)  # the core has not seen it: the first step's time includes the tree
    solution: eclat.Solution | None = None
    for _ in range(1 + (QUICK_STEPS if settings.quick else STEPS)):
        started = perf_counter()
        if solution is None:
            solution = eclat.solve(fresh, START, seed=SEED, **shared)
        else:
            solution = eclat.refine(solution, fresh, seed=SEED, **shared)
        seconds += perf_counter() - started
        rays += solution.statistics["rays"]
        samples = QUICK_SAMPLES if settings.quick else SAMPLES
        pair = [eclat.render(fresh, solution, samples=samples, seed=s, **shared) for s in (2, 3)]
        steps.append({
            "seconds": seconds, "rays": rays, "records": len(solution), "error": truth.cache_error(*pair),
            "estimate": solution.statistics["estimated_error"],
        })  # fmt: skip
        print(f"  {len(steps)}: {seconds:.1f} s, {steps[-1]}", flush=True)
    return {"steps": steps, "reference": truth.described(), "size": size}


def tables(result: dict[str, Any]) -> str:
    rows = [
        [name, str(i), f"{int(s['records']):,}", f"{s['rays'] / 1e6:.0f} M", document.seconds(s["seconds"]),
         document.percent(s["error"]), document.percent(s["estimate"])]
        for name, scene in result["scenes"].items()
        for i, s in enumerate(scene["steps"])
    ]  # fmt: skip
    header = ["scene", "refined", "records", "rays of all steps", "time of all steps", "true error", "estimate"]
    pictures = "\n".join(
        f"![{name}: error against time](benchmarks/convergence-{name}.svg)" for name in result["scenes"]
    )
    return f"{document.table(header, rows)}\n\n{pictures}"


def plots(result: dict[str, Any]) -> dict[str, str]:
    return {
        f"convergence-{name}": log_log_plot(
            {"refine": [(s["seconds"], s["error"]) for s in scene["steps"]]},
            "seconds",
            f"{name}: error",
            lambda error: f"{100 * error:g} %",
        )
        for name, scene in result["scenes"].items()
    }


BENCHMARK = Benchmark("convergence", __doc__, ("cornell-box",), run, tables, plots, reference_samples=16384)

if __name__ == "__main__":
    main(BENCHMARK)
