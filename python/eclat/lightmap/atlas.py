# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The layout of a light map: every triangle is placed in a chart, and charts do not overlap. xatlas computes the
charts; if it fails, `planar_charts` does. Where one image is too small for all charts, they lie on several pages."""

from __future__ import annotations

import contextlib
import io
import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError, warn
from eclat.lightmap.planar_charts import unwrap_planar
from eclat.scene import FloatArray, Mesh, triangle_areas

XATLAS_PROGRAM = Path(__file__).with_name("xatlas_process.py")
"""The program that computes charts with xatlas in a separate process."""

ATTEMPTS = 3
"""How often xatlas is run as long as a signal ends it. It has crashed on a mesh that it unwraps in other runs, and the charts
must not depend on that."""

TYPICAL_TEXELS = 1 << 18
"""Number of texels on surfaces if the caller gives no texel size; the map then has about 700 × 700 texels."""

TYPICAL_FILL = 0.5
"""Share of the texels of an atlas that charts usually cover, 0..1."""

MAX_LEFT_OUT = 0.5
"""Share of the area, 0..1, up to which xatlas may leave triangles out; above it, all triangles get planar charts."""

MAX_PAGES = 64
"""Largest number of pages of a light map. More are nearly always a mistake in the texel size."""

SIGNIFICANT_DIGITS = 2
"""Number of significant digits of the default texel size, which is rounded so that it is easy to read."""


@dataclass(frozen=True, eq=False)
class Unwrapped:
    """The charts of one mesh in the atlas.

    The charts have V vertices of their own, which are copies of the mesh's vertices with the indices `vertices` (V,); a
    vertex on a cut has one copy for each side of the cut. `triangles` (T, 3) are indices of these copies, in the order
    of the mesh's triangles. `uvs` (V, 2) are positions in texels: (0, 0) is the top left corner of the page, and (0.5,
    0.5) the centre of its first texel. `charts` (V,) are the indices of the vertices' charts, −1 for vertices of
    triangles without area. `pages` (V,) are the pages of the vertices; None means the first.
    """

    vertices: NDArray[np.int64]
    triangles: NDArray[np.int64]
    uvs: FloatArray
    charts: NDArray[np.int64]
    pages: NDArray[np.int64] | None = None

    def page_of_vertices(self) -> NDArray[np.int64]:
        """Return the page of each vertex, (V,); 0 for vertices without a chart."""
        return np.zeros(len(self.vertices), np.int64) if self.pages is None else np.maximum(self.pages, 0)


@dataclass(frozen=True, eq=False)
class Atlas:
    """The charts of all meshes on `pages` images of `width` × `height` texels each. `method` is "xatlas" or "planar".

    While a map is computed, its pages lie in one image, the stack, one below the other, `gap` rows apart, like charts on a
    page, so that nothing that is done with neighbouring texels reaches from one page into another.
    """

    width: int
    height: int
    meshes: tuple[Unwrapped, ...]
    method: str
    pages: int = 1
    gap: int = 0

    @property
    def stack_height(self) -> int:
        """Number of rows of the stack."""
        return self.pages * (self.height + self.gap) - self.gap

    def stacked(self, mesh: Unwrapped) -> FloatArray:
        """Return the coordinates (V, 2) of the vertices of a mesh in the stack, in texels."""
        return mesh.uvs + np.column_stack((np.zeros(len(mesh.uvs)), mesh.page_of_vertices() * (self.height + self.gap)))

    def page_rows(self, page: int) -> slice:
        """Return the rows of the stack that `page` takes."""
        first = page * (self.height + self.gap)
        return slice(first, first + self.height)


NO_CHARTS = Unwrapped(np.zeros(0, np.int64), np.zeros((0, 3), np.int64), np.zeros((0, 2)), np.zeros(0, np.int64))
"""The charts of a mesh without triangles."""


def areas(mesh: Mesh) -> FloatArray:
    """Compute the areas (T,) of the triangles in m²."""
    return triangle_areas(np.asarray(mesh.positions)[np.asarray(mesh.triangles)])


def default_texel_size(area: float) -> float:
    """Return the texel size in metres at which surfaces of `area` m² take about `TYPICAL_TEXELS` texels."""
    if area <= 0:
        return 1.0
    return rounded_size(math.sqrt(area / TYPICAL_TEXELS))


def rounded_size(size: float) -> float:
    """Round a default texel size to `SIGNIFICANT_DIGITS` digits."""
    return float(round(size, SIGNIFICANT_DIGITS - 1 - math.floor(math.log10(size))))


def check_texel_count(texels: float, max_size: int, texel_size: float) -> None:
    """Raise EclatError if charts of that many `texels`, at `texel_size` metres, take more than `MAX_PAGES` pages of
    `max_size` × `max_size` texels."""
    room = MAX_PAGES * max_size * max_size * TYPICAL_FILL
    if texels > room:
        enough = texel_size * math.sqrt(texels / room)
        raise EclatError(
            f"texel_size: the surfaces take {texels:,.0f} texels at {texel_size:g} m per texel, more than {MAX_PAGES} light maps "
            f"of {max_size} x {max_size} hold; a texel size of {enough * 1.05:.2g} m fits"
        )


@dataclass(frozen=True)
class Packing:
    """How charts are placed: a border of `gutter` texels around each, on pages of at most `max_size` × `max_size` texels.
    xatlas is stopped after `timeout` seconds; 0 does not use xatlas."""

    gutter: int = 2
    max_size: int = 4096
    timeout: float = 60.0

    @property
    def apart(self) -> int:
        """Least number of texels between those that two charts use: the borders of both."""
        return 2 * self.gutter


def unwrap(
    meshes: Sequence[Mesh],
    texel_size: float,
    packing: Packing | None = None,
    progress: ProgressReport | None = None,
) -> Atlas:
    """Make an atlas of the meshes, which must have normals, at `texel_size` metres per texel.

    It has one page if all charts fit on one, and otherwise as many pages as they need.

    Raises
    ------
    EclatError : a chart alone is larger than a page, or there are more than `MAX_PAGES` pages.
    """
    packing = packing or Packing()
    found = None
    if packing.timeout > 0 and any(len(mesh.triangles) for mesh in meshes):
        found = _by_xatlas([m for m in meshes if len(m.triangles)], texel_size, packing, progress)
    if found is not None:
        # xatlas refuses meshes without triangles.
        cut = iter(found.meshes)
        found = replace(found, meshes=tuple(next(cut) if len(m.triangles) else NO_CHARTS for m in meshes))
    if found is None:
        planar = unwrap_planar(meshes, texel_size, packing.apart, packing.max_size)
        unwrapped = tuple(Unwrapped(*mesh) for mesh in planar.meshes)
        found = Atlas(planar.width, planar.height, unwrapped, "planar", planar.count)
    if found.pages > MAX_PAGES:
        raise EclatError(
            f"texel_size: at {texel_size:g} m per texel there are {found.pages} pages of {found.width} x {found.height} texels, "
            f"more than {MAX_PAGES}; a texel size of {texel_size * math.sqrt(found.pages / MAX_PAGES) * 1.05:.2g} m fits"
        )
    return replace(found, gap=packing.apart)


def _by_xatlas(
    meshes: Sequence[Mesh], texel_size: float, packing: Packing, progress: ProgressReport | None
) -> Atlas | None:
    """Compute the atlas with xatlas; warn and return None if xatlas fails, takes too long or leaves much out."""
    arrays: dict[str, np.ndarray] = {
        "count": np.array(len(meshes)),
        "texels_per_unit": np.array(1 / texel_size),
        # Bilinear filtering reads one texel around each chart; xatlas itself leaves space for it.
        "padding": np.array(packing.gutter),
        "max_chart_size": np.array(packing.max_size - 2 * packing.gutter - 2),
        "resolution": np.array(0),
    }
    center = np.mean([np.asarray(m.positions, np.float64).mean(axis=0) for m in meshes if len(m.positions)], axis=0)
    for i, mesh in enumerate(meshes):
        assert mesh.normals is not None
        arrays[f"positions{i}"] = np.ascontiguousarray(np.asarray(mesh.positions, np.float64) - center, np.float32)
        arrays[f"normals{i}"] = np.ascontiguousarray(mesh.normals, np.float32)
        arrays[f"triangles{i}"] = np.ascontiguousarray(mesh.triangles, np.uint32)
    output, problem = _run_child(arrays, packing.timeout, progress)
    if output is not None and output["size"].max() > packing.max_size:
        arrays["resolution"] = np.array(packing.max_size)
        output, problem = _run_child(arrays, packing.timeout, progress)
    if output is None:
        warn(
            f"light map: xatlas {problem}; each flat piece of a surface becomes a chart instead, which takes more texels"
        )
        return None
    width, height = (int(n) for n in output["size"])
    unwrapped = tuple(
        Unwrapped(
            output[f"vertices{i}"].astype(np.int64),
            output[f"triangles{i}"].astype(np.int64).reshape(-1, 3),
            output[f"uvs{i}"].astype(np.float64).reshape(-1, 2) * (width, height),
            output[f"charts{i}"].astype(np.int64),
            output[f"pages{i}"].astype(np.int64),
        )
        for i in range(len(meshes))
    )
    pages = 1 + max(int(u.page_of_vertices().max(initial=0)) for u in unwrapped)
    return _with_left_out(meshes, Atlas(width, height, unwrapped, "xatlas", pages), texel_size, packing)


def _with_left_out(meshes: Sequence[Mesh], atlas: Atlas, texel_size: float, packing: Packing) -> Atlas | None:
    """Give triangles that xatlas left out, which are usually slivers, planar charts of their own: below the others, or on
    pages of their own where there is no room.

    Returns None, with a warning, if xatlas did not return the triangles that it was given, or left out so many that
    planar charts for everything are simpler.
    """
    left_out = [_without_chart(mesh, charts) for mesh, charts in zip(meshes, atlas.meshes, strict=True)]
    whole = sum(areas(mesh).sum() for mesh in meshes)
    lost = sum(areas(mesh)[which].sum() for mesh, which in zip(meshes, left_out, strict=True))
    if lost > MAX_LEFT_OUT * whole:
        warn(
            f"light map: xatlas left out {lost:.3g} m² of surfaces; each flat piece of a surface becomes a chart instead, "
            "which takes more texels"
        )
        return None
    if not any(which.any() for which in left_out):
        return atlas
    pieces = [replace(m, triangles=np.asarray(m.triangles)[which]) for m, which in zip(meshes, left_out, strict=True)]
    planar = unwrap_planar(pieces, texel_size, packing.apart, packing.max_size, least_width=atlas.width)
    bottom = atlas.height + packing.apart
    one = atlas.pages == planar.count == 1 and bottom + planar.height <= packing.max_size
    down, later = (np.array([0, bottom]), 0) if one else (np.zeros(2), atlas.pages)
    joined = []
    for charts, which, (vertices, triangles, uvs, own, pages) in zip(
        atlas.meshes, left_out, planar.meshes, strict=True
    ):
        every = charts.triangles.copy()
        every[which] = triangles + len(charts.vertices)
        joined.append(
            Unwrapped(
                np.concatenate((charts.vertices, vertices)),
                every,
                np.concatenate((charts.uvs, uvs + down)),
                np.concatenate((charts.charts, own + int(charts.charts.max(initial=-1)) + 1)),
                np.concatenate((charts.page_of_vertices(), pages + later)),
            )
        )
    return Atlas(
        max(atlas.width, planar.width),
        bottom + planar.height if one else max(atlas.height, planar.height),
        tuple(joined),
        atlas.method,
        1 if one else atlas.pages + planar.count,
    )


class _CrashError(Exception):
    """A signal ended the child process; the text describes the failure."""


def _run_child(
    arrays: dict[str, np.ndarray], timeout: float, progress: ProgressReport | None
) -> tuple[dict[str, np.ndarray] | None, str]:
    """Run xatlas in a child process; return its arrays, or None and a text that describes the failure."""
    for attempt in range(ATTEMPTS):
        try:
            return _run_once(arrays, timeout, progress)
        except _CrashError as crash:
            if attempt == ATTEMPTS - 1:
                return None, str(crash)
    raise AssertionError("ATTEMPTS is at least 1")


def _run_once(
    arrays: dict[str, np.ndarray], timeout: float, progress: ProgressReport | None
) -> tuple[dict[str, np.ndarray] | None, str]:
    """Do so once; raise _CrashError if a signal ends the child."""
    command = [sys.executable, str(XATLAS_PROGRAM)]
    started = time.monotonic()
    with tempfile.TemporaryFile() as data:
        # The input is a file instead of a pipe, because `communicate` drops unwritten input after a time-out (CPython
        # 3.11).
        np.savez(data, **arrays)  # type: ignore[arg-type]
        data.seek(0)
        child = subprocess.Popen(command, stdin=data, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    with child:
        try:
            while True:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    out, errors = child.communicate(timeout=0.2)
                    break
                seconds = time.monotonic() - started
                if seconds > timeout:
                    child.kill()
                    child.communicate()
                    return None, f"took longer than {timeout:g} s"
                if progress is not None:
                    progress("charts", 0.0, {"rays": 0.0, "seconds": seconds})
        except BaseException:
            child.kill()
            raise
    if child.returncode:
        last = errors.decode(errors="replace").strip().rpartition("\n")[2]
        problem = f"failed ({last or f'exit code {child.returncode}'})"
        if child.returncode < 0:
            raise _CrashError(problem)
        return None, problem
    try:
        with np.load(io.BytesIO(out), allow_pickle=False) as found:
            return dict(found), ""
    except (ValueError, OSError, EOFError) as error:
        return None, f"gave no charts ({error})"


def _without_chart(mesh: Mesh, charts: Unwrapped) -> NDArray[np.bool_]:
    """Return a mask (T,) of the triangles without a chart; triangles of negligible area do not count.

    It marks all triangles if xatlas did not return those that it was given.
    """
    if len(charts.triangles) != len(mesh.triangles) or not np.isfinite(charts.uvs).all():
        return np.ones(len(mesh.triangles), bool)
    world = areas(mesh)
    missing = (charts.charts[charts.triangles] < 0).any(axis=1)
    return np.asarray(missing & (world > 1e-12 * world.max(initial=0)))
