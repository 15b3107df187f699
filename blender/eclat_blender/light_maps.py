# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light maps of objects in the UV maps that they have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eclat.gltf_export.geometry import face_normals
from eclat.lightmap.gathering import Settings, gather, sample_points, visible_points
from eclat.lightmap.gutters import dilate
from eclat.lightmap.solids import solid_triangles
from eclat.lightmap.texels import Corners, rasterize
from eclat.methods import as_method
from eclat.scene import Camera, Mesh

from .translate import Translated

SUPERSAMPLING = 2
"""Points along the side of a texel."""

OUTSIDE = 1e-3
"""Texture coordinates farther outside 0 … 1 than this are not in the image."""


class LightMaps:
    """Bakes objects of a translated scene. `settings` are Éclat's settings of the Blender scene."""

    def __init__(self, found: Translated, settings: object) -> None:
        self._found, self._settings = found, settings
        # Light maps need no camera, but Éclat says so where a scene has none.
        self._scene = replace(found.scene, cameras=(Camera(np.eye(4)),))
        self._solid = solid_triangles(self._scene, self._scene.meshes)

    def bake(self, name: str) -> np.ndarray | None:
        """Compute the irradiance (H, W, 3), row 0 on top, of the object `name`; None if it has no surface or UV map, which
        the notices then say."""
        where, settings = f"object {name!r}", self._settings
        meshes = [m for m, source in zip(self._found.scene.meshes, self._found.sources, strict=True) if source == name]
        if not meshes or any(mesh.uvs is None for mesh in meshes):
            self._found.notices.add(where, "it has no UV map, or no faces, and so no light map; unwrap it first")
            return None
        size = settings.bake_size
        corners = _corners(meshes, size)
        if corners.uvs.min() < -OUTSIDE * size or corners.uvs.max() > (1 + OUTSIDE) * size:
            self._found.notices.add(where, "parts of its UV map lie outside the image and get no light")
        texels = rasterize(corners, size, size)
        points = sample_points(corners, texels, SUPERSAMPLING)
        gathering = Settings(settings.bake_component, settings.bake_samples, -1, settings.seed, None, None)
        free = visible_points(self._scene, self._solid, points, gathering)
        source = as_method(settings.method, settings.method, max_error=settings.max_error)
        gathered = gather(self._scene, source, points, free, gathering)
        image, known = np.zeros((size, size, 3)), np.zeros((size, size), bool)
        seen = gathered.seen
        image[texels.rows[seen], texels.columns[seen]] = gathered.values[seen]
        known[texels.rows[seen], texels.columns[seen]] = True
        image, _ = dilate(image, known, settings.bake_margin)
        return image.astype(np.float32)


def _corners(meshes: list[Mesh], size: int) -> Corners:
    """The corners of the triangles of meshes, by their own texture coordinates in an image of `size` texels."""

    def at_corners(mesh: Mesh, values: np.ndarray) -> np.ndarray:
        return np.asarray(values, np.float64)[np.asarray(mesh.triangles)]

    faces = [face_normals(mesh) for mesh in meshes]
    smooth = [
        np.repeat(face[:, None], 3, axis=1) if mesh.normals is None else at_corners(mesh, mesh.normals)
        for mesh, face in zip(meshes, faces, strict=True)
    ]
    return Corners(
        uvs=np.concatenate([at_corners(mesh, mesh.uvs) for mesh in meshes]) * size,
        positions=np.concatenate([at_corners(mesh, mesh.positions) for mesh in meshes]),
        normals=np.concatenate(smooth),
        face_normals=np.concatenate(faces),
        charts=np.zeros(sum(len(mesh.triangles) for mesh in meshes), np.int64),
    )
