# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How far a method's pictures are from those of `path`, over blocks of pixels that average the noise of both away."""

from __future__ import annotations

import functools

import numpy as np

import eclat
from eclat.methods import Method
from eclat.scene import Scene
from eclat.scenes import build
from support.courtyard import LIGHTS, court
from support.statistics import block_means

SIZE = (48, 48)


@functools.cache
def traced(name: str, samples: int, max_depth: int = -1) -> tuple[Scene, np.ndarray]:
    """A built-in scene, or the court under one of its lights, and its picture by `path`."""
    scene = court(name) if name in LIGHTS else build(name)
    return scene, eclat.render(scene, eclat.Path(), samples=samples, size=SIZE, seed=1, max_depth=max_depth).pixels


def bias(scene: Scene, reference: np.ndarray, options: Method, *, samples: int = 64, max_depth: int = -1) -> float:
    """RMS over blocks of 12 × 12 pixels, relative, darkness floored by a tenth of the mean."""
    image = eclat.render(scene, options, samples=samples, size=SIZE, max_depth=max_depth).pixels
    ours, theirs = block_means(image, 12), block_means(reference, 12)
    return float(np.sqrt(np.mean((ours - theirs) ** 2 / (theirs**2 + (0.1 * theirs.mean()) ** 2))))
