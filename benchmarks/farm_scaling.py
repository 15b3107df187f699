# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How many workers pay? Counted rays and bytes of ranges, with the transfer times of a simulated network, up to 300 workers.

Nothing is timed, and the machine may be busy: the rays of every range and the bytes that travel are counted in one process.
The time of a farm is then simulated: a worker traces a million rays a second; every machine has a link of 1 Gbit/s, the one that
asks included; a message takes 1 ms, and the scheduler takes 1 ms for each range. Three works are simulated: records of a view of
1280 × 720, pass by pass; 64 samples of a picture of 3840 × 2160 in two halves, whose sums travel with each pass; and 120 frames
of 1920 × 1080. Also draws docs/benchmarks/farm-scaling.svg. Takes some minutes.
"""

from __future__ import annotations

import heapq
import math
import struct
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

import eclat
from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.farm.shared_work import FEWEST_RAYS, RANGES_OF_THREAD, Digests
from eclat.methods.records.laws import core_options
from eclat.report.svg_plot import log_log_plot
from eclat.verbs.tiles_on_farm import RANGES_OF_THREAD as TILE_RANGES_OF_THREAD
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.scenes import BenchmarkScene

RATE, BANDWIDTH, LATENCY, TASK = 1e6, 1.25e8, 1e-3, 1e-3
"""Rays a second of a worker; bytes a second of a link; seconds of a message; seconds of the scheduler for a range."""
WORKERS = (1, 3, 10, 30, 100, 300)
PICTURE, SAMPLES, FRAMES, FRAME_BYTES = (3840, 2160), 64, 120, 1920 * 1080 * 60
"""60 bytes a pixel: the layers of an .exr file of 32-bit floats, compressed by about a half."""
BLOCK = 16
"""The number of gathers whose rays are counted together."""
BYTES_OF_PIXEL = 96
"""The sums of a pixel of a film."""


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene = place.load()
    size = (320, 180) if settings.quick else (1280, 720)
    passes = counted_passes(scene, size, settings.threads)
    tiles = tile_rays(scene, settings)
    rows = []
    for workers in WORKERS:
        solve, alone = solve_seconds(passes, workers)
        picture, link = picture_seconds(tiles, workers)
        frames = frame_seconds(float(np.mean(tiles)), workers)
        rows.append({
            "workers": workers, "solve": solve, "alone": alone, "picture": picture, "link": link, "frames": frames,
        })  # fmt: skip
    return {"rows": rows, "passes": len(passes), "one_solve": one_solve(passes), "one_picture": one_picture(tiles)}


def counted_passes(scene: eclat.Scene, size: tuple[int, int], threads: int) -> list[dict[str, Any]]:
    """Solve records for the first camera, and count for each pass the rays before it, those of blocks of gathers, and bytes."""
    options = core_options(eclat.IrradianceCache(max_error=0.03), max_depth=-1, seed=0, threads=threads)
    found: list[dict[str, Any]] = []
    counted, travelled, known = _core.Progress(), Digests(), set()
    before = 0

    def share(count: int, rays_of_item: int, compute: Any) -> list[bytes]:
        nonlocal before
        own = counted.rays - before
        blocks = [compute(first, min(first + BLOCK, count)) for first in range(0, count, BLOCK)]
        rays = [struct.unpack_from("<Q", block)[0] for block in blocks]
        found.append({
            "own": own, "count": count, "parts": count * rays_of_item // FEWEST_RAYS, "rays": rays,
            "bytes": sum(map(len, blocks)),
        })  # fmt: skip
        before = counted.rays
        return blocks

    def tell(digest: bytes) -> None:
        # The digest travels with the ranges of the next step.
        travelled.add(digest)
        sent = {n: len(content) for n, content in travelled.parcels().items() if n not in known}
        known.update(sent)
        found[-1]["sent"] = sum(sent.values())

    options.share_work(share, tell)
    prepared = compiled(scene)
    camera = prepared.camera(scene.cameras[0], size)
    _core.solve_for_cameras(prepared.core, [camera], options, _core.SolvedCaches(), counted)
    return found


def tile_rays(scene: eclat.Scene, settings: Settings) -> list[float]:
    """Count the rays of a sample of a pixel in each tile of a small picture."""
    size = (256, 144)
    found = []
    for y in range(0, size[1], 32):
        for x in range(0, size[0], 32):
            crop = (x, y, min(x + 32, size[0]), min(y + 32, size[1]))
            image = eclat.render(scene, "path", size=size, crop=crop, samples=1 if settings.quick else 4, denoise=False)
            pixels = (crop[2] - crop[0]) * (crop[3] - crop[1])
            found.append(image.metadata["statistics"]["rays"] / pixels / image.metadata["statistics"]["samples"])
    return found


def one_solve(passes: Sequence[dict[str, Any]]) -> float:
    """The seconds of one process."""
    return sum(p["own"] + sum(p["rays"]) for p in passes) / RATE


def solve_seconds(passes: Sequence[dict[str, Any]], workers: int) -> tuple[float, float]:
    """The seconds of a solve, and those of them for rays that every worker traces itself."""
    seconds = alone = 0.0
    for p in passes:
        gathered, own = sum(p["rays"]), p["own"] / RATE
        parts = min(p["count"], p["parts"], RANGES_OF_THREAD * workers)
        alone += own
        if parts < 2:
            seconds += own + gathered / RATE
            alone += gathered / RATE
            continue
        sums = np.concatenate([[0.0], np.cumsum(p["rays"])])
        cuts = np.interp(np.linspace(0, len(p["rays"]), parts + 1), np.arange(len(sums)), sums)
        ranges = [(end - first) / RATE for first, end in pairwise(cuts)]
        spread = p["sent"] * math.ceil(math.log2(workers + 1)) / BANDWIDTH
        seconds += own + spread + finished(ranges, workers) + p["bytes"] / BANDWIDTH + 2 * LATENCY
    return seconds, alone


def one_picture(tiles: Sequence[float]) -> float:
    """The seconds of one process."""
    return PICTURE[0] * PICTURE[1] * SAMPLES * float(np.mean(tiles)) / RATE


def picture_seconds(tiles: Sequence[float], workers: int) -> tuple[float, float]:
    """The seconds of the samples of a picture, and those in which the link of the machine that asks is busy."""
    seconds = link = 0.0
    rows = math.ceil(PICTURE[1] / 32)
    columns = math.ceil(PICTURE[0] / 32)
    parts = min(columns, max(1, -(-TILE_RANGES_OF_THREAD * workers // 2 // rows)))
    pixels = PICTURE[0] * PICTURE[1] / rows / parts
    taken = 0
    for end in (2, 4, 8, 16, 32):  # samples of each half after each pass
        means = [tiles[i % len(tiles)] for i in range(2 * rows * parts)]
        ranges = [mean * pixels * (end - taken) / RATE for mean in means]
        travels = 2 * PICTURE[0] * PICTURE[1] * BYTES_OF_PIXEL * (2 if taken else 1) / BANDWIDTH
        link += travels
        # What travels does so while workers compute, so that the slower of both decides.
        seconds += max(finished(ranges, workers), travels) + 2 * LATENCY
        taken = end
    return seconds, link


def frame_seconds(rays: float, workers: int) -> float:
    """The seconds of frames of 64 samples, of which each is a range."""
    each = 1920 * 1080 * SAMPLES * rays / RATE
    return max(math.ceil(FRAMES / workers) * each, FRAMES * FRAME_BYTES / BANDWIDTH) + FRAME_BYTES / BANDWIDTH


def finished(ranges: Sequence[float], workers: int) -> float:
    """The time at which the last range is finished, if each goes to the worker that is free first."""
    free = [0.0] * workers
    for number, seconds in enumerate(ranges):
        begin = max(heapq.heappop(free), TASK * (number + 1))
        heapq.heappush(free, begin + seconds)
    return max(free)


def tables(result: dict[str, Any]) -> str:
    rows = []
    for name, scene in result["scenes"].items():
        frames = scene["rows"][0]["frames"]
        for row in scene["rows"]:
            rows.append([
                name, str(row["workers"]), f"{scene['one_solve'] / row['solve']:.1f}", f"{row['alone'] / row['solve']:.0%}",
                f"{scene['one_picture'] / row['picture']:.1f}", f"{row['link'] / row['picture']:.0%}",
                f"{frames / row['frames']:.1f}",
            ])  # fmt: skip
    header = ["scene", "workers", "records: times as fast", "of it repeated", "picture", "link busy", "frames"]
    plot = "![Speed against workers](benchmarks/farm-scaling.svg)"
    return f"{document.table(header, rows)}\n\n{plot}"


def plots(result: dict[str, Any]) -> dict[str, str]:
    series = {}
    for name, scene in result["scenes"].items():
        rows = scene["rows"]
        series[f"{name}: records"] = [(row["workers"], scene["one_solve"] / row["solve"]) for row in rows]
        series[f"{name}: picture"] = [(row["workers"], scene["one_picture"] / row["picture"]) for row in rows]
        series[f"{name}: frames"] = [(row["workers"], rows[0]["frames"] / row["frames"]) for row in rows]
    return {"farm-scaling": log_log_plot(series, "workers", "times as fast", lambda value: f"{value:g}")}


BENCHMARK = Benchmark("farm-scaling", __doc__, ("cornell-box", "atrium"), run, tables, plots)

if __name__ == "__main__":
    main(BENCHMARK)
