# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Is the error that a solve tells of itself true?

Each scene is solved with many seeds and two wanted errors in a small picture. The true error of the records is measured
over all pixels against two long path-traced references, free of the noise of pixels and references. Counted are the
solves whose true error is at most 1.5 times the estimate, and of those that claim success (the interval's upper end is
below max_error) the ones whose true error is at most max_error. Takes about half an hour, mostly for the references.
"""

from __future__ import annotations

from statistics import median
from typing import Any

import eclat
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.references import reference
from harness.scenes import BenchmarkScene

MAX_ERRORS = (0.08, 0.02)
SEEDS = 8
SIDE, QUICK_SIDE = 96, 24
"""Pixels of the longer side."""

SAMPLES = 128
"""A pixel, of the two pictures that tell the true error of the records."""

ALLOWED = 1.5
"""Times the estimate that the true error may be."""


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene, size = place.load(), place.size_for(False, QUICK_SIDE if settings.quick else SIDE)
    # c as the estimate has it: in units of the picture's own brightness.
    truth = reference(name, scene, size, None, settings.reference_samples)
    shared: dict[str, Any] = {"size": size, "threads": settings.threads}
    solves = []
    for max_error in MAX_ERRORS:
        for seed in range(2 if settings.quick else SEEDS):
            solution = eclat.solve(scene, eclat.IrradianceCache(max_error=max_error), seed=seed, **shared)
            estimate = solution.estimate
            assert estimate is not None
            samples = 8 if settings.quick else SAMPLES
            pair = [eclat.render(scene, solution, samples=samples, seed=1000 + 2 * seed + k, **shared) for k in (0, 1)]
            solves.append({
                "max_error": max_error, "seed": seed, "error": truth.cache_error(*pair), "estimate": estimate.quoted,
                "low": estimate.low, "high": estimate.high, "rays": solution.statistics["rays"],
                "check_rays": solution.statistics["check_rays"],
            })  # fmt: skip
            print(f"  {max_error:g}, seed {seed}: {solves[-1]['error']:.4f} told as {estimate}", flush=True)
    return {"solves": solves, "reference": truth.described(), "size": size}


def tables(result: dict[str, Any]) -> str:
    rows = [
        _row(name, f"{e:g}", [s for s in scene["solves"] if s["max_error"] == e])
        for name, scene in result["scenes"].items()
        for e in MAX_ERRORS
    ]
    rows.append(_row("all", "", [s for scene in result["scenes"].values() for s in scene["solves"]]))
    header = ["scene", "max_error", "solves", "true error", "estimate", f"true ≤ {ALLOWED} × estimate", "in the interval",
              "claimed", "true ≤ max_error where claimed", "rays of the check"]  # fmt: skip
    return document.table(header, rows)


def _row(name: str, label: str, solves: list[dict[str, float]]) -> list[str]:
    claimed = [s for s in solves if s["high"] <= s["max_error"]]
    share = sum(s["check_rays"] for s in solves) / sum(s["rays"] - s["check_rays"] for s in solves)
    return [
        name, label, str(len(solves)), document.percent(median(s["error"] for s in solves)),
        document.percent(median(s["estimate"] for s in solves)),
        _part(sum(s["error"] <= ALLOWED * s["estimate"] for s in solves), len(solves)),
        _part(sum(s["low"] <= s["error"] <= s["high"] for s in solves), len(solves)),
        str(len(claimed)), _part(sum(s["error"] <= s["max_error"] for s in claimed), len(claimed)), f"{100 * share:.0f} %",
    ]  # fmt: skip


def _part(count: int, of: int) -> str:
    return f"{100 * count / of:.0f} %" if of else ""


BENCHMARK = Benchmark(
    "calibration", __doc__,
    ("cornell-box", "glossy-box", "door-ajar", "atrium", "two-rooms", "furnace", "sponza", "sibenik"),
    run, tables, reference_samples=4096,
)  # fmt: skip

if __name__ == "__main__":
    main(BENCHMARK)
