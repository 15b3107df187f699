#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The rooms of docs/defects.md, by irradiance caching: `examples/defects.py [--quick] [FOLDER] [NAME …]` writes JPEGs."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image

import eclat
from eclat.scenes.hard_cases import CASES
from eclat.tone import to_display

QUALITY = 82


def main(arguments: list[str]) -> None:
    quick = "--quick" in arguments
    folder, *names = [a for a in arguments if a != "--quick"] or ["out"]
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name in names or CASES:
        picture = eclat.render(CASES[name](), samples=1 if quick else 12, size=(48, 36) if quick else (320, 240))
        exposure = float(np.log2(0.3 / np.median(picture.pixels.mean(axis=2))))
        target = Path(folder) / f"defect-{name}.jpg"
        Image.fromarray(to_display(picture.pixels, exposure=exposure)).save(target, quality=QUALITY)
        counts = picture.metadata["statistics"]
        print(
            f"{target}: {counts['records']:.0f} records, {counts['cache_misses']:.0f} misses, {counts['rays']:.3g} rays"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
