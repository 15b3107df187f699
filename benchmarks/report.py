# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Put the stored results of all benchmarks into docs/benchmarks.md and docs/peers.md, each table between its markers.

A benchmark without a result in benchmarks/results is left as it is, and named.
"""

from __future__ import annotations

import argparse
import json

import calibration
import convergence
import embree_rate
import equal_error
import far_end
import farm_scaling
import flicker
import fly_through
import glossy
import lazy_fill
import max_error
import memory
import path_rate
import peers
import radiosity_scaling
import scaling
from harness.benchmark import RESULTS

MODULES = (
    path_rate,
    embree_rate,
    equal_error,
    glossy,
    fly_through,
    flicker,
    max_error,
    scaling,
    radiosity_scaling,
    farm_scaling,
    memory,
    lazy_fill,
    far_end,
    peers,
    calibration,
    convergence,
)


def main() -> None:
    argparse.ArgumentParser(description=__doc__).parse_args()
    for benchmark in (module.BENCHMARK for module in MODULES):
        path = RESULTS / f"{benchmark.name}.json"
        if path.is_file():
            benchmark.write(json.loads(path.read_text(encoding="utf-8")))
            print(f"{benchmark.name}: written")
        else:
            print(f"{benchmark.name}: no result; run python benchmarks/{benchmark.name.replace('-', '_')}.py")


if __name__ == "__main__":
    main()
