# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Bodies and sheets: which pieces of a mesh enclose a volume."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eclat.loaders.obj import load_obj
from eclat.loaders.sheets import bounding_triangles
from eclat.scene import Material, Mesh
from eclat.scenes.geometry import Solid, box, icosphere


def joined(*meshes: Mesh) -> Mesh:
    """One mesh of several."""
    positions, triangles, count = [], [], 0
    for mesh in meshes:
        positions.append(np.asarray(mesh.positions, np.float64))
        triangles.append(np.asarray(mesh.triangles) + count)
        count += len(mesh.positions)
    return Mesh(np.concatenate(positions), np.concatenate(triangles), Material())


def bare(positions: object, triangles: object) -> Mesh:
    return Mesh(np.array(positions, np.float64), np.array(triangles), Material())


def split(mesh: Mesh) -> Mesh:
    """Each triangle with vertices of its own."""
    return bare(
        np.asarray(mesh.positions)[np.asarray(mesh.triangles)].reshape(-1, 3),
        np.arange(3 * len(mesh.triangles)).reshape(-1, 3),
    )


def of(solid: Solid, place: tuple[float, float, float]) -> Mesh:
    return bare(np.asarray(solid.positions) + place, solid.triangles)


PANE = of(box((0, 0, 0), (1, 1, 0.004)), (0, 0, 0))
BALL = of(icosphere(2), (5, 0, 0))
SHEET = bare([(0, 0, 3), (1, 0, 3), (1, 1, 3), (0, 1, 3)], [(0, 1, 2), (0, 2, 3)])


def test_closed_pieces_are_bodies_however_their_vertices_are_shared() -> None:
    for body in (PANE, BALL, split(PANE), split(BALL)):
        assert bounding_triangles(body).all()


def test_sheets_are_not_solids() -> None:
    assert not bounding_triangles(SHEET).any()
    half = np.asarray(BALL.positions)[np.asarray(BALL.triangles)].mean(axis=1)[:, 2] > 0
    assert not bounding_triangles(bare(BALL.positions, np.asarray(BALL.triangles)[half])).any()
    # The same sheet twice, back to back, encloses nothing.
    assert not bounding_triangles(
        bare(SHEET.positions, np.concatenate((SHEET.triangles, SHEET.triangles[:, ::-1])))
    ).any()
    # A pane without its four narrow sides is two sheets.
    wide = np.ptp(np.asarray(PANE.positions)[np.asarray(PANE.triangles)][:, :, 2], axis=1) == 0
    assert wide.sum() == 4
    assert not bounding_triangles(bare(PANE.positions, np.asarray(PANE.triangles)[wide])).any()


def test_a_missing_face_and_a_t_junction_leave_a_body() -> None:
    assert bounding_triangles(bare(BALL.positions, np.asarray(BALL.triangles)[1:])).all()
    # A cube whose top is four triangles around the middle of one of its edges, which the side below does not know.
    a, b, c, d = (0, 0), (1, 0), (1, 1), (0, 1)
    low, high = [(x, y, 0) for x, y in (a, b, c, d)], [(x, y, 1) for x, y in (a, b, c, d)]
    sides = [t for i in range(4) for t in ((i, (i + 1) % 4, 4 + (i + 1) % 4), (i, 4 + (i + 1) % 4, 4 + i))]
    floor, top = [(0, 2, 1), (0, 3, 2)], [(4, 8, 7), (8, 5, 6), (8, 6, 7)]
    assert bounding_triangles(bare([*low, *high, (0.5, 0, 1)], floor + sides + top)).all()


def test_pieces_of_a_mesh_are_judged_apart() -> None:
    found = bounding_triangles(joined(PANE, SHEET, BALL))
    expected = np.repeat([True, False, True], [len(m.triangles) for m in (PANE, SHEET, BALL)])
    assert np.array_equal(found, expected)


@pytest.mark.parametrize("illum", [4, 6, 7])
def test_glass_of_an_obj_file_is_panes_and_bodies(tmp_path: Path, illum: int) -> None:
    (tmp_path / "m.mtl").write_text(f"newmtl m\nNi 1.5\nTf 0.8 0.8 0.8\nillum {illum}\n")
    lines = ["mtllib m.mtl", "usemtl m"]
    mesh = joined(SHEET, PANE)
    lines += [f"v {x} {y} {z}" for x, y, z in mesh.positions]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in mesh.triangles]
    (tmp_path / "m.obj").write_text("\n".join(lines) + "\n")
    body, sheet = load_obj(tmp_path / "m.obj")
    assert (body.material.kind, len(body.triangles)) == ("dielectric", 12)
    assert (sheet.material.kind, len(sheet.triangles)) == ("thin_dielectric", 2)
    assert sheet.material.parameters["specular_transmittance"].constant == pytest.approx((0.8,) * 3)
