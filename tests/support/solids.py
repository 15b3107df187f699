# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Questions about triangles that do not use Éclat's own answers: closed? degenerate? inside or outside?"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from eclat.scene import Mesh


def corners_of(meshes: Iterable[Mesh]) -> np.ndarray:
    """(T, 3, 3) positions of the corners of all triangles."""
    return np.concatenate([np.asarray(m.positions, dtype=np.float64)[m.triangles] for m in meshes])


def open_edges(mesh: Mesh) -> int:
    """How many directed edges lack a partner in the opposite direction, corners at one place being one corner."""
    size = float(np.ptp(mesh.positions, axis=0).max())
    _, corner = np.unique(np.round(mesh.positions / size, 9), axis=0, return_inverse=True)
    t = corner.reshape(-1)[mesh.triangles].astype(np.int64)
    edges = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    count = len(mesh.positions)
    keys, forward = np.unique(edges[:, 0] * count + edges[:, 1], return_counts=True)
    back_keys, back = np.unique(edges[:, 1] * count + edges[:, 0], return_counts=True)
    both = np.intersect1d(keys, back_keys)
    matched = np.minimum(forward[np.searchsorted(keys, both)], back[np.searchsorted(back_keys, both)])
    return int(len(edges) - matched.sum())


def thinnest(mesh: Mesh) -> float:
    """The least height over longest side of all triangles: 0 for degenerate ones."""
    a, b, c = np.moveaxis(corners_of([mesh]), 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    longest = np.max([np.sum((p - q) ** 2, axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    return float((area / longest).min())


def signed_volume(corners: np.ndarray) -> float:
    """Positive for closed surfaces that face outwards."""
    return float(np.einsum("ij,ij->", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2])) / 6


def winding_number(corners: np.ndarray, point: Iterable[float]) -> float:
    """How often closed surfaces wrap around a point [VanOosterom83]: 0 outside, 1 inside, −1 in a shell turned in."""
    a, b, c = np.moveaxis(corners - np.array(list(point)), 1, 0)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a)))
    return float(np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb).sum() / (2 * np.pi))
