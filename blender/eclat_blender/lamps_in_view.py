# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps with a size that stand in the picture, where Blender's own engines hide them."""

from __future__ import annotations

import numpy as np

from eclat.scene import Camera, Mesh, Scene

from .notices import Notices


def name_lamps_in_view(scene: Scene, sources: tuple[str, ...], camera: Camera, notices: Notices) -> None:
    """Name the lamps whose glowing front may be seen by the camera. `sources` name the objects of meshes, "" for lamps."""
    for mesh, source in zip(scene.meshes, sources, strict=True):
        if source == "" and may_be_seen(mesh, camera):
            notices.add(
                f"light {mesh.name!r}",
                "it has a size, so the camera sees it as a surface that glows, which Cycles hides",
            )


def may_be_seen(mesh: Mesh, camera: Camera) -> bool:
    """Whether the front of any triangle faces the camera and has a corner in its picture, if nothing stands before it."""
    assert camera.size is not None
    to_eye = np.linalg.inv(camera.to_world)
    corners = (np.asarray(mesh.positions) @ to_eye[:3, :3].T + to_eye[:3, 3])[np.asarray(mesh.triangles)]
    fronts = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    parallel = camera.projection == "orthographic"
    to_camera = np.array((0.0, 0.0, 1.0)) if parallel else -corners[:, 0]
    facing = (fronts * to_camera).sum(axis=1) > 0
    depth = -corners[..., 2]
    inside = depth > 0
    away = np.ones_like(depth) if parallel else np.where(inside, depth, 1.0)
    width, height = camera.size
    half = camera.half_extent(width / height)
    across = (corners[..., 0] / away / half[0] + 1) / 2 - camera.shift[0]
    down = (1 - corners[..., 1] / away / half[1]) / 2 - camera.shift[1]
    inside &= (across > 0) & (across < 1) & (down > 0) & (down < 1)
    return bool((inside.any(axis=1) & facing).any())
