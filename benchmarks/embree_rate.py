# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Rays a second, path tracing's and the gather's, against bare Embree on the very same rays.

A probe between the core and Embree records the rays (closest-hit and occlusion) that a piece of work sends. They are
then traced once more with nothing done to the answers, one by one and in packets of 8 and 16, in turn with the work
itself. The same probe measures which part of the work's time passes inside Embree.

  path     one sample a pixel of a path-traced picture
  gather   records at every 16th pixel in both directions, gather rays ending in the far cache as `solve` does it
  solve    all of it: candidates, far and near records, the tree of records (time inside Embree only)

Takes about ten minutes, after the probed core is built.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import eclat
from harness import document, probed_core
from harness.benchmark import Benchmark, Settings, main
from harness.scenes import BenchmarkScene
from harness.timing import in_turn

STRIDE = 16
WIDTHS = (1, 8, 16)
RECORDED_SAMPLES = 1


def prepare() -> list[str]:
    probed_core.install()
    return []


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    core = probed_core.install()
    from eclat.bridge.compiled import compiled
    from eclat.methods.records.laws import core_options

    scene = place.load()
    size = place.size_for(settings.quick)
    options = eclat.IrradianceCache()
    solution = eclat.solve(scene, options, size=size, threads=settings.threads)
    prepared, caches = compiled(scene), solution.core()
    inner = core_options(options, threads=settings.threads)
    stride = 4 if settings.quick else STRIDE
    points = core.gather_points(prepared.core, prepared.camera(scene.cameras[0], size), inner, stride, core.Progress())

    def path() -> None:
        eclat.render(scene, eclat.Path(), samples=RECORDED_SAMPLES, size=size, threads=settings.threads)

    def gather() -> None:
        core.gather(prepared.core, points, caches, inner, core.Progress())

    def solve() -> None:
        eclat.solve(scene, options, size=size, threads=settings.threads)

    rows = [
        _against_bare(core, "path", path, settings),
        _against_bare(core, "gather", gather, settings),
        {"work": "solve", "inside": _share_inside(core, solve, settings.threads)},
    ]
    return {"rows": rows, "gathers": len(points), "rows_of_a_gather": inner.rows, "size": size}


def _against_bare(core: Any, label: str, work: Callable[[], None], settings: Settings) -> dict[str, Any]:
    core.start_recording()
    work()
    recorded = core.stop_recording()
    rays = recorded.nearest + recorded.shadow
    runs: dict[str, Callable[[], Any]] = {"ours": work}
    for width in WIDTHS:
        runs[f"bare {width}"] = lambda width=width: recorded.replay(width, False, settings.threads)  # type: ignore[misc]
    timed = in_turn(runs, settings.repeats)
    return {
        "work": label, "rays": rays, "shadow_rays": recorded.shadow,
        "rate": {run: rays / result.seconds for run, result in timed.items()},
        "inside": _share_inside(core, work, settings.threads),
    }  # fmt: skip


def _share_inside(core: Any, work: Callable[[], None], threads: int) -> float:
    core.start_timing()
    before = time.perf_counter()
    work()
    elapsed = time.perf_counter() - before
    seconds, _ = core.stop_timing()
    return float(seconds) / (elapsed * threads)


def tables(result: dict[str, Any]) -> str:
    rows = []
    for name, scene in result["scenes"].items():
        for row in scene["rows"]:
            inside = f"{100 * row['inside']:.0f} %"
            if "rate" not in row:
                rows.append([name, row["work"], "", "", "", "", "", inside])
                continue
            rate = row["rate"]
            bare = [rate[f"bare {width}"] for width in WIDTHS]
            rows.append(
                [name, row["work"], *(f"{r / 1e6:.1f} M/s" for r in (rate["ours"], *bare)),
                 f"{rate['ours'] / max(bare):.2f}", inside]
            )  # fmt: skip
    header = ["scene", "work", "ours", "bare, single", "bare, by 8", "bare, by 16", "ours : best bare",
              "time inside Embree"]  # fmt: skip
    return document.table(header, rows)


BENCHMARK = Benchmark("embree-rate", __doc__, ("cornell-box", "sponza", "sibenik"), run, tables, prepare=prepare)

if __name__ == "__main__":
    main(BENCHMARK)
