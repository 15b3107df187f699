# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records as rows for the page; what the page makes of them is tested in tests/methods/test_view_in_browser.py."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat import scenes
from eclat.methods.records.laws import core_options
from eclat.methods.records.solution import Solution
from eclat.viewer.messages import decode_message
from eclat.viewer.record_rows import ROW, reading_of, record_rows, records_message, stretches

METHOD = eclat.IrradianceCache(max_error=0.1, least_pixels=1, rows=8)

SPACING = core_options(METHOD).spacing


@pytest.fixture(scope="module")
def solution() -> Solution:
    return eclat.solve(scenes.build("cornell-box"), METHOD, size=(32, 32), check=False)


def test_rows_hold_what_the_core_reads(solution: Solution) -> None:
    rows = record_rows(solution.core(), SPACING)
    read = ~solution.enclosed
    assert rows.dtype == np.float32 and rows.shape == (read.sum(), ROW)
    np.testing.assert_array_equal(rows[:, :3], (solution.positions - solution.center)[read].astype(np.float32))
    np.testing.assert_array_equal(rows[:, 4:7], solution.normals[read])
    np.testing.assert_array_equal(rows[:, 12:15], solution.irradiance[read])
    turning, moving = solution.rotation_gradients[read], solution.translation_gradients[read]
    np.testing.assert_array_equal(rows[:, [[20, 21, 22], [24, 25, 26], [28, 29, 30]]], turning)
    np.testing.assert_array_equal(rows[:, [[23, 27, 31], [32, 33, 34], [35, 18, 19]]], moving)
    np.testing.assert_array_equal(rows[:, 7], rows[:, 36:48].min(axis=1))
    assert np.isfinite(rows).all()


def test_neighbours_only_make_radii_smaller(solution: Solution) -> None:
    rows = record_rows(solution.core(), SPACING)
    radii, alone = rows[:, 3], np.abs(rows[:, 50])
    np.testing.assert_array_equal(np.signbit(rows[:, 50]), np.signbit(solution.normals[~solution.enclosed][:, 2]))
    assert (alone >= radii * (1 - 1e-6)).all() and (alone > 1.01 * radii).any()
    # Without clamping, the core has the radii that the rows call those before neighbours bound them.
    unbound = eclat.solve(
        scenes.build("cornell-box"), replace(METHOD, neighbor_clamping=False), size=(32, 32), check=False
    )
    free = record_rows(unbound.core(), SPACING)
    np.testing.assert_allclose(free[:, 3], np.abs(free[:, 50]), rtol=1e-6)


def test_the_excess_is_shared_with_neighbours(solution: Solution) -> None:
    shared = record_rows(solution.core(), SPACING)[:, [15, 16, 17]]
    own = solution.excess[~solution.enclosed]
    assert own.any() and not np.array_equal(shared, own)
    # Sharing averages: the noise falls, and about the same light stays.
    assert shared.std() < own.std()
    assert shared.mean() == pytest.approx(own.mean(), rel=0.3)


def test_a_stretch_points_along_the_long_axis() -> None:
    normal = np.array([[0, 0, 1], [0, 0, 1], [0.6, 0, 0.8]], np.float32)
    found = stretches(normal, np.array([0, np.pi / 2, 1], np.float32), np.array([2, 1.25, 1], np.float32))
    np.testing.assert_allclose(found, [[np.sqrt(0.75), 0, 0], [0, 0.6, 0], [0, 0, 0]], atol=1e-6)
    np.testing.assert_allclose((found * normal).sum(axis=1), 0, atol=1e-6)


def test_a_message_may_begin_at_any_record(solution: Solution) -> None:
    header, arrays = decode_message(records_message(solution, first=5))
    rows = record_rows(solution.core(), SPACING)
    assert (header["first"], header["count"], header["reading"]) == (5, len(rows), reading_of(solution))
    np.testing.assert_array_equal(arrays["rows"], rows[5:])


def test_how_records_are_read(solution: Solution) -> None:
    assert reading_of(solution) == {
        "weight": "tabellion",
        "relaxation": 2.0,
        "rotation_gradient": True,
        "translation_gradient": True,
        "spacing": reading_of(solution)["spacing"],
        "method": "irradiance-cache",
    }
