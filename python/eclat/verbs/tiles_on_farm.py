# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Samples of a picture that other processes and machines take, tile by tile.

A range is a row of tiles with the sums of the samples before, to which the worker adds the next ones in the order of their
index. Its sums replace those here, so that the bits are those of one process.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.bridge.running import ProgressReport, run
from eclat.farm.farm import Farm, share_of
from eclat.farm.worker import Bench
from eclat.methods import Prepared
from eclat.methods.work import View, Work
from eclat.sampling.adaptive_sampling import Counts
from eclat.sampling.halves import Region
from eclat.scene import Scene
from eclat.verbs.picture import SampleTaker

TILE = 32
"""The side of a tile in pixels, `tile_size` of `core/render/render.cpp`. Ranges are cut where tiles are, so that the same paths
are traced together as in one process."""

RANGES_OF_THREAD = 4
"""The number of ranges for each thread of a worker. Tiles take unequal time, and the last range decides how long a pass takes;
more ranges would cost more for what travels."""


@dataclass(eq=False)
class Tiles:
    """What all ranges of a picture share, which travels once."""

    scene: Scene
    prepared: Prepared
    view: View
    work: Work
    region: Region
    filter: str
    seeds: tuple[int, ...]
    """The seed of each film of the picture."""
    taker: SampleTaker | None = field(default=None, repr=False)
    """Made by workers when they take their first samples."""

    def __getstate__(self) -> dict[str, object]:
        return self.__dict__ | {"taker": None, "work": replace(self.work, progress=None, threads=0)}

    def taken_by(self, bench: Bench) -> SampleTaker:
        """Return what takes samples, with the estimator of all ranges."""
        if self.taker is None:
            work = replace(self.work, threads=bench.threads)
            self.taker = SampleTaker(
                self.scene, self.prepared, self.view, work, [_core.Film(1, 1) for _ in self.seeds], []
            )
        return self.taker


@dataclass(frozen=True, eq=False)
class TileRange:
    """A rectangle of tiles of a film, and the samples that its pixels take."""

    film: int
    rectangle: Region
    first: Counts
    end: Counts
    """One number of samples for all pixels, or one for each pixel of the rectangle, row by row."""
    sums: NDArray[np.float32] | None
    """What the film has so far; None if it is empty."""


@dataclass(frozen=True, eq=False)
class TakenTiles:
    """The sums of a rectangle after its samples, and those samples that were not finite."""

    sums: NDArray[np.float32]
    bad_count: int
    bad_samples: list[tuple[int, int, int]]
    rays: int


class TakerOnFarm:
    """Adds samples to films, as `SampleTaker` does, by the workers of a farm."""

    def __init__(self, farm: Farm, tiles: Tiles, films: list[_core.Film]) -> None:
        self._farm, self._tiles, self._films = farm, tiles, films

    def samples(self, first: Counts, end: Counts, report: ProgressReport | None) -> float:
        """Take samples [first, end) of each pixel of each film, which may differ between pixels; return the number of rays."""
        rectangles = _rectangles(self._tiles, RANGES_OF_THREAD * self._farm.workers.threads() // len(self._films))
        empty = not first.any()
        items = []
        for number, film in enumerate(self._films):
            for rectangle in rectangles:
                sums = None if empty else np.asarray(film.sums_within(rectangle))
                begins, ends = self._within(first, rectangle), self._within(end, rectangle)
                items.append(TileRange(number, rectangle, begins, ends, sums))
        rays = 0
        for index, taken in self._farm.each(take_tiles, self._tiles, items, share_of(report, "render")):
            film, (x0, y0, _, _) = self._films[items[index].film], items[index].rectangle
            film.restore_within(taken.sums, x0, y0)
            film.add_bad(taken.bad_count, taken.bad_samples)
            rays += taken.rays
        return float(rays)

    def _within(self, counts: Counts, rectangle: Region) -> Counts:
        if counts.size == 1:
            return counts
        width, height = self._tiles.view.size
        x0, y0, x1, y1 = rectangle
        return np.ascontiguousarray(counts.reshape(height, width)[y0:y1, x0:x1]).ravel()


def take_tiles(tiles: Tiles, item: TileRange, bench: Bench) -> TakenTiles:
    """Take the samples of a range on a worker."""
    x0, y0, x1, y1 = item.rectangle
    film = _core.Film(x1 - x0, y1 - y0, x0, y0)
    if item.sums is not None:
        film.restore(item.sums)
    crop = tuple(f(a, b) for f, a, b in zip((max, max, min, min), item.rectangle, tiles.region, strict=True))
    pixels = _core.RenderRange(
        crop=crop, seed=tiles.seeds[item.film], threads=bench.threads, filter=_core.Filter[tiles.filter], tile_order=[]
    )
    first, end = (_spread(counts, item.rectangle, tiles.view.size) for counts in (item.first, item.end))
    taker, counted = tiles.taken_by(bench), _core.Progress()
    run("render", lambda p: taker.take_into(film, item.film, pixels, (first, end), p), bench.progress, counted)
    return TakenTiles(np.asarray(film.sums()), int(film.bad_count), list(film.bad_samples), int(counted.rays))


def _spread(counts: Counts, rectangle: Region, size: tuple[int, int]) -> Counts:
    """Return the numbers of samples of the pixels of the whole picture, of which the rectangle has some."""
    if counts.size == 1:
        return counts
    x0, y0, x1, y1 = rectangle
    whole = np.zeros((size[1], size[0]), np.uint32)
    whole[y0:y1, x0:x1] = counts.reshape(y1 - y0, x1 - x0)
    return whole.ravel()


def _rectangles(tiles: Tiles, wanted: int) -> list[Region]:
    """Cut the tiles of the picture's region into about `wanted` rectangles, each in one row of tiles."""
    x0, y0, x1, y1 = tiles.region
    width, height = tiles.view.size
    rows = range(y0 // TILE * TILE, y1, TILE)
    columns = -(-x1 // TILE) - x0 // TILE
    parts = min(columns, max(1, -(-wanted // len(rows))))
    cuts = [(x0 // TILE + columns * k // parts) * TILE for k in range(parts + 1)]
    return [
        (left, y, min(right, width), min(y + TILE, height)) for y in rows for left, right in itertools.pairwise(cuts)
    ]
