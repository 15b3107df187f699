# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Seams: found where a smooth surface is cut, not at corners."""

from __future__ import annotations

import numpy as np

import eclat
from eclat.gltf_export.geometry import with_flat_normals
from eclat.lightmap.atlas import unwrap
from eclat.lightmap.seams import seam_samples
from eclat.lightmap.texels import Corners, corners_of, rasterize
from eclat.scene import Material
from eclat.scenes.geometry import icosphere, mesh


def places_of(corners: Corners, uvs: np.ndarray) -> np.ndarray:
    """World positions of places in the map, by searching all triangles."""
    from eclat.lightmap.texels import nearest_in_triangle

    found = []
    for uv in uvs:
        weights, squared = nearest_in_triangle(corners.uvs, np.tile(uv, (len(corners.uvs), 1)))
        best = int(np.argmin(squared))
        found.append(weights[best] @ corners.positions[best])
    return np.array(found)


def test_both_sides_of_a_seam_are_one_place() -> None:
    ball = mesh([icosphere(1).smooth(180)], Material(), "ball")
    meshes = [with_flat_normals(ball)]
    corners = corners_of(meshes, unwrap(meshes, 0.1))
    a, b = seam_samples(corners)
    assert len(a) > 50
    some = np.random.default_rng(0).choice(len(a), 40, replace=False)
    assert (np.abs(a[some] - b[some]).max(axis=1) > 0.5).all(), "apart in the map"
    np.testing.assert_allclose(places_of(corners, a[some]), places_of(corners, b[some]), atol=1e-5)


def test_corners_of_a_box_are_no_seams() -> None:
    meshes = [with_flat_normals(m) for m in eclat.load("cornell-box").meshes]
    a, _ = seam_samples(corners_of(meshes, unwrap(meshes, 0.1)))
    assert len(a) == 0


def test_planes_that_continue_in_another_mesh_have_a_seam() -> None:
    left = with_flat_normals(eclat.load("cornell-box").meshes[1])
    from dataclasses import replace

    right = replace(left, positions=np.asarray(left.positions) + np.array([2 * 0.99999994, 0, 0]))
    for flip, wanted in ((False, True), (True, False)):
        other = replace(right, normals=-np.asarray(right.normals)) if flip else right
        a, b = seam_samples(corners_of([left, other], unwrap([left, other], 0.1)))
        assert (len(a) > 0) == wanted
    # Twenty texels, two samples each.
    a, b = seam_samples(corners_of([left, right], unwrap([left, right], 0.1)))
    assert 40 <= len(a) <= 46
    assert np.linalg.norm(a - b, axis=1).min() > 1


def test_empty() -> None:
    corners = corners_of([], unwrap([], 0.1))
    assert len(seam_samples(corners)[0]) == 0 and len(rasterize(corners, 1, 1)) == 0
