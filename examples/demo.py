# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Irradiance caching beside path tracing, at about equal time, on built-in scenes: pictures in `out/`.

Errors are relative and those of all our figures (`eclat.measure.metrics`): against two independent path-traced pictures, whose
noise puts no floor under them.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

import eclat
from eclat.measure.metrics import relative_rmse
from eclat.scenes import build

SIZES = {"cornell-box": (512, 512), "atrium": (480, 270)}
REFERENCE_SAMPLES = 64
"""Of each of two."""


def show(name: str, size: tuple[int, int], reference_samples: int, folder: Path) -> None:
    """Render a scene by both methods, say times and errors, and write the pictures side by side."""
    scene = build(name)
    a, b = (eclat.render(scene, eclat.Path(), samples=reference_samples, size=size, seed=seed) for seed in (98, 99))

    started = time.perf_counter()
    cached = eclat.render(scene, eclat.IrradianceCache(), samples=16, size=size)
    seconds = time.perf_counter() - started

    seconds_per_sample = a.metadata["statistics"]["seconds"] / reference_samples
    traced = eclat.render(scene, eclat.Path(), samples=max(1, round(seconds / seconds_per_sample)), size=size)

    for method, image in (("irradiance-cache", cached), ("path", traced)):
        spent = image.metadata["statistics"]["seconds"]
        error = relative_rmse(image.pixels, a.pixels, b.pixels)
        print(f"{name:12} {method:17} {spent:6.1f} s   error {100 * error:5.2f} %")
    pair = eclat.Image(np.concatenate([cached.pixels, traced.pixels], axis=1))
    files = [folder / f"{name}.png", folder / f"{name}.exr"]
    pair.save(files[0])
    cached.save(files[1])
    print(
        f"{'':12} {files[0]} (left: irradiance cache, right: path), {files[1]} (irradiance cache, layers)", flush=True
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="small pictures of few samples, to see that all works")
    quick = parser.parse_args().quick
    folder = Path("out")
    folder.mkdir(exist_ok=True)
    for name, (width, height) in SIZES.items():
        size = (width // 8, height // 8) if quick else (width, height)
        show(name, size, 4 if quick else REFERENCE_SAMPLES, folder)


if __name__ == "__main__":
    main()
