# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Load scenes from Universal Scene Description (`.usd`, `.usda`, `.usdc`, `.usdz`), by the package `usd-core`.

The modules of this package are `stages` (files and layers, and values in them), `builder` (the hierarchy and instances), `meshes`
(polygons), `gprims` (spheres, cubes and so on), `materials` and `textures` (UsdPreviewSurface), `lights` (UsdLux), `shaping`
(the cones of lights) and `cameras`.
"""

from __future__ import annotations

from pathlib import Path

from eclat.errors import warn
from eclat.loaders.usd.builder import Builder
from eclat.loaders.usd.stages import guarded, opened
from eclat.scene import Scene


def load_usd(path: str | Path) -> Scene:
    """Load what a USD file shows to a renderer, with all instances in world space.

    Lengths become metres (`metersPerUnit`), and `Scene.up` is the `upAxis`. Luminances are in cd·m⁻² [UsdLux], and a file
    that has lights or emission sets `Scene.photometric`. Values that change over time are those of the first time. Prims
    whose purpose is "proxy" or "guide", and invisible ones, are left out. An `EclatWarning` reports everything that is
    replaced or ignored.

    Parameters
    ----------
    path : a `.usd`, `.usda`, `.usdc` or `.usdz` file. It may refer to layers and textures anywhere, but not outside of the root
        folder (`eclat.files.confinement`).

    Raises
    ------
    EclatError : the file cannot be read, or nothing in it is valid; or `usd-core` is not installed.
    """
    with guarded(Path(path).name), opened(Path(path)) as stage:
        builder = Builder(stage)
        builder.build()
        builder.parts.finish()
        up: tuple[float, float, float] = (0.0, 0.0, 1.0) if stage.z_up else (0.0, 1.0, 0.0)
    if not builder.meshes:
        warn(f"{stage.name}: the scene has no triangles, so it is empty")
    glows = any(mesh.material.emission is not None for mesh in builder.meshes)
    return Scene(
        meshes=tuple(builder.meshes),
        lights=tuple(builder.lights),
        environment=builder.environment,
        cameras=tuple(builder.cameras),
        name=Path(path).stem,
        up=up,
        photometric=glows or bool(builder.lights) or builder.environment is not None,
    )
