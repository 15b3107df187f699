# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Furnished rooms as Éclat draws them, beside the references that came with the scenes.

Writes docs/pictures/beside-reference.jpg: for each scene our picture on the left, the reference on the right, in the same
exposure. Says the true error, what the picture states, and how many pixels of each stand out from their 3 × 3 median: specks
that a reference of that noise does not have. Scenes and references are found through ECLAT_SCENES.

    python benchmarks/beside_reference.py --size 640 --max-error 0.03
"""

from __future__ import annotations

import argparse
import warnings

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from PIL import Image as PillowImage

import eclat
from eclat.images.image import Image
from eclat.images.tone import to_display
from eclat.measure.error_estimate import error_text
from eclat.verbs.compare import auto_exposure
from harness.machine import ROOT
from harness.references import given
from harness.scenes import SCENES

ROOMS = {"living-room": 0.05, "classroom": 0.1}
"""Rooms, and the error for which each is rendered unless another is given; a sun in its sky makes the classroom dearer."""
STANDS_OUT = 0.5
"""A pixel whose luminance differs from the median by this share of the median and a tenth of the picture's mean is counted."""

FILE = ROOT / "docs" / "pictures" / "beside-reference.jpg"
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def outliers(pixels: NDArray[np.floating]) -> int:
    """Count the pixels that stand out from the median of their 3 × 3 neighbourhood."""
    luminance = np.asarray(pixels, np.float64) @ LUMINANCE
    padded = np.pad(luminance, 1, mode="edge")
    median = np.median(sliding_window_view(padded, (3, 3)), axis=(-1, -2))
    allowed = STANDS_OUT * median + 0.1 * luminance.mean()
    return int(np.count_nonzero(np.abs(luminance - median) > allowed))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=640, metavar="PIXELS", help="longer side, a whole fraction of 640")
    parser.add_argument("--max-error", type=float, help="as of `eclat render`, for all rooms")
    arguments = parser.parse_args()
    rows = []
    for name, usual in ROOMS.items():
        place = SCENES[name]
        scene, size = place.load(), place.size_for(False, arguments.size)
        found = place.given_reference(name, size)
        if found is None:
            parser.error(f"{name}: no reference of a multiple of {size[0]} × {size[1]} is found through ECLAT_SCENES")
        truth = given(*found, scene, None)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            image = eclat.render(scene, max_error=arguments.max_error or usual, size=size)
        mean = ((truth.a + truth.b) / 2).astype(np.float32)
        statistics = image.metadata["statistics"]
        raw = image.layers.get("noisy", image.pixels)
        counts = [outliers(pixels) for pixels in (image.pixels, raw, truth.a, truth.b, mean)]
        print(f"{name} {size[0]} × {size[1]}: {statistics['seconds']:.0f} s, true error {100 * truth.error(image)[0]:.1f} %, "
              f"{error_text(statistics)}; pixels that stand out: {counts[0]}, before denoising {counts[1]}, in the halves of "
              f"the reference {counts[2]} and {counts[3]}, in their mean {counts[4]}", flush=True)  # fmt: skip
        stops = auto_exposure(Image(mean))
        rows.append(np.concatenate([to_display(image.pixels, stops), to_display(mean, stops)], axis=1))
        PillowImage.fromarray(np.concatenate(rows)).save(
            FILE, quality=88
        )  # after each scene, as the next takes minutes
    print(FILE)


if __name__ == "__main__":
    main()
