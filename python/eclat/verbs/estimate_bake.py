# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `estimate_bake`, which says how large a light map will be and about how long it will take, before it is baked."""

from __future__ import annotations

import math
import os
import time as clock
from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from eclat.bridge.arguments import checked_max_depth, checked_max_error, checked_samples, checked_seed, thread_count
from eclat.bridge.running import ProgressReport
from eclat.gltf_export import encode_glb
from eclat.lightmap.atlas import Packing
from eclat.lightmap.darkness import dark_texels, groups_of
from eclat.lightmap.gathering import Settings, TexelPoints, gather, sample_points, visible_points
from eclat.lightmap.layout import Wishes, lay_out
from eclat.lightmap.sides import SidesChoice
from eclat.lightmap.solids import Mask
from eclat.methods import IrradianceCache, Method, Source, as_method
from eclat.scene import Scene
from eclat.stage.staging import staged
from eclat.typed import typed
from eclat.verbs.bake import MAX_SIZE, SAMPLES, check_map
from eclat.verbs.irradiance import checked_component
from eclat.verbs.light_at_points import Component

TRIALS = (256, 1024, 4096)
"""Approximate numbers of texels that are baked to see how the work grows with them. Whole groups of neighbours (`groups_of`) are
taken, because neighbours share records."""

LOOKED_AT = 16384
"""Approximate number of texels among which hidden and dark ones are looked for, in whole groups. The shares of
these are taken for those of all texels."""

PNG_BYTES, EXR_BYTES, KTX2_BYTES = 3, 12, 8 * 4 / 3
"""Bytes of a texel without compression in the embedded PNG, in the EXR and in the KTX2 file, of which all levels of a mip map
together have four thirds of the texels of the largest."""

FIT_SECONDS = 3e-5
"""Seconds per texel for the fit and the files, which trials are too small to show: the fit of the 279,929 texels of Sibenik took
8 s."""


@dataclass(frozen=True)
class BakeEstimate:
    """What a light map will take.

    `texels` is the number of texels that surfaces use, in `charts`, on `pages` of `width` × `height` texels. `texel_size` is
    in metres. `most_bytes` is an upper bound of the size of all files, without compression of images. `rays` and `seconds`
    are predicted from bakes of a few texels, on as many processors; the truth is often twice as much or half of it.
    """

    texels: int
    charts: int
    pages: int
    width: int
    height: int
    texel_size: float
    most_bytes: int
    rays: float
    seconds: float


