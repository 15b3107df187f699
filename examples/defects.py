#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The rooms of docs/defects.md, by irradiance caching: `examples/defects.py [--quick] [FOLDER] [NAME …]` writes JPEGs, and
without names one more with all of them."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image

import eclat
from eclat.images.tone import to_display
from eclat.scenes.hard_cases import CASES

QUALITY = 82
COLUMNS = 5


def main(arguments: list[str]) -> None:
    quick = "--quick" in arguments
    folder, *names = [a for a in arguments if a != "--quick"] or ["out"]
    Path(folder).mkdir(parents=True, exist_ok=True)
    drawn: list[Image.Image] = []
    for name in names or CASES:
        picture = eclat.render(CASES[name](), samples=1 if quick else 12, size=(48, 36) if quick else (320, 240))
        exposure = float(np.log2(0.3 / np.median(picture.pixels.mean(axis=2))))
        target = Path(folder) / f"defect-{name}.jpg"
        drawn.append(Image.fromarray(to_display(picture.pixels, exposure=exposure)))
        drawn[-1].save(target, quality=QUALITY)
        counts = picture.metadata["statistics"]
        print(
            f"{target}: {counts['records']:.0f} records, {counts['cache_misses']:.0f} misses, {counts['rays']:.3g} rays"
        )
    if not names:
        sheet(drawn).save(Path(folder) / "defects.jpg", quality=QUALITY)


def sheet(pictures: list[Image.Image]) -> Image.Image:
    """Pictures of one size beside each other, five in a row."""
    width, height = pictures[0].size
    rows = -(-len(pictures) // COLUMNS)
    out = Image.new("RGB", (COLUMNS * width, rows * height))
    for i, picture in enumerate(pictures):
        out.paste(picture, (i % COLUMNS * width, i // COLUMNS * height))
    return out


if __name__ == "__main__":
    main(sys.argv[1:])
