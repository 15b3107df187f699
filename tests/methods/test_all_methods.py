# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""All methods that know all light, on scenes where all are valid, against the closed form or `path`, each within its bias."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import eclat
from eclat.methods import Method
from eclat.scene import Scene
from eclat.scenes import build
from support.statistics import block_means

SIZES = {"furnace": (32, 32), "cornell-box": (48, 48), "atrium": (64, 36)}
BLOCK = {"furnace": (8, 8), "cornell-box": (12, 12), "atrium": (9, 16)}
RHO = 0.7

METHODS: dict[str, Method] = {
    "irradiance-cache": eclat.IrradianceCache(),
    "radiance-cache": eclat.RadianceCache(),
    "photon-map": eclat.PhotonMap(photons=50_000),
    "radiosity": eclat.Radiosity(patches=6000, tolerance=0.05, refinements=1),
}

MOST_ERROR = {"furnace": 0.01, "cornell-box": 0.015, "atrium": 0.045}
"""RMS over blocks of pixels, relative, darkness floored by a tenth of the mean: bias of the method and noise of both."""


@functools.cache
def scene_and_truth(name: str) -> tuple[Scene, np.ndarray]:
    size = SIZES[name]
    if name == "furnace":
        # L = L_e / (1 − ρ) everywhere.
        return build(name, rho=RHO, emission=1.0), np.full((size[1], size[0], 3), 1 / (1 - RHO))
    scene = build(name)
    return scene, eclat.render(scene, eclat.Path(), samples=256, size=size, seed=1).pixels


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", SIZES)
def test_methods_agree(name: str, method: str) -> None:
    scene, truth = scene_and_truth(name)
    image = eclat.render(scene, METHODS[method], samples=48, size=SIZES[name], check=False).pixels
    ours, theirs = (block_means(picture, BLOCK[name]) for picture in (image, truth))
    error = float(np.sqrt(np.mean((ours - theirs) ** 2 / (theirs**2 + (0.1 * theirs.mean()) ** 2))))
    print(f"{name} {method}: {error:.4f}, mean {image.mean() / truth.mean():.4f}")
    assert error < MOST_ERROR[name]
