# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records of radiance as rows: to the core and back, and light that turns with its surface."""

from __future__ import annotations

import numpy as np

from eclat import _core, harmonics
from eclat.bridge.anchors import Posed
from eclat.methods.records.radiance_rows import RECORD, luminances, order_of, records_of, rows_of
from eclat.methods.records.tracks import COLUMNS, in_core_space, in_surface_space

ORDER, COUNT = 4, 5


def rows(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(COUNT, RECORD + 9 * ORDER**2)).astype(np.float32)


def poses(normals: np.ndarray, seed: int) -> Posed:
    """Frames around normals, turned at random."""
    along = np.cross(normals, np.random.default_rng(seed).normal(size=normals.shape))
    along /= np.linalg.norm(along, axis=1)[:, None]
    frames = np.stack([along, np.cross(normals, along), normals], axis=-1)
    return Posed(np.zeros_like(normals), normals, normals, frames)


def some_normals(seed: int) -> np.ndarray:
    found = np.random.default_rng(seed).normal(size=(COUNT, 3))
    return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])


def test_rows_are_what_the_core_keeps() -> None:
    before = rows(0)
    assert order_of(before) == ORDER
    kept = records_of(before)
    assert kept.gradients.shape == (COUNT, 6 * 16)
    after = rows_of(kept, ORDER)
    values = RECORD + 3 * ORDER**2
    np.testing.assert_array_equal(after[:, :values], before[:, :values])
    np.testing.assert_allclose(after[:, values:], before[:, values:], rtol=2**-8)
    assert records_of(rows_of(records_of(before[:0]), ORDER)).values.shape == (0, 0)


def radiance_towards(coefficients: np.ndarray, normals: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """The radiance (N,) that each record has from a world direction, by harmonics in the frame of records."""
    out = []
    for c, n, w in zip(coefficients, normals, directions, strict=True):
        u = _core.tangents_around(n[None].astype(np.float32))[0].astype(np.float64)
        local = np.array([w @ u, w @ np.cross(n, u), w @ n])
        out.append(harmonics.reconstruct("spherical", c, local[None] / np.linalg.norm(local))[0])
    return np.array(out)


def test_light_turns_with_its_surface() -> None:
    here, there = poses(some_normals(1), 2), poses(some_normals(3), 4)
    moving, before = np.ones(COUNT, np.bool_), rows(0)
    before[:, COLUMNS["normals"]] = here.normals
    kept = in_surface_space(before, here, moving)
    after = in_core_space(kept, there, moving, np.zeros((COUNT, 3), np.float32))
    directions = some_normals(5)
    turned = np.einsum("nij,nj->ni", there.frames, np.einsum("nji,nj->ni", here.frames, directions))
    a = radiance_towards(luminances(before), here.normals, directions)
    b = radiance_towards(luminances(after), there.normals, turned)
    np.testing.assert_allclose(a, b, atol=1e-5)
    # The derivative along a direction that turns with the surface turns as well.
    shift = here.frames[:, :, 0]
    moved = there.frames[:, :, 0]
    a, b = (
        radiance_towards(derivative(r, pose.normals, way), pose.normals, w)
        for r, pose, way, w in ((before, here, shift, directions), (after, there, moved, turned))
    )
    np.testing.assert_allclose(a, b, atol=1e-5)
    # Records that do not move are left alone.
    np.testing.assert_array_equal(in_surface_space(before, here, ~moving), before)


def derivative(of: np.ndarray, normals: np.ndarray, along: np.ndarray) -> np.ndarray:
    """The derivative of the coefficients of the first channel along world directions in the surface."""
    u = _core.tangents_around(normals.astype(np.float32)).astype(np.float64)
    v = np.cross(normals, u)
    gradients = of[:, RECORD + 3 * ORDER**2 :].reshape(COUNT, 2, 3, ORDER**2)[:, :, 0].astype(np.float64)
    shares = np.stack([np.einsum("ni,ni->n", axis, along) for axis in (u, v)], axis=1)
    return np.asarray(np.einsum("nk,nkc->nc", shares, gradients))
