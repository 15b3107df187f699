# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Motion blur: a frame as the mean of pictures at several times while the shutter is open."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from eclat.images.image import Image
from eclat.sampling.halves import seed_of_half

_AVERAGED = ("direct", "indirect", "albedo", "noisy")
_FIRST_SEED = 16
"""The halves of a picture and its probes have the first seeds, its moments the next ones."""


def moments(time: float, shutter: float, count: int) -> list[float]:
    """Return the times of a frame's pictures in seconds: the middles of `count` equal parts of the time, `shutter` seconds
    long, in the middle of which the frame's own `time` lies."""
    return [time + shutter * ((k + 0.5) / count - 0.5) for k in range(count)] if shutter > 0 else [time]


def samples_each(samples: int | None, count: int) -> int | None:
    """Return the number of samples per pixel of each of `count` pictures that have `samples` together, rounded up."""
    return None if samples is None else math.ceil(samples / count)


def seed_of_moment(seed: int, k: int, count: int) -> int:
    """Return the seed of the picture `k` of `count`, so that the noise of the pictures differs."""
    return seed if count == 1 else seed_of_half(seed, _FIRST_SEED + 8 * k)


def mean_of(pictures: Sequence[Image]) -> Image:
    """Return the mean of the pictures of one frame. Layers of geometry are those of the picture in the middle.

    Counts in the statistics are sums. Errors are the root mean square of those of the pictures, which would be the error
    of the mean if all pictures erred in the same way; independent noise is less.
    """
    if len(pictures) == 1:
        return pictures[0]
    middle = pictures[len(pictures) // 2]
    layers = dict(middle.layers)
    for name in _AVERAGED:
        if all(name in picture.layers for picture in pictures):
            layers[name] = np.mean([picture.layers[name] for picture in pictures], axis=0, dtype=np.float64)
    each = [picture.metadata["statistics"] for picture in pictures]
    statistics = dict(middle.metadata["statistics"])
    for name in statistics:
        values = [one[name] for one in each if name in one]
        if name in ("samples", "rays", "seconds"):
            statistics[name] = math.fsum(values)
        elif "error" in name or name.startswith("noise"):
            statistics[name] = math.sqrt(math.fsum(v * v for v in values) / len(values))
    metadata = middle.metadata | {"statistics": statistics, "moments": len(pictures)}
    pixels = np.mean([picture.pixels for picture in pictures], axis=0, dtype=np.float64)
    return Image(np.asarray(pixels, np.float32), {n: np.asarray(v, np.float32) for n, v in layers.items()}, metadata)
