# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A program that unwraps meshes with xatlas: it reads arrays from standard input and writes charts to standard output.

It runs as a separate process, because xatlas can crash or run forever on broken meshes and cannot be stopped. It
imports nothing from this package, so that it starts quickly.
"""

from __future__ import annotations

import io
import sys

import numpy as np
import xatlas


def unwrap(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Make charts of the meshes `positions0`, `normals0`, `triangles0`, `positions1`, …, and pack them into pages.

    Returns `size` (width, height in texels), and for each mesh `vertices`, the index of the vertex that each vertex
    copies; `triangles`; `uvs`, in 0..1 of the page; and `charts` and `pages`, the chart and the page of each vertex, −1 for
    vertices that xatlas left out.
    """
    atlas = xatlas.Atlas()
    count = int(arrays["count"])
    for i in range(count):
        atlas.add_mesh(arrays[f"positions{i}"], arrays[f"triangles{i}"], arrays[f"normals{i}"])
    charts, packing = xatlas.ChartOptions(), xatlas.PackOptions()
    packing.texels_per_unit = float(arrays["texels_per_unit"])
    packing.padding = int(arrays["padding"])
    packing.max_chart_size = int(arrays["max_chart_size"])
    # With a resolution, xatlas fills as many pages of that size as it needs; without one, it makes one page that fits all.
    packing.resolution = int(arrays["resolution"])
    packing.bilinear = True
    packing.rotate_charts_to_axis = True
    packing.bruteForce = False
    atlas.generate(charts, packing)
    found = {"size": np.array([atlas.width, atlas.height])}
    for i in range(count):
        vertices, triangles, uvs = atlas.get_mesh(i)
        page, chart = atlas.get_mesh_vertex_assignment(i)
        found |= {f"vertices{i}": vertices, f"triangles{i}": triangles, f"uvs{i}": uvs}
        found |= {f"charts{i}": chart.view(np.int32), f"pages{i}": page.view(np.int32)}
    return found


def main() -> None:
    """Read the meshes, unwrap them and write the charts."""
    with np.load(io.BytesIO(sys.stdin.buffer.read()), allow_pickle=False) as arrays:
        found = unwrap(dict(arrays))
    out = io.BytesIO()
    np.savez(out, **found)  # type: ignore[arg-type]
    sys.stdout.buffer.write(out.getvalue())


if __name__ == "__main__":
    main()
