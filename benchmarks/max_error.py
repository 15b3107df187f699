# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records, rays, time and error against max_error, the one knob of irradiance caching.

`solve` alone is timed (tree included); then the picture is rendered as a user gets it who gives max_error and no number
of samples, and its error over all pixels is measured against two path-traced references. "cache alone" is the error of
the records without the noise of pixels. Takes about twenty minutes, the first time longer for the references.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import eclat
from eclat.scene import Scene
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.curves import as_rows, from_rows, measure
from harness.references import reference
from harness.scenes import BenchmarkScene

MAX_ERRORS = (0.08, 0.04, 0.02, 0.01, 0.005)
SAMPLES = 64
"""A pixel, of the two pictures that tell the error of the records alone."""

SEED = 1


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene, size = place.load(), place.size_for(settings.quick)
    truth = reference(name, scene, size, place.c, settings.reference_samples)
    shared: dict[str, Any] = {"size": size, "threads": settings.threads}
    wanted = MAX_ERRORS[: 3 if settings.quick else None]
    pictures = []

    def judge(solution: eclat.Solution) -> tuple[float, float | None]:
        max_error = solution.options.max_error
        pair = [eclat.render(scene, solution, samples=SAMPLES, seed=s, **shared) for s in (SEED, SEED + 1)]
        image = eclat.render(scene, solution, max_error=max_error, seed=SEED, denoise=False, **shared)
        statistics = image.metadata["statistics"]
        everywhere, away = truth.error(image)
        pictures.append({
            "error": everywhere, "error_away": away, "samples": int(statistics["samples"]),
            "cache_misses": int(statistics.get("cache_misses", 0)), "far_records": int(solution.statistics["far_records"]),
            "seconds": statistics["seconds"],
        })  # fmt: skip
        return truth.cache_error(*pair), None

    levels = {f"{e:g}": partial(_solve, eclat.IrradianceCache(max_error=e), shared) for e in wanted}
    points = measure(scene, {"solve": levels}, judge, settings.repeats)["solve"]
    return {"points": as_rows(points), "pictures": pictures, "reference": truth.described(), "size": size}


def _solve(options: eclat.IrradianceCache, shared: dict[str, Any], scene: Scene) -> eclat.Solution:
    return eclat.solve(scene, options, seed=SEED, **shared)


def tables(result: dict[str, Any]) -> str:
    rows = [
        [name, p.label, f"{p.records:,}", f"{picture['far_records']:,}", f"{p.rays / 1e6:.1f} M",
         document.seconds(p.seconds), document.percent(p.error), str(picture["samples"]),
         document.percent(picture["error"]), document.percent(picture["error_away"]), f"{picture['cache_misses']:,}"]
        for name, scene in result["scenes"].items()
        for p, picture in zip(from_rows(scene["points"]), scene["pictures"], strict=True)
    ]  # fmt: skip
    header = ["scene", "max_error", "records", "far records", "rays", "solve", "cache alone", "samples", "picture",
              "away from edges", "misses"]  # fmt: skip
    return document.table(header, rows)


BENCHMARK = Benchmark("max-error", __doc__, ("cornell-box", "sponza", "sibenik"), run, tables, reference_samples=1024)

if __name__ == "__main__":
    main(BENCHMARK)
