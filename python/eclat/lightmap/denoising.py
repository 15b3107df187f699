# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Light maps without their noise, and the error that is left, measured over the texels that surfaces use.

As for pictures, the light of the texels is gathered in two halves with seeds of their own, each half is denoised alone, and
the halves judge each other (`sampling.denoised_halves`). Charts are islands: texels of no surface take the value of the
nearest one that has a surface before the denoiser sees the map, so that each chart goes on beyond its border as it is there
and meets its neighbour in the middle of the gutter. What the denoiser makes of these texels is not used. It sees each chart
divided by the mean of its half there, so that what reaches a dark chart from a bright neighbour is small beside its own light.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eclat.images import denoiser
from eclat.lightmap.gathering import GatheredTexels, Settings, TexelPoints, gather
from eclat.lightmap.gutters import fill_nearest
from eclat.lightmap.solids import Mask
from eclat.lightmap.texels import Texels
from eclat.measure.error_estimate import CHANCE_ENTRIES, ErrorEstimate, with_light_by_chance
from eclat.methods import Prepared, Source
from eclat.sampling.denoised_halves import DenoisedHalves, judged_halves
from eclat.sampling.halves import seed_of_half
from eclat.scene import FloatArray, Scene


def gather_denoised(
    scene: Scene,
    source: Source,
    points: TexelPoints,
    free: Mask,
    settings: Settings,
    texels: Texels,
    charts: NDArray[np.int64],
    size: tuple[int, int],
) -> GatheredTexels:
    """Gather the light of the texels as `gather` does, in two halves with half of the samples each, and denoise it.

    `charts` (N,) are the charts of the texels, and `size` is the (height, width) of the map. Records are solved once and read
    by both halves. The counts hold `noise_left`,
    `noise_left_low` and `noise_left_high` in place of `direct_error`, the error that is left before texels are fitted;
    where noise is all that errs, or the error of the records is known, they hold `estimated_error` with its ends as well;
    `denoised` is the mean weight of the denoised map in what is used.

    Raises EclatError if no denoiser is installed.
    """
    halves = []
    for half in range(2):
        part = replace(settings, samples=math.ceil(settings.samples / 2), seed=seed_of_half(settings.seed, half))
        halves.append(gather(scene, source, points, free, part))
        source = halves[0].source
    covered = np.zeros(size, dtype=bool)
    covered[texels.rows[halves[0].seen], texels.columns[halves[0].seen]] = True
    maps = [_map_of(gathered.values, gathered.seen, texels, size) for gathered in halves]
    clean = []
    for gathered, noisy in zip(halves, maps, strict=True):
        level = _map_of(_means_of_charts(gathered, charts), gathered.seen, texels, size)
        relative = np.divide(noisy, level, out=np.zeros_like(level), where=level > 0)
        clean.append(level * denoiser.denoise(fill_nearest(relative, covered), kind="lightmap"))
    found = judged_halves(maps[0], maps[1], clean[0], clean[1], covered)
    counts = {"rays": halves[0].counts["rays"] + halves[1].counts["rays"]} | _errors(found, source, halves[0].counts)
    counts["denoised"] = float(found.weight[covered].mean()) if covered.any() else 0.0
    values = np.where(halves[0].seen[:, None], found.pixels[texels.rows, texels.columns], 0.0)
    return replace(halves[0], values=values, counts=counts)


def _map_of(values: FloatArray, seen: Mask, texels: Texels, size: tuple[int, int]) -> FloatArray:
    """Place the values (N, 3) of texels into a map (H, W, 3), which is 0 where nothing is seen."""
    image: FloatArray = np.zeros((*size, 3))
    image[texels.rows[seen], texels.columns[seen]] = values[seen]
    return image


def _means_of_charts(gathered: GatheredTexels, charts: NDArray[np.int64]) -> FloatArray:
    """Compute for each texel the mean light of all that is seen of its chart, (N, 3); all channels have the same."""
    chart, seen = charts + 1, gathered.seen  # -1 stands for no chart
    sums = np.bincount(chart[seen], gathered.values[seen].mean(axis=1), minlength=int(chart.max(initial=0)) + 1)
    counts = np.bincount(chart[seen], minlength=len(sums))
    return np.repeat((sums / np.maximum(counts, 1))[chart][:, None], 3, axis=1)


def _errors(found: DenoisedHalves, source: Source, counts: dict[str, float]) -> dict[str, float]:
    """State what the halves measured, joined with the error of the records if it is known, and the light that both halves find
    only by chance, as `counts` tell."""
    own = found.estimate
    known: ErrorEstimate | None = source.estimate if isinstance(source, Prepared) else None
    statistics = own.noise_statistics()
    if known is not None:
        statistics |= known.joined(own).statistics()
    elif source.options.solved is None:
        statistics |= own.statistics()
        statistics |= with_light_by_chance(statistics, counts)
    return statistics | {name: counts[name] for name in CHANCE_ENTRIES if name in counts}
