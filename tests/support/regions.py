# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How wrong a cache is in one region of a surface: read at points, against two unbiased gathers at the same points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import eclat
from eclat.measure.metrics import relative_rmse
from eclat.measure.photometry import LUMINANCE
from eclat.scene import FloatArray, Mesh, Scene


@dataclass(frozen=True, eq=False)
class Region:
    """Points (N, 3) and unit normals (N, 3); `shape` (rows, columns) where they form a grid."""

    points: FloatArray
    normals: FloatArray
    shape: tuple[int, int] | None = None


def rectangle(
    corner: tuple[float, float, float],
    across: tuple[float, float, float],
    along: tuple[float, float, float],
    normal: tuple[float, float, float],
    shape: tuple[int, int],
) -> Region:
    """A grid over corner + s · across + t · along, its points in the middle of their cells."""
    rows, columns = shape
    s, t = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    points = np.array(corner) + s.reshape(-1, 1) * np.array(across) + t.reshape(-1, 1) * np.array(along)
    return Region(points, np.tile(np.array(normal, dtype=np.float64), (len(points), 1)), shape)


def centroids(mesh: Mesh, seen_from: FloatArray, count: int, least_cosine: float = 0.3) -> Region:
    """The middles of `count` triangles that face the point, with their geometric normals."""
    a, b, c = (np.asarray(mesh.positions, np.float64)[mesh.triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    middles = (a + b + c) / 3
    towards = np.asarray(seen_from) - middles
    cosine = np.einsum("ij,ij->i", normals, towards) / (areas * np.linalg.norm(towards, axis=1))
    facing = np.flatnonzero(cosine > least_cosine)
    chosen = np.random.default_rng(1).choice(facing, count, p=areas[facing] / areas[facing].sum())
    return Region(middles[chosen], normals[chosen] / areas[chosen, None])


@dataclass(frozen=True, eq=False)
class Reading:
    """What the cache says at a region's points (N, 3), and two unbiased answers; how many points it serves."""

    cache: np.ndarray
    truths: tuple[np.ndarray, np.ndarray]
    served: float
    shape: tuple[int, int] | None

    @property
    def error(self) -> float:
        """Relative RMS error, free of the answers' noise."""
        a, b = self.truths
        return relative_rmse(self.cache[None], a[None], b[None])

    @property
    def bias(self) -> float:
        """Of the mean over the region."""
        return float(self.cache.mean() / np.mean(self.truths) - 1)

    @property
    def splotches(self) -> float:
        """Standard deviation of the relative error of luminance within windows of 5 × 5 points of the grid."""
        assert self.shape is not None
        truth = np.mean(self.truths, axis=0) @ LUMINANCE
        a, b = (((self.cache - t) @ LUMINANCE / truth).reshape(self.shape) for t in self.truths)
        windows = (np.lib.stride_tricks.sliding_window_view(e, (5, 5)).reshape(-1, 25) for e in (a, b))
        first, second = (w - w.mean(axis=1, keepdims=True) for w in windows)
        return float(np.sqrt(max(0.0, (first * second).sum(axis=1).mean() / 24)))


def read(scene: Scene, cache: eclat.Solution, region: Region, samples: int = 1024) -> Reading:
    """Indirect irradiance at the region's points."""
    counts: dict[str, float] = {}
    found = eclat.irradiance(
        scene, region.points, region.normals, cache, component="indirect", seed=5, statistics=counts
    )
    first, second = (
        eclat.irradiance(
            scene, region.points, region.normals, eclat.Path(), component="indirect", samples=samples, seed=s
        )
        for s in (71, 72)
    )
    return Reading(found, (first, second), counts["served"] / len(region.points), region.shape)
