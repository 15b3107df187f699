# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Irradiance caching beside path tracing, at about equal time, on built-in scenes: pictures in `out/`."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

import eclat
from eclat.scenes import build

SCENES = {"cornell-box": (512, 512, 0.0), "atrium": (480, 270, 0.0)}


def relative_error(picture: np.ndarray, reference: np.ndarray) -> float:
    return float(np.sqrt(np.mean((picture - reference) ** 2 / (reference**2 + 0.01 * np.mean(reference**2)))))


def main() -> None:
    folder = Path("out")
    folder.mkdir(exist_ok=True)
    for name, (width, height, exposure) in SCENES.items():
        scene = build(name)
        size = (width, height)
        eclat.render(scene, eclat.Path(), samples=1, size=size)  # builds the tree, warms up
        reference = eclat.render(scene, eclat.Path(), samples=128, size=size, seed=99)
        started = time.perf_counter()
        cached = eclat.render(scene, eclat.IrradianceCache(), samples=16, size=size)
        seconds = time.perf_counter() - started
        started = time.perf_counter()
        eclat.render(scene, eclat.Path(), samples=4, size=size)
        per_sample = (time.perf_counter() - started) / 4
        traced = eclat.render(scene, eclat.Path(), samples=max(1, round(seconds / per_sample)), size=size)
        for method, image in (("irradiance-cache", cached), ("path", traced)):
            spent = image.metadata["statistics"]["seconds"]
            error = relative_error(image.pixels, reference.pixels)
            print(
                f"{name:12} {method:17} {spent:6.1f} s   error {100 * error:5.2f} % (128-sample reference, noise included)"
            )
        pair = eclat.Image(np.concatenate([cached.pixels, traced.pixels], axis=1))
        pair.save(folder / f"{name}.png", exposure=exposure)
        cached.save(folder / f"{name}.exr")
        print(
            f"{'':12} pictures: {folder / f'{name}.png'} (left: irradiance cache, right: path), {folder / f'{name}.exr'}"
        )


if __name__ == "__main__":
    main()
