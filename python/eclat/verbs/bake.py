# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `bake`, which computes light maps: images of the irradiance on all surfaces, for viewers that cannot compute
it."""

from __future__ import annotations

import os
import time as clock
from dataclasses import asdict, replace
from typing import get_args

import numpy as np

from eclat.bridge.arguments import checked_max_depth, checked_max_error, checked_samples, checked_seed, thread_count
from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError, did_you_mean, warn
from eclat.gltf_export import Part
from eclat.gltf_export.geometry import select_vertices
from eclat.images.denoiser import require_denoiser
from eclat.lightmap.atlas import Atlas, areas, check_texel_count, default_texel_size, unwrap
from eclat.lightmap.denoising import gather_denoised
from eclat.lightmap.fit import bilinear, differences, fit
from eclat.lightmap.gathering import GatheredTexels, Settings, gather, sample_points, visible_points
from eclat.lightmap.gutters import dilate
from eclat.lightmap.lightmap import Lightmap
from eclat.lightmap.seams import seam_samples
from eclat.lightmap.sides import Side, SidesChoice, lit_sides
from eclat.lightmap.solids import solid_triangles
from eclat.lightmap.texels import Corners, Texels, corners_of, rasterize
from eclat.methods import IrradianceCache, Method, Source, as_method
from eclat.scene import FloatArray, Scene
from eclat.stage.staging import staged
from eclat.typed import typed
from eclat.verbs.irradiance import Component, checked_component

SAMPLES = 256
"""Default number of samples of the lights per texel."""

MAX_SIZE = 4096
"""Default largest width and height in texels, which most WebGL 2 devices support."""

LARGEST_SIZE = 16384
"""Upper limit of `max_size` in texels."""

BLACK_ROWS = 3
"""Number of black rows below the charts, which hold the texel that all dark surfaces share."""


@typed
def bake(
    scene: Scene | str | os.PathLike[str],
    what: Source | type[Method] | str | None = None,
    *,
    denoise: bool = False,
    component: Component = "total",
    texel_size: float | None = None,
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
    texel_size : side of a texel in metres. None chooses it so that the map has about a quarter of a million texels.
    sides : "auto" gives both sides of two-sided sheets their own texels, but only the outside of solids; "front" shows
        the light of the front on both sides; "both" gives each side of every two-sided surface its own texels.
    samples : number of samples of the lights per texel, and of paths per texel with `Path`; they are divided among the
        points of the texel.
    supersampling : number of points along the side of a texel, 1..8. With 2, a texel holds the mean of four points.
    max_error : wanted relative error of the indirect light, if `what` is None, a class or a name.
    max_depth : greatest number of edges of a path: 2 is direct light, −1 sets no limit.
    gutter : number of texels between charts, in addition to those that bilinear filtering reads, 2..64: 2, or 2ⁿ for
        viewers that use n levels of a mip map.
    max_size : largest width and height of the map in texels, 16..16384.
    charts_timeout : seconds after which xatlas is stopped and each flat piece of a surface becomes a chart; 0 does not
        use xatlas.

    Raises
    ------
    EclatError : the scene has no surfaces, the map would be larger than `max_size`, or an argument is out of range,
        or Open Image Denoise is to be used and is not installed.

    Examples
    --------
    >>> import eclat
    >>> scene = eclat.load("furnace")  # closed: irradiance is 2π everywhere
    >>> lightmap = eclat.bake(scene, texel_size=0.2, samples=16)
    >>> lightmap.save("room_lit.glb")  # doctest: +SKIP
    """
    checked_component(component)
    scene = staged(scene)
    checked_seed(seed), thread_count(threads), checked_samples(samples), checked_max_depth(max_depth)
    _check_map(denoise, sides, supersampling, gutter, max_size)
    source = as_method(what, IrradianceCache(max_error=checked_max_error(max_error)), max_error=max_error)
    source.require_match(scene, max_depth)
    started = clock.perf_counter()
    solid = solid_triangles(scene, scene.meshes)
    lit = lit_sides(scene, sides, solid, threads)
    area = _lit_area(scene, lit)
    size = default_texel_size(area) if texel_size is None else texel_size
    check_texel_count(area, size, max_size)
    meshes = [replace(side.part.mesh, triangles=np.asarray(side.part.mesh.triangles)[side.lit]) for side in lit]
    atlas = unwrap(meshes, size, gutter=gutter, max_size=max_size, timeout=charts_timeout, progress=progress)
    corners = corners_of(meshes, atlas)
    texels = rasterize(corners, atlas.width, atlas.height)
    settings = Settings(component, samples, max_depth, seed, threads, progress)
    points = sample_points(corners, texels, supersampling)
    free = visible_points(scene, solid, points, settings)
    if denoise:
        charts, shape = corners.charts[texels.triangles], (atlas.height, atlas.width)
        gathered = gather_denoised(scene, source, points, free, settings, texels, charts, shape)
    else:
        gathered = gather(scene, source, points, free, settings)
    image = _image(texels, corners, atlas, gathered, gutter)
    # All dark surfaces share one black texel; filtering also reads the texels around it.
    image = np.concatenate((image, np.zeros((BLACK_ROWS, atlas.width, 3))))
    return Lightmap(
        scene=scene,
        parts=_parts(lit, atlas, (atlas.width, atlas.height + BLACK_ROWS)),
        irradiance=image.astype(np.float32),
        texel_size=size,
        component=component,
        method=source.options.name,
        gutter=gutter,
        statistics=_statistics(texels, corners, gathered) | {"area": area, "seconds": clock.perf_counter() - started},
        settings=asdict(source.options)
        | {"samples": samples, "supersampling": supersampling, "max_depth": max_depth, "seed": seed}
        | {"charts": atlas.method, "sides": sides, "denoise": denoise},
    )


