# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb bake: light maps, which hold the irradiance of all surfaces for viewers that compute none."""

from __future__ import annotations

import time as clock
from dataclasses import asdict, is_dataclass, replace
from typing import Any, get_args

import numpy as np

from eclat.arguments import checked_max_depth, checked_samples, checked_seed, thread_count
from eclat.errors import EclatError, did_you_mean
from eclat.gltf_export import Part, parts_of
from eclat.gltf_export.geometry import select_vertices, with_flat_normals
from eclat.lightmap.atlas import Atlas, areas, check_texel_count, default_texel_size, unwrap
from eclat.lightmap.gutters import dilate
from eclat.lightmap.lightmap import Lightmap
from eclat.lightmap.texels import Texels, corners_of, rasterize
from eclat.options import METHODS, IrradianceCache, Options
from eclat.photons import Photons
from eclat.point_irradiance import Component, irradiance
from eclat.radiosity import RadiositySolution
from eclat.running import ProgressReport
from eclat.scene import FloatArray, Scene
from eclat.solution import Solution

SAMPLES = 256
"""Of the lights, per texel."""

MAX_SIZE = 4096
"""Width and height that every WebGL 2 device takes."""

LARGEST_SIZE = 16384


def bake(
    scene: Scene,
    what: Solution | Photons | RadiositySolution | Options | None = None,
    *,
    component: Component = "total",
    texel_size: float | None = None,
    samples: int = SAMPLES,
    max_error: float = 0.01,
    max_depth: int = -1,
    gutter: int = 2,
    max_size: int = MAX_SIZE,
    charts_timeout: float = 60.0,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> Lightmap:
    """The light map of `scene`: irradiance on all its surfaces, one texel beside the other.

    Parameters
    ----------
    what : how light is computed, as for `eclat.irradiance`; irradiance caching where None.
    component : "total", or "direct" or "indirect" light alone. With "indirect" the saved file keeps its lights, and a
        viewer adds their light itself.
    texel_size : metres a texel; where None such that the map has about a quarter of a million texels.
    samples : of the lights, and paths of `Path`, per texel.
    max_error : relative error of indirect light that None aims at.
    gutter : texels between charts beyond those that bilinear filtering reads: 2, or 2ⁿ for viewers that read n levels
        of a mip map.
    max_size : largest width and height of the map in texels.
    charts_timeout : seconds after which xatlas is given up and flat pieces of surfaces become charts; 0 does not try it.

    Raises
    ------
    EclatError : a scene without surfaces, a map larger than `max_size`, arguments out of range; before work starts.

    Examples
    --------
    >>> import eclat
    >>> scene = eclat.load("furnace")  # closed: irradiance is 2π everywhere
    >>> lightmap = eclat.bake(scene, texel_size=0.2, samples=16)
    >>> lightmap.save("room_lit.glb")  # doctest: +SKIP
    """
    if component not in get_args(Component):
        known = get_args(Component)
        raise EclatError(
            f"component must be one of {', '.join(known)}, got {component!r}{did_you_mean(str(component), known)}"
        )
    checked_seed(seed), thread_count(threads), checked_samples(samples), checked_max_depth(max_depth)
    if not 2 <= gutter <= 64:
        raise EclatError(f"gutter must be between 2 and 64 texels, got {gutter}")
    if not 16 <= max_size <= LARGEST_SIZE:
        raise EclatError(f"max_size must be between 16 and {LARGEST_SIZE} texels, got {max_size}")
    started = clock.perf_counter()
    parts = _parts(scene)
    area = float(sum(areas(part.mesh).sum() for part in parts))
    if not area > 0:
        raise EclatError(f"{scene.name or 'the scene'}: has no surfaces to bake light on")
    size = default_texel_size(area) if texel_size is None else texel_size
    check_texel_count(area, size, max_size)
    meshes = [part.mesh for part in parts]
    atlas = unwrap(meshes, size, gutter=gutter, max_size=max_size, timeout=charts_timeout, progress=progress)
    corners = corners_of(meshes, atlas)
    texels = rasterize(corners, atlas.width, atlas.height)
    method = IrradianceCache(max_error=max_error) if what is None else what
    statistics: dict[str, float] = {}
    values = irradiance(
        scene,
        texels.positions,
        texels.normals,
        method,
        component=component,
        max_error=max_error,
        samples=samples,
        max_depth=max_depth,
        seed=seed,
        threads=threads,
        progress=progress,
        statistics=statistics,
    )
    image, _ = dilate(*_image(texels, values, atlas), rings=gutter + 1)
    statistics = {
        "texels": float(len(texels)),
        "rays": statistics["rays"],
        "seconds": clock.perf_counter() - started,
        "area": area,
        "charts": float(len(np.unique(corners.charts[corners.charts >= 0]))),
    }
    return Lightmap(
        scene=scene,
        parts=_split(parts, atlas),
        irradiance=image.astype(np.float32),
        texel_size=size,
        component=component,
        method=_name_of(method),
        gutter=gutter,
        statistics=statistics,
        settings=_settings_of(method)
        | {"samples": samples, "max_depth": max_depth, "seed": seed, "charts": atlas.method},
    )


def _parts(scene: Scene) -> list[Part]:
    """The sides of meshes that get texels, with normals at all vertices."""
    return [replace(part, mesh=with_flat_normals(part.mesh)) for part in parts_of(scene)]


def _image(texels: Texels, values: FloatArray, atlas: Atlas) -> tuple[FloatArray, np.ndarray]:
    image = np.zeros((atlas.height, atlas.width, 3))
    known = np.zeros((atlas.height, atlas.width), bool)
    image[texels.rows, texels.columns] = values
    known[texels.rows, texels.columns] = True
    return image, known


def _split(parts: list[Part], atlas: Atlas) -> tuple[Part, ...]:
    """The parts with a vertex for each chart it belongs to, and its place in the map, (0, 0) to (1, 1)."""
    size = np.array([atlas.width, atlas.height], np.float64)
    return tuple(
        replace(
            part,
            mesh=select_vertices(part.mesh, unwrapped.vertices, unwrapped.triangles),
            lightmap_uvs=unwrapped.uvs / size,
        )
        for part, unwrapped in zip(parts, atlas.meshes, strict=True)
    )


def _name_of(method: object) -> str:
    if isinstance(method, Photons):
        return "photon-map"
    if isinstance(method, RadiositySolution):
        return "radiosity"
    options = method.options if isinstance(method, Solution) else method
    return next(name for name, cls in METHODS.items() if type(options) is cls)


def _settings_of(method: object) -> dict[str, Any]:
    options = getattr(method, "options", method)
    return asdict(options) if is_dataclass(options) and not isinstance(options, type) else {}
