# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The layout of a light map: what gets texels, how large they are, on which pages they lie, and which points of the scene they
stand for. All of this is known before any light is computed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from numbers import Real

import numpy as np

from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError, did_you_mean, shown, warn
from eclat.gltf_export import Part
from eclat.gltf_export.geometry import select_vertices
from eclat.lightmap.atlas import (
    TYPICAL_TEXELS,
    Atlas,
    Packing,
    areas,
    check_texel_count,
    default_texel_size,
    rounded_size,
    unwrap,
)
from eclat.lightmap.levels import most_levels
from eclat.lightmap.sides import Side, SidesChoice, lit_sides
from eclat.lightmap.solids import Mask, solid_triangles
from eclat.lightmap.stages import stage
from eclat.lightmap.texels import Corners, Texels, corners_of, rasterize
from eclat.scene import FloatArray, Mesh, Scene

LEAST_BLACK_ROWS = 3
"""Least number of rows below the charts of a page, without which the texel that all dark surfaces share is not black."""

LARGEST_BLACK_SHARE = 1 / 8
"""Largest share of the rows of a page of the largest size that are black, unless there are only `LEAST_BLACK_ROWS`."""


@dataclass(frozen=True)
class Wishes:
    """What the caller asks of the layout.

    `texel_size` is the side of a texel in metres, or None for a size at which all surfaces take about a quarter of a
    million texels; `usual_size` is that size once it is known better than from the area. `texel_sizes` gives other sizes to
    the meshes whose names match its keys, which are shell patterns; the first that matches counts. `sides` says which sides
    get texels, and `packing` how charts are placed.
    """

    texel_size: float | None = None
    texel_sizes: Mapping[str, float] = field(default_factory=dict)
    sides: SidesChoice = "auto"
    packing: Packing = field(default_factory=Packing)
    usual_size: float | None = None


@dataclass(frozen=True, eq=False)
class Layout:
    """The layout of a light map.

    `solid` marks the triangles of each mesh that bound solids. `sides` are the parts with a mask of what gets texels, of
    the charts of the same index in `atlas`. `corners` are those of the lit triangles, and `texels` what they use. `area` is
    that of the lit surfaces in m². `texel_size` is the usual side of a texel in metres. `page_shape` is the height and width of
    a page in texels, with the black rows below its charts.
    """

    solid: list[Mask]
    sides: list[Side]
    atlas: Atlas
    corners: Corners
    texels: Texels
    area: float
    texel_size: float
    page_shape: tuple[int, int]

    @property
    def charts(self) -> int:
        """Number of charts."""
        return len(np.unique(self.corners.charts[self.corners.charts >= 0]))

    @property
    def black_rows(self) -> int:
        """Number of rows below the charts of each page. The upper third separates charts from black, and dark surfaces look up
        the border between the other two."""
        return self.page_shape[0] - self.atlas.height

    @property
    def apart(self) -> float:
        """Number of texels between those whose light a lookup must not mix."""
        return min(self.atlas.gap, self.black_rows / 3)

    def pages(self, stack: FloatArray) -> FloatArray:
        """Cut the stack (H, W, C) into pages with black rows, and place them one below the other, (pages · height, W, C)."""
        wider = [(0, 0)] * (stack.ndim - 2)
        padding = ((0, self.black_rows), (0, self.page_shape[1] - self.atlas.width), *wider)
        return np.concatenate([np.pad(stack[self.atlas.page_rows(page)], padding) for page in range(self.atlas.pages)])

    def used(self, seen: Mask) -> Mask:
        """Mark the texels of all pages, (pages · height, W), that surfaces use: those of the texels that are `seen` (N,), and
        the black ones that dark surfaces look up."""
        stack = np.zeros((self.atlas.stack_height, self.atlas.width))
        stack[self.texels.rows[seen], self.texels.columns[seen]] = 1
        marked = self.pages(stack) > 0
        height, _ = self.page_shape
        from_bottom = height - np.arange(len(marked)) % height
        marked[from_bottom <= 2 * self.black_rows / 3] = True
        return np.asarray(marked)

    def parts(self) -> tuple[Part, ...]:
        """Make the parts, with vertices split at the borders of charts, and with light map coordinates in (0, 0)..(1, 1) of
        their page. A mesh whose charts lie on several pages becomes one part a page."""
        found: list[Part] = []
        for side, unwrapped in zip(self.sides, self.atlas.meshes, strict=True):
            found += self._parts_of(
                side, unwrapped.vertices, unwrapped.triangles, unwrapped.uvs, unwrapped.page_of_vertices()
            )
        return tuple(found)

    def _parts_of(
        self, side: Side, vertices: np.ndarray, lit: np.ndarray, uvs: FloatArray, pages: np.ndarray
    ) -> list[Part]:
        """Make the parts of one side. All its dark triangles go to the page of its first chart."""
        height, width = self.page_shape
        mesh = side.part.mesh
        dark = np.asarray(mesh.triangles)[~side.lit]
        corners, renumbered = np.unique(dark, return_inverse=True)
        triangles = np.empty((len(side.lit), 3), np.int64)
        triangles[side.lit] = lit
        triangles[~side.lit] = renumbered.reshape(-1, 3) + len(vertices)
        black = np.broadcast_to(np.array([1.5, height - self.black_rows / 3]), (len(corners), 2))
        places = np.concatenate((uvs, black)) / (width, height)
        whole = select_vertices(mesh, np.concatenate((vertices, corners)), triangles)
        first = int(pages[lit[0, 0]]) if len(lit) else 0
        page_of = np.full(len(triangles), first)
        page_of[side.lit] = pages[lit[:, 0]]
        used = np.unique(page_of)
        if len(used) == 1:
            return [replace(side.part, mesh=whole, lightmap_uvs=places, lightmap_page=first)]
        parts = []
        for page in used:
            mine = triangles[page_of == page]
            kept, own = np.unique(mine, return_inverse=True)
            piece = select_vertices(whole, kept, own.reshape(-1, 3))
            parts.append(replace(side.part, mesh=piece, lightmap_uvs=places[kept], lightmap_page=int(page)))
        return parts