def _check_map(denoise: bool, sides: str, supersampling: int, gutter: int, max_size: int) -> None:
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


def _statistics(texels: Texels, corners: Corners, gathered: GatheredTexels) -> dict[str, float]:
    charts = len(np.unique(corners.charts[corners.charts >= 0]))
    numbers = {"texels": len(texels), "buried": int((~gathered.seen).sum()), "charts": charts}
    return {name: float(number) for name, number in numbers.items()} | gathered.counts


def _lit_area(scene: Scene, lit: list[Side]) -> float:
    """Compute the area in m² of the surfaces that get texels. Raises EclatError if there are no surfaces; warns if
    there are normal maps."""
    if not sum(areas(side.part.mesh).sum() for side in lit) > 0:
        raise EclatError(f"bake: {scene.name or 'the scene'} has no surfaces, so there is nothing to bake")
    if any(mesh.material.normal_map is not None for mesh in scene.meshes):
        warn("bake: the light map ignores normal maps; its irradiance is that of the surfaces without them")
    return float(sum(areas(side.part.mesh)[side.lit].sum() for side in lit))


def _image(texels: Texels, corners: Corners, atlas: Atlas, gathered: GatheredTexels, gutter: int) -> FloatArray:
    """Fit the irradiance of the map, (H, W, 3). Texels that no viewer can see take the mean of their neighbours."""
    seen = gathered.seen
    numbers = np.full((atlas.height, atlas.width), -1, np.int64)
    numbers[texels.rows[seen], texels.columns[seen]] = np.arange(int(seen.sum()))
    a, b = (bilinear(numbers, ends) for ends in seam_samples(corners))
    fitted = fit(gathered.values[seen], bilinear(numbers, gathered.places[seen]), differences(a, b))
    image: FloatArray = np.zeros((atlas.height, atlas.width, 3))
    image[texels.rows[seen], texels.columns[seen]] = fitted
    known = numbers >= 0
    hidden = np.zeros_like(known)
    hidden[texels.rows[~seen], texels.columns[~seen]] = True
    image, known = dilate(image, known, gutter + 1, hidden)
    image, _ = dilate(image, known | hidden, gutter + 1)
    return image


def _parts(sides: list[Side], atlas: Atlas, size: tuple[int, int]) -> tuple[Part, ...]:
    """Make the parts, with vertices split at the borders of charts and with light map coordinates in (0, 0)..(1, 1)."""
    black = np.array([1.5, size[1] - BLACK_ROWS / 2])
    found = []
    for side, unwrapped in zip(sides, atlas.meshes, strict=True):
        mesh = side.part.mesh
        dark = np.asarray(mesh.triangles)[~side.lit]
        corners, renumbered = np.unique(dark, return_inverse=True)
        triangles = np.empty((len(side.lit), 3), np.int64)
        triangles[side.lit] = unwrapped.triangles
        triangles[~side.lit] = renumbered.reshape(-1, 3) + len(unwrapped.vertices)
        uvs = np.concatenate((unwrapped.uvs, np.broadcast_to(black, (len(corners), 2)))) / size
        split = select_vertices(mesh, np.concatenate((unwrapped.vertices, corners)), triangles)
        found.append(replace(side.part, mesh=split, lightmap_uvs=uvs))
    return tuple(found)
