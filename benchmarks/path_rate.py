# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Path tracing: samples a second, ours against Mitsuba 3 (llvm_ad_rgb).

Both trace the same triangles with the same camera, a box filter and all cores, to a depth of 8 edges without Russian
roulette, so that their paths are equally long; then, as each does by default, to any depth with roulette from the fifth
edge on. The picture's mean is compared too: a rate of another scene would mean nothing. Takes about five minutes.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

import eclat
from eclat.scene import Scene
from harness import document, mitsuba_peer
from harness.benchmark import Benchmark, Settings, main
from harness.scenes import BenchmarkScene
from harness.timing import in_turn

NEVER = 10**6
DEPTHS = {"8 edges": (8, NEVER), "any": (-1, 5)}
"""Name → (max_depth, first edge at which roulette may end a path)."""


def prepare() -> list[str]:
    return [mitsuba_peer.version(mitsuba_peer.start())]


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    mitsuba = mitsuba_peer.start()
    import drjit

    drjit.set_thread_count(settings.threads)
    scene = place.load()
    size = place.size_for(settings.quick)
    samples = 4 if settings.quick else 32
    theirs = mitsuba_peer.convert(mitsuba, scene, size)
    rows = []
    for depth, (max_depth, roulette) in DEPTHS.items():
        integrator = mitsuba.load_dict({"type": "path", "max_depth": max_depth, "rr_depth": roulette})
        options = eclat.Path(roulette_depth=roulette)
        shared: dict[str, Any] = {"samples": samples, "size": size, "max_depth": max_depth, "threads": settings.threads}
        timed = in_turn(
            {
                "ours": partial(_our_picture, scene, options, shared),
                "theirs": partial(_their_picture, mitsuba, theirs, integrator, samples),
            },
            settings.repeats,
        )
        count = size[0] * size[1] * samples
        ours, peer = timed["ours"], timed["theirs"]
        rows.append({
            "depth": depth, "ours": count / ours.seconds, "theirs": count / peer.seconds,
            "mean_ratio": float(np.mean(ours.value) / np.mean(peer.value)), "rounds": [ours.rounds, peer.rounds],
        })  # fmt: skip
    return {"rows": rows, "samples": samples, "size": size}


def _our_picture(scene: Scene, options: eclat.Path, shared: dict[str, Any]) -> np.ndarray:
    return eclat.render(scene, options, **shared).pixels


def _their_picture(mitsuba: Any, scene: Any, integrator: Any, samples: int) -> np.ndarray:
    return np.array(mitsuba.render(scene, integrator=integrator, spp=samples))


def tables(result: dict[str, Any]) -> str:
    rows = [
        [name, row["depth"], f"{row['ours'] / 1e6:.2f} M/s", f"{row['theirs'] / 1e6:.2f} M/s",
         document.ratio(row["ours"] / row["theirs"]), f"{row['mean_ratio']:.4f}"]
        for name, scene in result["scenes"].items() for row in scene["rows"]
    ]  # fmt: skip
    return document.table(["scene", "depth", "ours", "Mitsuba 3", "ours : theirs", "means, ours : theirs"], rows)


BENCHMARK = Benchmark("path-rate", __doc__, ("cornell-box", "sponza"), run, tables, prepare=prepare)

if __name__ == "__main__":
    main(BENCHMARK)
