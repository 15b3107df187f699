#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The picture of the lecture: Monte Carlo on the left, radiance caching on the right, at equal time.

A Cornell box with a floor of rough chromium and boxes of rough copper and gold. Run it as
`examples/radiance_caching.py [--quick] [FOLDER]`; it writes radiance-caching.jpg and says times and errors. Time is that of
all processors together, so that other work on the machine does not favour either.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import eclat
from eclat.images.tone import to_display
from eclat.measure.metrics import relative_rmse

SIDE, SAMPLES, REFERENCE_SAMPLES = 256, 16, 128
QUALITY = 85


def rough(metal: str, alpha: float) -> dict[str, object]:
    """A bsdf of Mitsuba's."""
    return {"type": "roughconductor", "material": metal, "distribution": "ggx", "alpha": alpha}


def timed(scene: eclat.Scene, what: eclat.RadianceCache | eclat.Path, **keywords: Any) -> tuple[eclat.Image, float]:
    """A picture, and the processor seconds that it took."""
    before = time.process_time()
    image = eclat.render(scene, what, **keywords)
    return image, time.process_time() - before


def main(arguments: list[str]) -> None:
    quick = "--quick" in arguments
    folder = Path(([a for a in arguments if a != "--quick"] or ["out"])[0])
    folder.mkdir(parents=True, exist_ok=True)
    metals = {"floor": rough("Cr", 0.35), "large-box": rough("Cu", 0.4), "small-box": rough("Au", 0.5)}
    scene = eclat.override_materials(eclat.load("cornell-box"), metals)
    size = (40, 40) if quick else (SIDE, SIDE)
    count = 4 if quick else REFERENCE_SAMPLES
    a, seconds = timed(scene, eclat.Path(), samples=count, size=size, seed=98)
    b = eclat.render(scene, eclat.Path(), samples=count, size=size, seed=99)
    eclat.render(scene, eclat.RadianceCache(max_error=0.1), samples=1, size=(16, 16))  # its tables are kept

    cached, spent = timed(scene, eclat.RadianceCache(), samples=SAMPLES, size=size, check=False)
    traced, also = timed(scene, eclat.Path(), samples=max(1, round(spent / seconds * count)), size=size)
    for image, cost in ((traced, also), (cached, spent)):
        samples = image.metadata["statistics"]["samples"]
        error = relative_rmse(image.pixels, a.pixels, b.pixels)
        print(f"{image.metadata['method']:15} {samples:4.0f} samples {cost:6.1f} s   error {100 * error:5.2f} %")
    target = folder / "radiance-caching.jpg"
    pair = np.concatenate([to_display(image.pixels, exposure=0.5) for image in (traced, cached)], axis=1)
    Image.fromarray(pair).save(target, quality=QUALITY)
    layers = cached.layers
    part = layers["gloss_cached"].sum() / max(1e-9, (layers["gloss_cached"] + layers["gloss_traced"]).sum())
    print(f"{target} (left: path, right: radiance-cache, {100 * part:.0f} % of its gloss from records)")


if __name__ == "__main__":
    main(sys.argv[1:])
