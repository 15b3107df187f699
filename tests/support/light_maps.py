# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What a viewer reads of a light map: bilinear lookups at random points of the surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import eclat
from eclat.gltf_export import Part
from eclat.lightmap.atlas import Atlas, Unwrapped, areas
from eclat.lightmap.seams import seam_samples
from eclat.lightmap.texels import corners_of
from eclat.scene import FloatArray


@dataclass(frozen=True)
class Read:
    """Points (N, 3) on the parts numbered `parts` (N,), with unit normals and irradiance from the map."""

    positions: FloatArray
    normals: FloatArray
    irradiance: FloatArray
    parts: np.ndarray


def read_at_random(lightmap: eclat.Lightmap, count: int, seed: int = 1) -> Read:
    """`count` points, uniform over all surfaces."""
    rng = np.random.default_rng(seed)
    sizes = [areas(part.mesh) for part in lightmap.parts]
    which = np.concatenate([np.full(len(a), i) for i, a in enumerate(sizes)])
    triangle = np.concatenate([np.arange(len(a)) for a in sizes])
    share = np.concatenate(sizes)
    picked = rng.choice(len(share), count, p=share / share.sum())
    u = rng.random((count, 2))
    u = np.where(u.sum(axis=1, keepdims=True) > 1, 1 - u, u)
    weights = np.column_stack((1 - u.sum(axis=1), u))
    corners = [np.asarray(lightmap.parts[which[k]].mesh.triangles)[triangle[k]] for k in picked]

    def blend(values) -> np.ndarray:
        return np.array(
            [
                w @ np.asarray(values(lightmap.parts[which[k]]))[c]
                for k, c, w in zip(picked, corners, weights, strict=True)
            ]
        )

    normals = blend(lambda part: part.mesh.normals)
    places = {id(part): uvs for part, uvs in zip(lightmap.parts, lightmap.stacked_uvs(), strict=True)}
    return Read(
        blend(lambda part: part.mesh.positions),
        normals / np.linalg.norm(normals, axis=1, keepdims=True),
        lookup(lightmap.irradiance, blend(lambda part: places[id(part)])),
        which[picked],
    )


def lookup(image: np.ndarray, uvs: FloatArray) -> FloatArray:
    """Bilinear, as a graphics card does it: (0, 0) is the top left corner, texel centres lie at halves."""
    height, width = image.shape[:2]
    x, y = uvs[:, 0] * width - 0.5, uvs[:, 1] * height - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - i)[:, None], (y - j)[:, None]

    def texel(dj: int, di: int) -> np.ndarray:
        return image[np.clip(j + dj, 0, height - 1), np.clip(i + di, 0, width - 1)]

    above = texel(0, 0) * (1 - fx) + texel(0, 1) * fx
    below = texel(1, 0) * (1 - fx) + texel(1, 1) * fx
    return above * (1 - fy) + below * fy


def seam_gap(lightmap: eclat.Lightmap) -> float:
    """The root mean square of the step across seams, relative to the mean irradiance."""
    size = np.array(lightmap.irradiance.shape[1::-1])
    atlas = Atlas(int(size[0]), int(size[1]), tuple(in_one_chart(part, size) for part in lightmap.parts), "")
    corners = corners_of([part.mesh for part in lightmap.parts], atlas)
    a, b = (lookup(lightmap.irradiance, ends / size) for ends in seam_samples(corners))
    return float(np.sqrt(np.mean((a - b) ** 2)) / lightmap.irradiance.mean())


def in_one_chart(part: Part, size: np.ndarray) -> Unwrapped:
    """A part of a light map as if it were one chart: seams are where places differ."""
    numbers = np.arange(len(part.mesh.positions))
    assert part.lightmap_uvs is not None
    return Unwrapped(numbers, np.asarray(part.mesh.triangles), part.lightmap_uvs * size, 0 * numbers)
