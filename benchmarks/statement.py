# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Is the error that a finished picture states of itself true?

Twenty scenes are rendered as `eclat.render(scene, max_error=…)` does it, denoised where a denoiser is installed, with
two values of max_error and several seeds (--repeats). The true error is measured against references, free of their
noise. Counted are the pictures whose true error is above the upper end of what is stated, those that state more than
max_error, and those of them without one of the reasons that the command line gives.

Each run is stored at once, in benchmarks/results/statement-runs, and not made again: the command may be stopped at any time
and goes on from there. Delete the folder when the renderer has changed. Scenes of files are found through ECLAT_SCENES.
Pictures are small (--size); all runs of five seeds take some hours, one seed less than one.
"""

from __future__ import annotations

import json
import time
import warnings
from pathlib import Path
from statistics import median
from typing import Any

import eclat
from eclat.cli.render import why_above
from eclat.measure.error_estimate import error_text
from harness import document
from harness.benchmark import RESULTS, Benchmark, Settings, main
from harness.references import given, reference
from harness.scenes import BenchmarkScene
from harness.variants import ROOMS

MAX_ERRORS = (0.05, 0.03)
SIDE, QUICK_SIDE = 128, 32
"""Pixels of the longer side."""

FIRST_SEED = 100
RUNS = RESULTS / "statement-runs"
KEPT = ("samples", "records", "cache_error", "noise_left", "error_in_one_tile", "light_by_chance")
"""What a run keeps of the statistics, besides the statement."""


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene = place.load()
    size = place.size_for(False, QUICK_SIDE if settings.quick else settings.side or SIDE)
    # c as the statement has it: in units of the picture's own brightness.
    found = place.given_reference(name, size)
    truth = (
        reference(name, scene, size, None, settings.reference_samples) if found is None else given(*found, scene, None)
    )
    path = (RUNS / "quick" if settings.quick else RUNS) / f"{name}-{size[0]}x{size[1]}.json"
    rows: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else []
    made = {(row["max_error"], row["seed"]) for row in rows}
    for seed in range(FIRST_SEED, FIRST_SEED + settings.repeats):
        for max_error in MAX_ERRORS:
            if (max_error, seed) in made:
                continue
            before = time.process_time()
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # The reasons of a stop are judged below.
                image = eclat.render(scene, max_error=max_error, seed=seed, size=size, threads=settings.threads)
            row = {"max_error": max_error, "seed": seed, "processor": time.process_time() - before}
            rows.append(row | judged(image.metadata["statistics"], truth.error(image)[0], max_error))
            _store(path, rows)
            print(f"  {max_error:g}, seed {seed}: true {rows[-1]['error']:.4f}, {rows[-1]['text']}", flush=True)
    return {"runs": rows, "reference": truth.described(), "size": size}


def judged(statistics: dict[str, float], error: float, max_error: float) -> dict[str, Any]:
    """What a run keeps: the true error, what was stated, and the reason that the command line would give."""
    flags = {"samples": None, "time": None, "max_error": max_error}
    return {
        "error": error,
        "stated": statistics["estimated_error"],
        "low": statistics["estimated_error_low"],
        "high": statistics["estimated_error_high"],
        "text": error_text(statistics),
        "reason": why_above(flags, statistics),
    } | {name: statistics[name] for name in KEPT if name in statistics}


def _store(path: Path, rows: list[dict[str, Any]]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    part.replace(path)


def tables(result: dict[str, Any]) -> str:
    rows = [
        _row(name, f"{100 * e:g} %", chosen)
        for name, scene in result["scenes"].items()
        for e in MAX_ERRORS
        if (chosen := [r for r in scene["runs"] if r["max_error"] == e])
    ]
    rows.append(_row("all", "", [r for scene in result["scenes"].values() for r in scene["runs"]]))
    header = [
        "scene", "max_error", "runs", "true error", "stated", "true ÷ stated, worst", "true above what is stated",
        "true above the interval", "stated above max_error", "of these without a reason", "processor time",
    ]  # fmt: skip
    return document.table(header, rows)


def _row(name: str, label: str, runs: list[dict[str, Any]]) -> list[str]:
    above = [r for r in runs if r["stated"] > r["max_error"]]
    return [
        name, label, str(len(runs)),
        document.percent(median(r["error"] for r in runs)), document.percent(median(r["stated"] for r in runs)),
        f"{max(r['error'] / max(r['stated'], 1e-9) for r in runs):.2f}",
        str(sum(r["error"] > r["stated"] for r in runs)), str(sum(r["error"] > r["high"] for r in runs)),
        str(len(above)), str(sum(not r["reason"] and not r.get("light_by_chance") for r in above)),
        document.seconds(median(r["processor"] for r in runs)),
    ]  # fmt: skip


BENCHMARK = Benchmark(
    "statement", __doc__, tuple(ROOMS), run, tables, reference_samples=1024, side=SIDE, known=ROOMS,
)  # fmt: skip

if __name__ == "__main__":
    main(BENCHMARK)
