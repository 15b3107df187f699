# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The bias of irradiance and radiance caching in real buildings: measured against `path`, without what either has of noise.

Blocks of pixels are compared, two pictures of one cache with independent path-traced ones: see `squared_bias`.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import eclat
from support.statistics import block_means, squared_bias

SIZE = (64, 36)
BLOCK = (12, 16)  # rows, columns of pixels
REFERENCES = 6


@dataclass(frozen=True)
class Case:
    """A scene, the samples per pixel of each reference, and the bias that we state: relative RMS over blocks and
    colours, and of the picture's mean. Measured over three seeds: veach-door 0.045 to 0.08 and 0.02 to 0.035, Sponza
    0.010 and 0.003, Sibenik 0.01 to 0.024 and 0.005, bitterli-veach-bidir (glass, rough metal) 0.03 and 0.01 to 0.02; the
    rest is room for other seeds and machines."""

    file: str
    samples: int
    of_blocks: float
    of_mean: float
    method: type[eclat.IrradianceCache] = eclat.IrradianceCache
    marks: tuple[pytest.MarkDecorator, ...] = ()


CASES = [
    Case("veach-door/scene.xml", 256, of_blocks=0.1, of_mean=0.045, marks=(pytest.mark.full,)),
    Case("sponza-dabrovic/sun.xml", 64, of_blocks=0.02, of_mean=0.01, marks=(pytest.mark.full,)),
    Case("sibenik/nave.xml", 96, of_blocks=0.04, of_mean=0.02),
    Case("bitterli-veach-bidir/scene.xml", 256, of_blocks=0.06, of_mean=0.045, method=eclat.RadianceCache),
]


@pytest.mark.parametrize("case", [pytest.param(c, id=c.file.split("/")[0], marks=c.marks) for c in CASES])
@pytest.mark.filterwarnings("ignore::eclat.EclatWarning")
def test_the_bias_is_no_more_than_stated(scenes: Path, case: Case) -> None:
    if not (scenes / case.file).is_file():
        pytest.skip(f"{case.file} is not in {scenes}: see CONTRIBUTING.md, 'Real scenes'")
    scene = eclat.load(scenes / case.file)

    def blocks(what: eclat.Path | eclat.Solution, samples: int, seed: int) -> np.ndarray:
        return block_means(eclat.render(scene, what, samples=samples, size=SIZE, seed=seed).pixels, BLOCK)

    paths = [blocks(eclat.Path(), case.samples, 100 + run) for run in range(REFERENCES)]
    cache = eclat.solve(scene, case.method(), size=SIZE)
    first, second = (blocks(cache, 4 * case.samples, 200 + run) for run in range(2))

    squared, uncertainty = squared_bias(first, second, paths)
    assert uncertainty < 0.5 * case.of_blocks**2, "the references are too noisy to tell"
    assert squared < case.of_blocks**2
    assert (first + second).mean() / 2 == pytest.approx(np.mean(paths), rel=case.of_mean)