@typed
def estimate_bake(
    scene: Scene | str | os.PathLike[str],
    what: Source | type[Method] | str | None = None,
    *,
    component: Component = "total",
    texel_size: float | None = None,
    texel_sizes: Mapping[str, float] | None = None,
    ktx2: bool = False,
    sides: SidesChoice = "auto",
    samples: int = SAMPLES,
    supersampling: int = 2,
    max_error: float = 0.01,
    max_depth: int = -1,
    gutter: int = 2,
    max_size: int = MAX_SIZE,
    charts_timeout: float = 60.0,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> BakeEstimate:
    """Lay out the light map of `scene`, and bake a few of its texels to predict the time.

    The arguments are those of `eclat.bake`, and `ktx2` that of `Lightmap.save`.

    Raises
    ------
    EclatError : as `eclat.bake` does before it begins.

    Examples
    --------
    >>> import eclat
    >>> found = eclat.estimate_bake("furnace", texel_size=0.2, samples=16)
    >>> found.pages
    1
    """
    checked_component(component)
    scene = staged(scene)
    checked_seed(seed), thread_count(threads), checked_samples(samples), checked_max_depth(max_depth)
    check_map(False, sides, supersampling, gutter, max_size)
    source = as_method(what, IrradianceCache(max_error=checked_max_error(max_error)), max_error=max_error)
    source.require_match(scene, max_depth)
    started = clock.perf_counter()
    wishes = Wishes(texel_size, texel_sizes or {}, sides, Packing(gutter, max_size, charts_timeout))
    layout = lay_out(scene, wishes, threads, progress)
    settings = Settings(component, samples, max_depth, seed, threads, progress)
    laid_out = clock.perf_counter() - started
    groups = groups_of(layout)
    looked_at = _spread_groups(groups, LOOKED_AT)
    points = sample_points(layout.corners, layout.texels.chosen(looked_at), supersampling)
    free = visible_points(scene, layout.solid, points, settings)
    dark = dark_texels(scene, groups[looked_at], points, free, settings)
    others = len(layout.texels) / max(1, len(looked_at))
    looked = others * (clock.perf_counter() - started - laid_out)
    lit = np.flatnonzero(~dark.mask & free[:, 1:].any(axis=1))
    count = round(others * len(lit))
    own = groups[looked_at][lit]
    chosen = [_spread_groups(own, number) for number in sorted({min(len(lit), n) for n in TRIALS})]
    trials = [_trial(scene, source, points, free, lit[which], settings) for which in chosen]
    rays = extrapolated([len(which) for which in chosen], [rays for rays, _ in trials], count)
    last_rays, last_seconds = trials[-1]
    height, width = layout.page_shape
    all_texels = layout.atlas.pages * height * width
    bare = len(encode_glb(scene, layout.parts(), lights=component == "indirect"))
    return BakeEstimate(
        texels=len(layout.texels),
        charts=layout.charts,
        pages=layout.atlas.pages,
        width=width,
        height=height,
        texel_size=layout.texel_size,
        most_bytes=bare + math.ceil(all_texels * (PNG_BYTES + EXR_BYTES + (KTX2_BYTES if ktx2 else 0))),
        rays=rays + others * dark.rays,
        seconds=laid_out + looked + last_seconds * rays / max(last_rays, 1.0) + FIT_SECONDS * len(layout.texels),
    )


def extrapolated(numbers: list[int], rays: list[float], count: int) -> float:
    """Predict the rays of `count` texels from those of a few numbers of them, which grow.

    Some rays are needed for any number of texels, such as those of far records; the others follow a power of the number,
    which is 1 for light from lamps and less for records that serve many texels. With fewer than three numbers, all rays are
    in proportion to the number.
    """
    if len(numbers) < 3 or numbers[-1] >= count:
        return rays[-1] * count / max(1, numbers[-1])
    growth = max(rays[2] - rays[1], 1.0) / max(rays[1] - rays[0], 1.0)
    powers = np.linspace(0.25, 1, 301)[:, None]
    steps = np.diff(np.array(numbers, np.float64) ** powers, axis=1)
    power = float(powers[np.argmin(np.abs(np.log(steps[:, 1] / steps[:, 0]) - np.log(growth))), 0])
    share = max(rays[2] - rays[1], 1.0) / (numbers[2] ** power - numbers[1] ** power)
    return float(rays[2] + share * (count**power - numbers[2] ** power))


def _spread_groups(groups: NDArray[np.int64], number: int) -> NDArray[np.int64]:
    """Choose about `number` texels in whole groups, evenly spread over the groups, of which `groups` (N,) are the numbers.
    A group is as likely as any other, so that the borders of charts have their share."""
    every = np.unique(groups)
    count = max(1, round(number * len(every) / max(1, len(groups))))
    if count >= len(every):
        return np.arange(len(groups))
    picked = every[np.linspace(0, len(every) - 1, count).round().astype(np.int64)]
    return np.flatnonzero(np.isin(groups, picked))


def _trial(
    scene: Scene, source: Source, points: TexelPoints, free: Mask, which: NDArray[np.int64], settings: Settings
) -> tuple[float, float]:
    """Bake the texels `which`; return the number of rays and the seconds."""
    started = clock.perf_counter()
    chosen = TexelPoints(*(getattr(points, field.name)[which] for field in fields(TexelPoints)))
    gathered = gather(scene, source, chosen, free[which], settings)
    return gathered.counts["rays"], clock.perf_counter() - started
