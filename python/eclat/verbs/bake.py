# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `bake`, which computes light maps: images of the irradiance on all surfaces, for viewers that cannot compute
it."""

from __future__ import annotations

import os
import time as clock
from collections.abc import Mapping
from dataclasses import asdict
from typing import get_args

from eclat.bridge.arguments import checked_max_depth, checked_max_error, checked_samples, checked_seed, thread_count
from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError, did_you_mean, warn
from eclat.images.denoiser import require_denoiser
from eclat.lightmap.atlas import Packing
from eclat.lightmap.darkness import Dark, dark_texels, groups_of, with_dark
from eclat.lightmap.denoising import gather_denoised
from eclat.lightmap.directional import gather_harmonics
from eclat.lightmap.fitting import fitted_harmonics, fitted_pages
from eclat.lightmap.gathering import GatheredTexels, Settings, gather, sample_points, visible_points
from eclat.lightmap.layout import Layout, Wishes, lay_out
from eclat.lightmap.lightmap import Lightmap
from eclat.lightmap.sides import SidesChoice
from eclat.lightmap.stages import stage
from eclat.measure.error_estimate import chance_warning
from eclat.methods import IrradianceCache, Method, Source, as_method
from eclat.scene import Scene
from eclat.stage.staging import staged
from eclat.typed import typed
from eclat.verbs.irradiance import checked_component
from eclat.verbs.light_at_points import Component

SAMPLES = 256
"""Default number of samples of the lights per texel."""

MAX_SIZE = 4096
"""Default largest width and height in texels, which most WebGL 2 devices support."""

LARGEST_SIZE = 16384
"""Upper limit of `max_size` in texels."""


@typed
def bake(
    scene: Scene | str | os.PathLike[str],
    what: Source | type[Method] | str | None = None,
    *,
    denoise: bool = False,
    component: Component = "total",
    texel_size: float | None = None,
    texel_sizes: Mapping[str, float] | None = None,
    directional: bool = False,
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
) -> Lightmap:
    """Compute the light map of `scene`, an image of the irradiance on all its surfaces.

    Parameters
    ----------
    what : a method, its class or its name, or a solution, as for `eclat.irradiance`; None means irradiance caching.
    denoise : whether Open Image Denoise, by its network for light maps, removes the noise. The light is then gathered in two
        halves with half of the samples each, which measure the error that is left over the texels of surfaces; where denoising
        would increase it, the samples are kept (`lightmap.denoising`). The statistics hold `noise_left` and, where no other
        error is unknown, `estimated_error`, each with the ends of its 95 % confidence interval.
    component : the light to compute: "total", "direct" or "indirect". With "indirect", the saved file keeps the scene's
        lights, and the viewer adds their direct light itself.
    texel_size : side of a texel in metres. None chooses it so that all surfaces take about a quarter of a
        million texels.
    texel_sizes : other sizes for meshes by their names, which may be shell patterns such as "statue*"; the first pattern
        that matches counts.
    directional : whether the map also holds from where the light comes, as spherical harmonics of order 1
        (`Lightmap.harmonics`), for viewers that have normal maps.
    sides : "auto" gives both sides of two-sided sheets their own texels, but only the outside of solids; "front" shows
        the light of the front on both sides; "both" gives each side of every two-sided surface its own texels.
    samples : number of samples of the lights per texel, and of paths per texel with `Path`; they are divided among the
        points of the texel.
    supersampling : number of points along the side of a texel, 1..8. With 2, a texel holds the mean of four points.
    max_error : wanted relative error of the indirect light, if `what` is None, a class or a name.
    max_depth : greatest number of edges of a path: 2 is direct light, −1 sets no limit.
    gutter : width in texels of the border around each chart, 2..64: 2, or 2ⁿ for n smaller levels of a mip map.
    max_size : largest width and height of a page of the map in texels, 16..16384. Charts that do not fit on one page go on
        several.
    charts_timeout : seconds after which xatlas is stopped and each flat piece of a surface becomes a chart; 0 does not
        use xatlas.

    Raises
    ------
    EclatError : the scene has no surfaces, the map would take too many pages, no mesh matches a pattern, an argument is out
        of range, or Open Image Denoise is to be used and is not installed.

    Examples
    --------
    >>> import eclat
    >>> scene = eclat.load("furnace")  # closed: irradiance is 2π everywhere
    >>> lightmap = eclat.bake(scene, texel_size=0.2, samples=16)
    >>> lightmap.save("room_lit.glb")  # doctest: +SKIP
    """
    checked_component(component)
    scene, started = staged(scene), clock.perf_counter()
    checked_seed(seed), thread_count(threads), checked_samples(samples), checked_max_depth(max_depth)
    check_map(denoise, sides, supersampling, gutter, max_size)
    source = as_method(what, IrradianceCache(max_error=checked_max_error(max_error)), max_error=max_error)
    source.require_match(scene, max_depth)
    wishes = Wishes(texel_size, texel_sizes or {}, sides, Packing(gutter, max_size, charts_timeout))
    layout = lay_out(scene, wishes, threads, progress)
    settings = Settings(component, samples, max_depth, seed, threads, progress)
    points = sample_points(layout.corners, layout.texels, supersampling)
    free = visible_points(scene, layout.solid, points, settings)
    dark = dark_texels(scene, groups_of(layout), points, free, settings)
    lit = free & ~dark.mask[:, None]
    if denoise:
        charts, shape = layout.corners.charts[layout.texels.triangles], (layout.atlas.stack_height, layout.atlas.width)
        gathered = gather_denoised(scene, source, points, lit, settings, layout.texels, charts, shape)
    else:
        gathered = gather(scene, source, points, lit, settings)
    _warn_of_doubt(gathered)
    harmonics = gather_harmonics(scene, gathered, points, lit, settings) if directional else None
    gathered = with_dark(gathered, dark, points, free)
    stage(progress, "fit")
    return Lightmap(
        scene=scene,
        parts=layout.parts(),
        irradiance=fitted_pages(layout, gathered, gathered.values, gutter, least=0.0),
        harmonics=None if harmonics is None else fitted_harmonics(layout, gathered, harmonics, gutter),
        page_count=layout.atlas.pages,
        used=layout.used(gathered.seen),
        apart=layout.apart,
        texel_size=layout.texel_size,
        component=component,
        method=source.options.name,
        gutter=gutter,
        statistics=_statistics(layout, gathered, dark) | {"seconds": clock.perf_counter() - started},
        settings=asdict(source.options)
        | {"samples": samples, "supersampling": supersampling, "max_depth": max_depth, "seed": seed}
        | {"charts": layout.atlas.method, "sides": sides, "denoise": denoise, "texel_sizes": dict(wishes.texel_sizes)},
    )


def _warn_of_doubt(gathered: GatheredTexels) -> None:
    if doubt := chance_warning(gathered.counts):
        warn(f"bake: {doubt}")


def check_map(denoise: bool, sides: str, supersampling: int, gutter: int, max_size: int) -> None:
    """Raise EclatError for options of light maps that are out of range."""
    if denoise:
        require_denoiser()
    if sides not in get_args(SidesChoice):
        known = get_args(SidesChoice)
        raise EclatError(f"sides must be one of {', '.join(known)}, got {sides!r}{did_you_mean(str(sides), known)}")
    if not 1 <= supersampling <= 8:
        raise EclatError(f"supersampling must be between 1 and 8, got {supersampling}")
    if not 2 <= gutter <= 64:
        raise EclatError(f"gutter must be between 2 and 64 texels, got {gutter}")
    if not 16 <= max_size <= LARGEST_SIZE:
        raise EclatError(f"max_size must be between 16 and {LARGEST_SIZE} texels, got {max_size}")


def _statistics(layout: Layout, gathered: GatheredTexels, dark: Dark) -> dict[str, float]:
    numbers = {
        "texels": len(layout.texels),
        "buried": int((~gathered.seen).sum()),
        "dark": int(dark.mask.sum()),
        "charts": layout.charts,
        "pages": layout.atlas.pages,
        "area": layout.area,
    }
    return {name: float(number) for name, number in numbers.items()} | gathered.counts
