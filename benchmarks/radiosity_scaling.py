# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What radiosity costs against the number of patches: links, rays and time of a solve, from 8000 to 512,000 patches.

Everything but `patches` is left at its default. The peak of memory is that of the process, which the largest solve comes
last in. Also draws docs/benchmarks/radiosity-scaling.svg. Takes about twenty
minutes, with --repeats 1 six.
"""

from __future__ import annotations

import resource
import warnings
from functools import partial
from typing import Any

import eclat
from eclat.report.svg_plot import log_log_plot
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.scenes import BenchmarkScene
from harness.timing import in_turn

PATCHES = (8_000, 32_000, 128_000, 512_000)
ROUNDS = 3
"""Of each size, at most: the largest takes a minute."""


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene = place.load()
    rows = []
    for wanted in PATCHES[: 2 if settings.quick else None]:
        solve = partial(eclat.solve, scene, eclat.Radiosity(patches=wanted), threads=settings.threads)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of gloss, which does not matter here
            timed = in_turn({"solve": solve}, min(ROUNDS, settings.repeats), warm_up=False, budget=120)["solve"]
        statistics = timed.value.statistics
        rows.append({
            "patches": len(timed.value), "links": statistics["links"], "rays": statistics["rays"],
            "sweeps": statistics["sweeps"], "seconds": timed.seconds,
            "peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
        })  # fmt: skip
    return {"rows": rows}


def tables(result: dict[str, Any]) -> str:
    rows = []
    for name, scene in result["scenes"].items():
        for row in scene["rows"]:
            patches = row["patches"]
            rows.append([
                name, f"{patches:,}", f"{row['links'] / patches:.1f}", f"{row['rays'] / patches:.0f}",
                document.seconds(row["seconds"]), f"{1e6 * row['seconds'] / patches:.0f} µs", f"{row['peak'] / 1e6:,.0f} MB",
            ])  # fmt: skip
    header = ["scene", "patches", "links a patch", "rays a patch", "solve", "a patch", "peak of memory"]
    plot = "![Time, links and rays of a solve against patches](benchmarks/radiosity-scaling.svg)"
    return f"{document.table(header, rows)}\n\n{plot}"


def plots(result: dict[str, Any]) -> dict[str, str]:
    series = {}
    for name, scene in result["scenes"].items():
        rows = scene["rows"]
        series[f"{name}: seconds"] = [(row["patches"], row["seconds"]) for row in rows]
        series[f"{name}: 10⁵ links"] = [(row["patches"], row["links"] / 1e5) for row in rows]
        series[f"{name}: 10⁶ rays"] = [(row["patches"], row["rays"] / 1e6) for row in rows]
    return {"radiosity-scaling": log_log_plot(series, "patches", "seconds, links, rays", lambda value: f"{value:g}")}


BENCHMARK = Benchmark("radiosity-scaling", __doc__, ("cornell-box", "atrium"), run, tables, plots)

if __name__ == "__main__":
    main(BENCHMARK)
