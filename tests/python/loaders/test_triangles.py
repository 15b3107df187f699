# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What loaders of mesh files share: normals, triangulation in order, checks with a place in their message."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.errors import EclatError, EclatWarning
from eclat.loaders import triangles

BENT = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.5)], dtype=np.float64)


def test_mixed_polygons_are_cut_in_file_order() -> None:
    points = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], dtype=np.float64)
    corners = np.array([0, 1, 2, 0, 1, 2, 3, 0, 1, 1, 2, 3])
    cut, polygons = triangles.triangulate(points, corners, np.array([3, 4, 2, 3]), "test")
    assert corners[cut].tolist() == [[0, 1, 2], [0, 1, 2], [0, 2, 3], [1, 2, 3]]
    assert polygons.tolist() == [0, 1, 1, 3]


def test_smooth_normals_are_those_of_mitsuba() -> None:
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    mesh = mitsuba.Mesh("bent", 4, 2, has_vertex_normals=True)
    parameters = mitsuba.traverse(mesh)
    parameters["vertex_positions"] = BENT.ravel().astype(np.float32)
    parameters["faces"] = np.array([0, 1, 2, 0, 2, 3], dtype=np.uint32)
    parameters.update()
    mesh.recompute_vertex_normals()
    expected = np.array(mitsuba.traverse(mesh)["vertex_normals"]).reshape(-1, 3)
    got = triangles.smooth_normals(BENT, np.array([(0, 1, 2), (0, 2, 3)]))
    np.testing.assert_allclose(got, expected, atol=1e-6)


def test_normals_that_cancel_are_replaced_by_a_face_s() -> None:
    got = triangles.smooth_normals(BENT, np.array([(0, 1, 2), (0, 2, 1)]))
    np.testing.assert_allclose(np.linalg.norm(got, axis=1), 1, atol=1e-6)


@pytest.mark.parametrize("scale", [1e-150, 1e-30, 1.0, 1e38])
def test_normals_at_any_scale(scale: float) -> None:
    got = triangles.smooth_normals(BENT * scale, np.array([(0, 1, 2)]))
    np.testing.assert_allclose(got[:3], [(0, 0, 1)] * 3, atol=1e-6)


def test_given_normals_are_made_unit_and_zero_ones_replaced() -> None:
    given = np.array([(0, 0, 5), (0, 0, 0), (0, 3, 0), (1, 0, 0)], dtype=np.float32)
    got = triangles.vertex_normals(BENT, np.array([(0, 1, 2)]), given, "test")
    np.testing.assert_allclose(got, [(0, 0, 1), (0, 0, 1), (0, 1, 0), (1, 0, 0)], atol=1e-6)


def test_slivers_are_dropped_with_one_warning() -> None:
    with pytest.warns(EclatWarning, match=r"^test: 2 triangles of zero area and 1 faces of fewer") as caught:
        keep = triangles.triangles_with_area(
            BENT, np.array([(0, 1, 2), (0, 0, 1), (1, 2, 1)]), "test", short_polygons=1
        )
    assert keep.tolist() == [True, False, False]
    assert len(caught) == 1


def test_only_slivers_is_an_error() -> None:
    with pytest.raises(EclatError, match="test: expected at least one triangle with an area, got 1 triangles"):
        triangles.triangles_with_area(BENT, np.array([(1, 1, 2)]), "test")


def test_whether_any_triangle_has_an_area() -> None:
    assert triangles.any_has_area(BENT, np.array([(1, 1, 2), (0, 1, 2)]))
    assert not triangles.any_has_area(BENT, np.array([(1, 1, 2)]))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e39])
def test_positions_must_be_finite_in_single_precision(value: float) -> None:
    positions = BENT.copy()
    positions[2, 1] = value
    with pytest.raises(EclatError, match="test, vertex 2: expected finite coordinates"):
        triangles.check_positions(positions, "test")


def test_other_attributes_become_zero_with_a_warning() -> None:
    with pytest.warns(EclatWarning, match="test: 2 uvs are not finite"):
        got = triangles.finite_rows(np.array([(0.5, 0.5), (np.nan, 0), (0, 1e300)]), "uvs", "test")
    assert got.tolist() == [[0.5, 0.5], [0, 0], [0, 0]]


def test_srgb_is_decoded() -> None:
    got = triangles.linear_from_srgb(np.array([0, 0.04, 0.5, 1]))
    np.testing.assert_allclose(got, [0, 0.04 / 12.92, 0.21404114, 1], rtol=1e-6)
