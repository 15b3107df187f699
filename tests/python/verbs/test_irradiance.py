# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records or paths for points: a choice by counts, said in the statistics. What points receive is tested in
tests/methods/test_solve_points.py."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.scene import Material, Mesh, Scene, grey
from eclat.scenes import build
from eclat.scenes.geometry import box
from eclat.verbs.irradiance import paths_for_few


def test_few_points_are_gathered_by_paths_and_many_by_records() -> None:
    assert paths_for_few(1, 0.01) == 8192
    assert paths_for_few(10_000, 0.01) is None
    # Paths need four times as many for half the error, records only finer ones.
    most = [max(n for n in range(1, 5000) if paths_for_few(n, e) is not None) for e in (0.02, 0.01, 0.005)]
    assert most[0] > most[1] > most[2] > 0


def test_the_automatic_choice_is_stated_and_correct() -> None:
    """In the furnace irradiance is 2 π everywhere."""
    scene = build("furnace")
    told: dict[str, float] = {}
    E = eclat.irradiance(scene, [[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]], statistics=told)
    assert told["paths"] == 8192
    assert "served" not in told
    assert np.asarray(E) == pytest.approx(2 * np.pi, rel=0.02)
    asked: dict[str, float] = {}
    eclat.irradiance(
        scene, [[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]], eclat.IrradianceCache(max_error=0.05), statistics=asked
    )
    assert "paths" not in asked
    assert "served" in asked


def test_direct_light_beside_what_is_large_and_near_is_clean_and_its_error_stated() -> None:
    """A closed box whose walls emit 1 gives π everywhere, 5 mm from a floor in 200 strips too: light samples alone are off
    by tens of per cent there."""
    z = np.linspace(-1, 1, 201)
    corners = [(x, -1.0, c) for c in z for x in (-1.0, 1.0)]
    strips = [t for i in range(200) for t in ((2 * i, 2 * i + 2, 2 * i + 3), (2 * i, 2 * i + 3, 2 * i + 1))]
    emits = Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(1.0))
    solid = box((-1, -1, -1), (1, 1, 1)).inside_out()
    others = solid.triangles[(solid.positions[solid.triangles][..., 1] > -0.9).any(axis=1)]
    scene = Scene(meshes=(Mesh(solid.positions, others, emits), Mesh(np.array(corners), np.array(strips), emits)))
    points = np.column_stack([np.full(40, -0.999), np.full(40, -0.995), np.linspace(-0.9, 0.9, 40)])
    statistics: dict[str, float] = {}
    found = eclat.irradiance(
        scene, points, np.tile((1.0, 0.0, 0.0), (40, 1)), eclat.Path(), component="direct", statistics=statistics
    )
    error = float(np.sqrt(np.mean((found / np.pi - 1) ** 2)))
    assert error < 0.02
    assert error / 3 < statistics["direct_error"] < 3 * error
