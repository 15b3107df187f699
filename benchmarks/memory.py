# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Memory: the most that a solve holds, and bytes per record with a million of them.

Each scene is loaded and solved in a process of its own; the peak is what the system counted for it. For bytes per
record, copies of the scene's own records, set side by side until they are a million, become a cache: what the process
then holds more, index included, is divided by their number. Takes about five minutes.
"""

from __future__ import annotations

import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np

import eclat
from harness import document, machine
from harness.benchmark import Benchmark, Settings, main
from harness.scenes import SCENES, BenchmarkScene
from harness.unavailable import UnavailableError

MANY = 1_000_000


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    if machine.memory("VmHWM") is None:
        raise UnavailableError("this system does not say how much memory a process holds (/proc/self/status)")
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        return pool.submit(_measure, name, settings).result()


def _measure(name: str, settings: Settings) -> dict[str, Any]:
    from eclat.bridge.compiled import compiled

    place = SCENES[name]
    scene, size = place.load(), place.size_for(settings.quick)
    triangles = compiled(scene).core.triangle_count
    loaded = machine.memory("VmRSS")
    solution = eclat.solve(scene, size=size, threads=settings.threads)
    return {
        "triangles": triangles, "loaded": loaded, "peak": machine.memory("VmHWM"), "records": len(solution),
        "bytes_per_record": _bytes_per_record(solution, 50_000 if settings.quick else MANY), "size": size,
    }  # fmt: skip


def _bytes_per_record(solution: eclat.Solution, count: int) -> float:
    copies = -(-count // len(solution))
    many = np.tile(solution.near, (copies, 1))
    positions = many[:, :3]
    extent = np.ptp(solution.near[:, 0]) + 4 * solution.radii.max()
    positions[:, 0] += np.repeat(np.arange(copies, dtype=np.float32) * extent, len(solution))
    # The radii are clamped to their neighbours already.
    grown = replace(solution, near=many, options=replace(solution.options, neighbor_clamping=False))
    before = machine.memory("VmRSS")
    cache = grown.core()
    after = machine.memory("VmRSS")
    assert before is not None and after is not None
    return float((after - before) / cache.near_count)


def tables(result: dict[str, Any]) -> str:
    rows = [
        [name, f"{s['triangles']:,}", f"{s['loaded'] / 1e6:.0f} MB", f"{s['peak'] / 1e6:.0f} MB", f"{s['records']:,}",
         f"{s['bytes_per_record']:.0f}"]
        for name, s in result["scenes"].items()
    ]  # fmt: skip
    header = ["scene", "triangles", "loaded", "peak of load and solve", "records", "bytes per record"]
    return document.table(header, rows)


BENCHMARK = Benchmark("memory", __doc__, tuple(SCENES), run, tables)

if __name__ == "__main__":
    main(BENCHMARK)
