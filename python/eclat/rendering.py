# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verbs: solve, render, irradiance."""

from __future__ import annotations

import time as clock
from dataclasses import asdict

import numpy as np

from eclat import _core
from eclat.compiled import MAX_PIXELS, compiled
from eclat.errors import EclatError, warn
from eclat.image import Image
from eclat.options import Direct, IrradianceCache, Options, Path, method_name
from eclat.running import ProgressReport, run
from eclat.scene import Camera, FloatArray, Scene
from eclat.solution import Solution, core_options, solved_from_core

VERSION = "0.1.0"
_FILTERS = ("box", "tent")
_FIRST_PASS, _LARGEST_PASS = 4, 1024


def solve(
    scene: Scene,
    options: IrradianceCache | None = None,
    *,
    camera: int | Camera = 0,
    size: tuple[int, int] | None = None,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> Solution:
    """Compute the irradiance records that a view of the scene needs.

    `size` is (width, height) in pixels; records follow the projected pixels. Same arguments, same bits, whatever
    `threads`. Raises EclatError for bad arguments.
    """
    options = options or IrradianceCache()
    view = _camera(scene, camera)
    started = clock.perf_counter()
    prepared = compiled(scene)
    core_camera = prepared.camera(view, _size(view, size))
    settings = core_options(options, max_depth=max_depth, seed=_seed(seed), threads=_threads(threads))
    caches, done = run(
        "solve", lambda p: _core.solve_irradiance_cache(prepared.core, core_camera, settings, p), progress
    )
    statistics = {
        "records": float(caches.near_count),
        "far_records": float(caches.far_count),
        "rays": float(done.rays),
        "seconds": clock.perf_counter() - started,
    }
    return solved_from_core(scene, options, caches, statistics)


def render(
    scene: Scene,
    what: Solution | Options | None = None,
    *,
    samples: int | None = None,
    max_error: float = 0.01,
    time: float | None = None,
    size: tuple[int, int] | None = None,
    crop: tuple[int, int, int, int] | None = None,
    camera: int | Camera = 0,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    filter: str = "box",
    progress: ProgressReport | None = None,
    tile_order: list[int] | None = None,
) -> Image:
    """A picture of the scene.

    Parameters
    ----------
    what
        A Solution, the options of a method (solved on the fly), or None for irradiance caching.
    samples
        Paths per pixel. None: as many as `max_error` asks for (estimated from the two halves of the samples).
    time
        Stop after about this many seconds instead (the number of samples then depends on the machine).
    size, crop
        (width, height), and (x0, y0, x1, y1) in pixels, exclusive; the rest of the picture stays black.
    max_depth
        Edges of a path: 1 emission, 2 direct light, −1 unlimited.
    tile_order
        A permutation in which tiles are worked on; it changes nothing (tests use it to show that).

    Raises EclatError for bad arguments.
    """
    if samples is not None and not 1 <= samples <= 2**24:
        raise EclatError(f"samples must be between 1 and {2**24}, got {samples}")
    if max_depth == 0 or max_depth < -1:
        raise EclatError(f"max_depth must be -1 (unlimited) or at least 1, got {max_depth}")
    if filter not in _FILTERS:
        raise EclatError(f"filter must be one of {', '.join(_FILTERS)}, got {filter!r}")
    started = clock.perf_counter()
    view = _camera(scene, camera)
    width, height = _size(view, size)
    prepared = compiled(scene)
    solution: Solution | None = None
    if what is None:
        what = IrradianceCache(max_error=max_error)
    if isinstance(what, IrradianceCache):
        what = solve(
            scene, what, camera=view, size=(width, height), max_depth=max_depth, seed=seed, threads=threads, progress=progress
        )
    if isinstance(what, Solution):
        solution = what
        solution.check(scene)
        if not np.array_equal(solution.center, prepared.center):
            raise EclatError("this cache was solved for another scene: solve it again")
    if isinstance(what, Direct):
        max_depth = 2 if max_depth < 0 else min(2, max_depth)
    roulette = what.roulette_depth if isinstance(what, Path) else 5
    caches = solution.core() if solution is not None else None
    core_camera = prepared.camera(view, (width, height))
    film = _core.Film(width, height)
    region = _crop(crop, width, height)

    def render_range(first: int, end: int) -> int:
        _, done = run(
            "render",
            lambda p: _core.render_samples(
                prepared.core, core_camera, film, p, max_depth, roulette, caches, (first, end), region,
                _seed(seed), _threads(threads), _FILTERS.index(filter), tile_order or [],
            ),
            progress,
        )  # fmt: skip
        return int(done.rays)

    deadline = None if time is None else started + time
    count, rays = _take_samples(render_range, film, samples, max_error, deadline)
    if film.bad_count:
        x, y, sample = film.bad_samples[0]
        warn(
            f"{film.bad_count} samples were not finite; first at pixel ({x}, {y}), sample {sample}: "
            f"replay with seed={seed}, crop=({x}, {y}, {x + 1}, {y + 1})"
        )
    options = solution.options if solution is not None else what
    assert not isinstance(options, Solution)
    statistics: dict[str, float] = {
        "samples": count,
        "rays": rays + (solution.statistics.get("rays", 0.0) if solution else 0.0),
        "records": float(len(solution)) if solution else 0.0,
        "cache_misses": float(film.cache_misses) if solution else 0.0,
        "seconds": clock.perf_counter() - started,
    }
    metadata = {
        "scene": scene.name, "method": method_name(options), "options": asdict(options), "seed": seed,
        "max_depth": max_depth, "version": VERSION, "statistics": statistics,
    }  # fmt: skip
    radiance, direct = film.radiance, film.direct
    layers = {
        "direct": direct, "indirect": radiance - direct, "albedo": film.albedo, "normal": film.normal, "depth": film.depth,
    }  # fmt: skip
    return Image(radiance, layers, metadata)


def _take_samples(render_range, film, samples, max_error, deadline) -> tuple[int, int]:  # type: ignore[no-untyped-def]
    """Sample until the wanted number, the wanted error or the deadline is reached; returns samples and rays."""
    if samples is not None:
        return samples, render_range(0, samples)
    taken, rays = 0, 0
    while True:
        step = _FIRST_PASS if taken == 0 else taken
        before = clock.perf_counter()
        rays += render_range(taken, taken + step)
        spent = clock.perf_counter() - before
        taken += step
        if deadline is not None:
            left = deadline - clock.perf_counter()
            if left < spent:
                extra = int(step * left / max(spent, 1e-9))
                if extra > 0:
                    rays += render_range(taken, taken + extra)
                    taken += extra
                return taken, rays
        elif taken >= _LARGEST_PASS or _noise(film) <= max_error:
            return taken, rays


def _noise(film: _core.Film) -> float:
    """Relative error of the mean, from its two halves: they differ by twice the error that their mean has."""
    mean, even = film.radiance, film.even
    return float(np.sqrt(np.mean((even - mean) ** 2 / (mean**2 + 0.01 * np.mean(mean**2) + 1e-30))))


def irradiance(
    scene: Scene,
    points: FloatArray,
    normals: FloatArray,
    what: Options | None = None,
    *,
    component: str = "total",
    samples: int = 1024,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> np.ndarray:
    """Irradiance at `points` on the side of their `normals`, (N, 3) RGB in W·m⁻² (lux where the scene is photometric).

    Each point is gathered by `samples` paths; points need not lie on a surface. `component` is total, direct or
    indirect. Raises EclatError for arrays that do not fit or are not finite.
    """
    if component not in ("total", "direct", "indirect"):
        raise EclatError(f"component must be total, direct or indirect, got {component!r}")
    points = np.atleast_2d(np.asarray(points, np.float64))
    normals = np.atleast_2d(np.asarray(normals, np.float64))
    if points.shape != normals.shape or points.ndim != 2 or points.shape[1] != 3:
        raise EclatError(f"points and normals must both be (N, 3), got {points.shape} and {normals.shape}")
    lengths = np.linalg.norm(normals, axis=1)
    if not (np.isfinite(points).all() and np.isfinite(lengths).all() and (lengths > 0).all()):
        raise EclatError("points and normals must be finite, and normals not zero")
    prepared = compiled(scene)
    result, _ = run(
        "irradiance",
        lambda p: _core.irradiance(
            prepared.core, prepared.to_core(points).tolist(), (normals / lengths[:, None]).tolist(), p,
            2 if isinstance(what, Direct) else max_depth, None, component != "indirect",
            component != "direct" and not isinstance(what, Direct), samples, _seed(seed), _threads(threads),
        ),
        progress,
    )  # fmt: skip
    return np.asarray(result, np.float32).reshape(-1, 3)


def _camera(scene: Scene, camera: int | Camera) -> Camera:
    if isinstance(camera, Camera):
        return camera
    if not 0 <= camera < len(scene.cameras):
        raise EclatError(f"camera {camera} of {len(scene.cameras)}: {scene.name or 'the scene'} has no such camera")
    return scene.cameras[camera]


def _size(camera: Camera, size: tuple[int, int] | None) -> tuple[int, int]:
    width, height = size or camera.size or (1280, 720)
    if not (1 <= width <= 65535 and 1 <= height <= 65535 and width * height <= MAX_PIXELS):
        raise EclatError(f"size must be 1..65535 pixels each way and at most {MAX_PIXELS} in all, got {width}x{height}")
    return int(width), int(height)


def _crop(crop: tuple[int, int, int, int] | None, width: int, height: int) -> tuple[int, int, int, int]:
    if crop is None:
        return (0, 0, width, height)
    x0, y0, x1, y1 = crop
    if not (0 <= x0 < x1 <= width and 0 <= y0 < y1 <= height):
        raise EclatError(f"crop {crop} must lie inside the picture of {width}x{height} pixels")
    return (x0, y0, x1, y1)


def _seed(seed: int) -> int:
    if not 0 <= seed < 2**32:
        raise EclatError(f"seed must be between 0 and {2**32 - 1}, got {seed}")
    return seed


def _threads(threads: int | None) -> int:
    if threads is None:
        return 0
    if not 1 <= threads <= 1024:
        raise EclatError(f"threads must be between 1 and 1024, got {threads}")
    return threads