MOST_OF_TYPICAL = 1.2
"""Number of texels, relative to `TYPICAL_TEXELS`, up to which a default texel size is kept."""

SIZE_ATTEMPTS = 3
"""Number of layouts after which a default texel size is kept in any case."""


def lay_out(scene: Scene, wishes: Wishes, threads: int | None, progress: ProgressReport | None) -> Layout:
    """Lay out the light map of a staged scene.

    Raises
    ------
    EclatError : the scene has no surfaces, a pattern matches no mesh, or the map would take too many pages.
    """
    told = stage(progress, "surfaces")
    solid = solid_triangles(scene, scene.meshes)
    sides = lit_sides(scene, wishes.sides, solid, threads, told)
    lit_areas = _lit_areas(scene, sides)
    for attempt in range(SIZE_ATTEMPTS):
        size, sizes = _texel_sizes(scene, sides, wishes, lit_areas)
        layout = _placed(solid, sides, lit_areas, size, sizes, wishes, progress)
        excess = len(layout.texels) / TYPICAL_TEXELS
        if wishes.texel_size is not None or excess <= MOST_OF_TYPICAL or attempt == SIZE_ATTEMPTS - 1:
            break
        # The area alone gives too small a size where many charts have many border texels.
        wishes = replace(wishes, usual_size=rounded_size(size * math.sqrt(excess)))
    return layout


def _placed(
    solid: list[Mask],
    sides: list[Side],
    lit_areas: FloatArray,
    size: float,
    sizes: FloatArray,
    wishes: Wishes,
    progress: ProgressReport | None,
) -> Layout:
    """Place the charts of all sides at the usual texel `size`, with `sizes` of each side, and find their texels."""
    apart, largest = wishes.packing.apart, wishes.packing.max_size
    black_rows = max(LEAST_BLACK_ROWS, min(3 * apart, int(largest * LARGEST_BLACK_SHARE)))
    unit = 2 ** most_levels(min(apart, black_rows / 3))  # Two divides the sizes of a page as often as it has levels.
    packing = replace(wishes.packing, max_size=largest - largest % unit - black_rows)
    check_texel_count(float((lit_areas / sizes**2).sum()), packing.max_size, size)
    meshes = [replace(side.part.mesh, triangles=np.asarray(side.part.mesh.triangles)[side.lit]) for side in sides]
    # Charts are made at one size: a mesh with larger texels is made smaller for it.
    scaled = [_scaled(mesh, size / own) for mesh, own in zip(meshes, sizes, strict=True)]
    atlas = unwrap(scaled, size, packing, progress)
    stage(progress, "texels")
    corners = corners_of(meshes, atlas)
    texels = rasterize(corners, atlas.width, atlas.stack_height)
    height, width = (-(-number // unit) * unit for number in (atlas.height + black_rows, atlas.width))
    return Layout(solid, sides, atlas, corners, texels, float(lit_areas.sum()), size, (height, width))


def _scaled(mesh: Mesh, factor: float) -> Mesh:
    return mesh if factor == 1 else replace(mesh, positions=np.asarray(mesh.positions, np.float64) * factor)


def _lit_areas(scene: Scene, sides: list[Side]) -> FloatArray:
    """Compute the areas in m² of what gets texels of each side. Raises EclatError if there are no surfaces; warns if there are
    normal maps."""
    if not sum(areas(side.part.mesh).sum() for side in sides) > 0:
        raise EclatError(f"bake: {scene.name or 'the scene'} has no surfaces, so there is nothing to bake")
    if any(mesh.material.normal_map is not None for mesh in scene.meshes):
        warn("bake: the light map ignores normal maps; its irradiance is that of the surfaces without them")
    return np.array([areas(side.part.mesh)[side.lit].sum() for side in sides])


def _texel_sizes(scene: Scene, sides: list[Side], wishes: Wishes, lit_areas: FloatArray) -> tuple[float, FloatArray]:
    """Return the usual size of texels, and that of each side. The default size counts only surfaces without one of their
    own."""
    names = [mesh.name for mesh in scene.meshes]
    for pattern, size in wishes.texel_sizes.items():
        if not isinstance(pattern, str):
            raise EclatError(
                f"texel_sizes: expected names of meshes with sizes in metres, got the name {shown(pattern)}"
            )
        if not (isinstance(size, Real) and np.isfinite(size) and size > 0):
            raise EclatError(f"texel_sizes: expected a finite number of metres above 0 for {pattern!r}, got {size}")
        if not any(fnmatchcase(name, pattern) for name in names):
            raise EclatError(
                f"texel_sizes: no mesh has a name that matches {pattern!r}{did_you_mean(pattern, names)}; "
                "`eclat info` lists the names"
            )
    own = [
        next((size for pattern, size in wishes.texel_sizes.items() if fnmatchcase(side.part.mesh.name, pattern)), None)
        for side in sides
    ]
    usual = wishes.usual_size if wishes.texel_size is None else wishes.texel_size
    if usual is None:
        free = np.array([size is None for size in own])
        usual = default_texel_size(float(lit_areas[free].sum() if free.any() else lit_areas.sum()))
    if not (np.isfinite(usual) and usual > 0):
        raise EclatError(f"texel_size must be a finite number of metres above 0, got {usual}")
    return usual, np.array([usual if size is None else size for size in own])
