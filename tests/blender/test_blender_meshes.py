# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry: arrays of evaluated meshes, and where transforms put them."""

import numpy as np

from eclat.scene import Material
from eclat_blender.materials import Made
from eclat_blender.meshes import placed, read_parts
from support.blender_standins import Columns, square_mesh

MADE = Made(Material())


def test_corners_with_the_same_values_are_one_vertex_and_v_points_down():
    (part,) = read_parts(square_mesh())
    assert len(part.positions) == 4 and part.triangles.shape == (2, 3) and part.normals is None
    mesh = placed(part, np.eye(4), MADE, "square")
    low_left = int(np.argmin(mesh.positions[:, 0] + mesh.positions[:, 1]))
    assert tuple(mesh.uvs[low_left]) == (0, 1)


def test_corners_with_different_normals_stay_apart():
    data = square_mesh()
    data.loop_triangles = Columns(2, loops=[(0, 1, 2), (3, 4, 5)], material_index=[0, 1])
    data.loops = Columns(6, vertex_index=[0, 1, 2, 0, 2, 3])
    tilted = np.array((0.6, 0, 0.8))
    data.corner_normals = Columns(6, vector=[(0, 0, 1)] * 3 + [tilted] * 3)
    data.uv_layers = []
    flat, smooth = read_parts(data)
    assert (flat.slot, smooth.slot) == (0, 1)
    assert flat.normals is None and np.allclose(smooth.normals, tilted)


def test_a_mirroring_transform_keeps_the_front_outside():
    (part,) = read_parts(square_mesh())
    to_world = np.diag((-2.0, 1.0, 1.0, 1.0))
    mesh = placed(part, to_world, MADE, "square")
    corners = np.asarray(mesh.positions)[np.asarray(mesh.triangles)]
    assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0).all()


def test_normals_stay_perpendicular_under_unequal_scales():
    data = square_mesh()
    data.corner_normals = Columns(4, vector=[(0.6, 0, 0.8)] * 4)
    (part,) = read_parts(data)
    mesh = placed(part, np.diag((2.0, 1.0, 1.0, 1.0)), MADE, "square")
    tangent = np.array((0.8 * 2, 0, -0.6))
    assert np.allclose(mesh.normals @ tangent, 0, atol=1e-6) and np.allclose(np.linalg.norm(mesh.normals, axis=1), 1)
