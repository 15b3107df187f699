# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The layout of a light map: every triangle is placed in a chart, and charts do not overlap. xatlas computes the
charts; if it fails, `planar_charts` does."""

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

TYPICAL_TEXELS = 1 << 18
"""Number of texels on surfaces if the caller gives no texel size; the map then has about 700 × 700 texels."""

TYPICAL_FILL = 0.5
"""Share of the texels of an atlas that charts usually cover, 0..1."""

SIGNIFICANT_DIGITS = 2
"""Number of significant digits of the default texel size, which is rounded so that it is easy to read."""


@dataclass(frozen=True, eq=False)
class Unwrapped:
    """The charts of one mesh in the atlas.

    The charts have V vertices of their own, which are copies of the mesh's vertices with the indices `vertices` (V,); a
    vertex on a cut has one copy for each side of the cut. `triangles` (T, 3) are indices of these copies, in the order
    of the mesh's triangles. `uvs` (V, 2) are positions in texels: (0, 0) is the top left corner of the image, and (0.5,
    0.5) the centre of its first texel. `charts` (V,) are the indices of the vertices' charts, −1 for vertices of
    triangles without area.
    """

    vertices: NDArray[np.int64]
    triangles: NDArray[np.int64]
    uvs: FloatArray
    charts: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Atlas:
    """The charts of all meshes in one image of `width` × `height` texels. `method` is "xatlas" or "planar"."""

    width: int
    height: int
    meshes: tuple[Unwrapped, ...]
    method: str


NO_CHARTS = Unwrapped(np.zeros(0, np.int64), np.zeros((0, 3), np.int64), np.zeros((0, 2)), np.zeros(0, np.int64))
"""The charts of a mesh without triangles."""


def areas(mesh: Mesh) -> FloatArray:
    """Compute the areas (T,) of the triangles in m²."""
    return triangle_areas(np.asarray(mesh.positions)[np.asarray(mesh.triangles)])


def default_texel_size(area: float) -> float:
    """Return the texel size in metres at which surfaces of `area` m² take about `TYPICAL_TEXELS` texels."""
    if area <= 0:
        return 1.0
    size = math.sqrt(area / TYPICAL_TEXELS)
    digits = SIGNIFICANT_DIGITS - 1 - math.floor(math.log10(size))
    return float(round(size, digits))


def check_texel_count(area: float, texel_size: float, max_size: int) -> None:
    """Raise EclatError if charts of `area` m² cannot fit into an image of `max_size` × `max_size` texels."""
    if not (math.isfinite(texel_size) and texel_size > 0):
        raise EclatError(f"texel_size must be a finite number of metres above 0, got {texel_size}")
    room = max_size * max_size * TYPICAL_FILL
    if area / texel_size**2 > room:
        enough = math.sqrt(area / room)
        raise EclatError(
            f"texel_size: {area:,.4g} m² of surfaces at {texel_size:g} m per texel take {area / texel_size**2:,.0f} texels, "
            f"more than a light map of {max_size} x {max_size} holds; a texel size of {enough * 1.05:.2g} m fits"
        )


def unwrap(
    meshes: Sequence[Mesh],
    texel_size: float,
    *,
    gutter: int = 2,
    max_size: int = 4096,
    timeout: float = 60.0,
    progress: ProgressReport | None = None,
) -> Atlas:
    """Make an atlas of the meshes, which must have normals, at `texel_size` metres per texel.

    Parameters
    ----------
    gutter : number of texels between two charts, in addition to those that bilinear filtering reads.
    max_size : largest width and height in texels.
    timeout : seconds after which xatlas is stopped; 0 does not use xatlas.

    Raises
    ------
    EclatError : the charts do not fit into `max_size` × `max_size` texels.
    """
    found = None
    if timeout > 0 and any(len(mesh.triangles) for mesh in meshes):
        found = _by_xatlas([m for m in meshes if len(m.triangles)], texel_size, gutter, max_size, timeout, progress)
    if found is not None:
        # xatlas refuses meshes without triangles.
        cut = iter(found.meshes)
        found = replace(found, meshes=tuple(next(cut) if len(m.triangles) else NO_CHARTS for m in meshes))
    if found is None:
        width, height, unwrapped = unwrap_planar(meshes, texel_size, gutter)
        found = Atlas(width, height, tuple(Unwrapped(*u) for u in unwrapped), "planar")
    if max(found.width, found.height) > max_size:
        factor = max(found.width, found.height) / max_size
        raise EclatError(
            f"texel_size: at {texel_size:g} m per texel the light map has {found.width} x {found.height} texels, "
            f"more than {max_size} x {max_size}; a texel size of {texel_size * factor * 1.05:.2g} m fits"
        )
    return found


def _by_xatlas(
    meshes: Sequence[Mesh],
    texel_size: float,
    gutter: int,
    max_size: int,
    timeout: float,
    progress: ProgressReport | None,
) -> Atlas | None:
    """Compute the atlas with xatlas; warn and return None if xatlas fails, takes too long or leaves triangles out."""
    arrays: dict[str, np.ndarray] = {
        "count": np.array(len(meshes)),
        "texels_per_unit": np.array(1 / texel_size),
        # Bilinear filtering reads one texel around each chart; xatlas itself leaves space for it.
        "padding": np.array(gutter),
        "max_chart_size": np.array(max_size - 2 * gutter - 2),
    }
    center = np.mean([np.asarray(m.positions, np.float64).mean(axis=0) for m in meshes if len(m.positions)], axis=0)
    for i, mesh in enumerate(meshes):
        assert mesh.normals is not None
        arrays[f"positions{i}"] = np.ascontiguousarray(np.asarray(mesh.positions, np.float64) - center, np.float32)
        arrays[f"normals{i}"] = np.ascontiguousarray(mesh.normals, np.float32)
        arrays[f"triangles{i}"] = np.ascontiguousarray(mesh.triangles, np.uint32)
    output, problem = _run_child(arrays, timeout, progress)
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
        )
        for i in range(len(meshes))
    )
    lost = _area_without_chart(meshes, unwrapped)
    if lost > 0:
        warn(
            f"light map: xatlas left out {lost:.3g} m² of surfaces; each flat piece of a surface becomes a chart instead, "
            "which takes more texels"
        )
        return None
    return Atlas(width, height, unwrapped, "xatlas")


def _run_child(
    arrays: dict[str, np.ndarray], timeout: float, progress: ProgressReport | None
) -> tuple[dict[str, np.ndarray] | None, str]:
    """Run xatlas in a child process; return its arrays, or None and a text that describes the failure."""
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
        return None, f"failed ({last or f'exit code {child.returncode}'})"
    try:
        with np.load(io.BytesIO(out), allow_pickle=False) as found:
            return dict(found), ""
    except (ValueError, OSError, EOFError) as error:
        return None, f"gave no charts ({error})"


def _area_without_chart(meshes: Sequence[Mesh], unwrapped: Sequence[Unwrapped]) -> float:
    """Compute the area in m² of the triangles without a chart; triangles of negligible area do not count."""
    lost = 0.0
    for mesh, charts in zip(meshes, unwrapped, strict=True):
        if len(charts.triangles) != len(mesh.triangles) or not np.isfinite(charts.uvs).all():
            return float(areas(mesh).sum())
        world = areas(mesh)
        missing = (charts.charts[charts.triangles] < 0).any(axis=1)
        lost += float(world[missing & (world > 1e-12 * world.max(initial=0))].sum())
    return lost
