# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""One thread against all of them, beside bare Embree's own scaling in the same run.

What bare Embree traces are the rays of one path-traced sample a pixel, recorded and replayed in packets of 8. All three
(solve, path, bare) run in turn on one thread and on all; the tree is built before. Takes about ten minutes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import eclat
from harness import document, probed_core
from harness.benchmark import Benchmark, Settings, main
from harness.scenes import BenchmarkScene
from harness.timing import in_turn
from harness.unavailable import UnavailableError

PATH_SAMPLES = 4


def prepare() -> list[str]:
    probed_core.install()
    return []


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    if settings.threads < 2:
        raise UnavailableError("there is nothing to scale to with one thread")
    core = probed_core.install()
    scene, size = place.load(), place.size_for(settings.quick)
    core.start_recording()
    eclat.render(scene, eclat.Path(), samples=1, size=size)
    recorded = core.stop_recording()

    runs: dict[str, Callable[[], Any]] = {}
    for n in (1, settings.threads):
        runs[f"solve {n}"] = lambda n=n: eclat.solve(scene, size=size, threads=n)  # type: ignore[misc]
        runs[f"path {n}"] = lambda n=n: eclat.render(scene, eclat.Path(), samples=PATH_SAMPLES, size=size, threads=n)  # type: ignore[misc]
        runs[f"bare Embree {n}"] = lambda n=n: recorded.replay(8, False, n)  # type: ignore[misc]
    seconds = {label: timed.seconds for label, timed in in_turn(runs, settings.repeats).items()}
    rows = [
        {"work": work, "one": seconds[f"{work} 1"], "all": seconds[f"{work} {settings.threads}"]}
        for work in ("solve", "path", "bare Embree")
    ]
    return {"rows": rows, "threads": settings.threads, "size": size}


def tables(result: dict[str, Any]) -> str:
    threads = next(iter(result["scenes"].values()))["threads"]
    rows = []
    for name, scene in result["scenes"].items():
        scaling = {row["work"]: row["one"] / row["all"] for row in scene["rows"]}
        for row in scene["rows"]:
            of_bare = scaling[row["work"]] / scaling["bare Embree"]
            rows.append([name, row["work"], document.seconds(row["one"]), document.seconds(row["all"]),
                         document.ratio(scaling[row["work"]]), f"{of_bare:.2f}"])  # fmt: skip
    header = ["scene", "work", "1 thread", f"{threads} threads", "scaling", "of bare Embree's"]
    return document.table(header, rows)


BENCHMARK = Benchmark("scaling", __doc__, ("cornell-box", "sponza", "sibenik"), run, tables, prepare=prepare)

if __name__ == "__main__":
    main(BENCHMARK)
