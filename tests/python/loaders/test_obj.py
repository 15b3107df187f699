# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""OBJ files, tidy, dirty and hostile."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from eclat.errors import EclatError, EclatWarning
from eclat.loaders.obj import load_obj, load_obj_scene
from eclat.scene import Mesh
from support.mutations import check_mesh, mutated, survives

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

RICH = b"""# a comment
mtllib absent.mtl
o thing
v 0 0 0
v 1 0 0 0.5 0.5 0.5
v 1 1 0
v 0 1 0
vt 0 0
vt 1 0
vt 1 1
vn 0 0 2
usemtl one
s 1
f 1/1/1 2/2/1 3/3/1
usemtl two
f -4//-1 -2//-1 \\
  -1//-1
l 1 2
f 1 2 3 4
"""


def write(folder: Path, text: str | bytes, name: str = "test.obj") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def only(folder: Path, text: str | bytes, **options: bool) -> Mesh:
    (mesh,) = load_obj(write(folder, text), **options)
    check_mesh(mesh)
    return mesh


def test_a_square_is_two_flat_grey_triangles(tmp_path: Path) -> None:
    scene = load_obj_scene(write(tmp_path, SQUARE + "f 1 2 3 4\n", "square.obj"))
    (mesh,) = scene.meshes
    assert scene.name == mesh.name == "square"
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert mesh.normals is None and mesh.uvs is None and mesh.colors is None
    assert mesh.material.two_sided and mesh.material.parameters["reflectance"].constant == (0.5, 0.5, 0.5)


def test_negative_indices_count_from_the_line_they_stand_on(tmp_path: Path) -> None:
    mesh = only(tmp_path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf -3 -2 -1\n")
    assert mesh.positions[mesh.triangles][:, :, 2].tolist() == [[0, 0, 0], [1, 1, 1]]


def test_uv_is_turned_to_our_orientation_unless_told_not_to(tmp_path: Path) -> None:
    text = SQUARE + "vt 0.25 0.75\nf 1/1 2/1 3/1\n"
    assert only(tmp_path, text).uvs.tolist() == [[0.25, 0.25]] * 3
    assert only(tmp_path, text, flip_v=False).uvs.tolist() == [[0.25, 0.75]] * 3


def test_normals_are_made_unit(tmp_path: Path) -> None:
    mesh = only(tmp_path, SQUARE + "vn 0 3 4\nf 1//1 2//1 3//1\n")
    np.testing.assert_allclose(mesh.normals, [(0, 0.6, 0.8)] * 3, atol=1e-6)
    assert only(tmp_path, SQUARE + "vn 0 3 4\nf 1//1 2//1 3//1\n", face_normals=True).normals is None


def test_corners_without_normal_and_normals_of_length_zero_take_the_face_s(tmp_path: Path) -> None:
    text = SQUARE + "v 0 1 1\nvn 0 3 4\nvn 0 0 0\nf 1//1 2//2 3//1\nf 1 3 5\n"
    mesh = only(tmp_path, text)
    slanted = np.cross((1, 1, 0), (0, 1, 1)) / np.sqrt(3)
    expected = [[(0, 0.6, 0.8), (0, 0, 1), (0, 0.6, 0.8)], [slanted] * 3]
    np.testing.assert_allclose(mesh.normals[mesh.triangles], expected, atol=1e-6)


def test_a_folded_face_among_smooth_faces_gets_a_normal(tmp_path: Path) -> None:
    text = SQUARE + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3 2\nf 1 2 4 3\n"
    only(tmp_path, text)


def test_a_material_without_normals_stays_flat_beside_one_with(tmp_path: Path) -> None:
    path = write(tmp_path, SQUARE + "vn 0 0 1\nusemtl a\nf 1//1 2//1 3//1\nusemtl b\nf 1 3 4\n")
    with pytest.warns(EclatWarning, match="material '[ab]' is not defined in any MTL file"):
        a, b = load_obj(path)
    assert a.normals is not None and b.normals is None


def test_smooth_computes_what_mitsuba_computes(tmp_path: Path) -> None:
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvt 0 0\nvt 1 0\nf 1/1 2/1 3/1\nf 1/1 3/1 4/2\n"
    path = write(tmp_path, text)
    (mesh,) = load_obj(path, smooth=True, materials=False)
    parameters = mitsuba.traverse(mitsuba.load_dict({"type": "obj", "filename": str(path)}))
    np.testing.assert_allclose(mesh.normals, np.reshape(parameters["vertex_normals"], (-1, 3)), atol=1e-6)
    np.testing.assert_allclose(mesh.uvs, np.reshape(parameters["vertex_texcoords"], (-1, 2)), atol=1e-6)
    assert load_obj(path)[0].normals is None


def test_shared_corners_become_shared_vertices(tmp_path: Path) -> None:
    mesh = only(tmp_path, SQUARE + "vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/1 3/1 4/1\nf 1/2 2/1 4/1\n")
    assert len(mesh.positions) == 5


def test_meshes_follow_materials_and_are_named_after_single_groups(tmp_path: Path) -> None:
    text = SQUARE + "g left\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 2 4\ng right  part\nusemtl red\nf 2 3 4\nf 1 3 4\n"
    with pytest.warns(EclatWarning):
        red, blue = load_obj(write(tmp_path, text))
    assert (red.material.name, red.name, len(red.triangles)) == ("red", "red", 3)
    assert (blue.material.name, blue.name, len(blue.triangles)) == ("blue", "left", 1)
    (whole,) = load_obj(write(tmp_path, text), materials=False)
    assert len(whole.triangles) == 4 and whole.material.name == ""


def test_unusual_but_valid_text_is_read(tmp_path: Path) -> None:
    text = (
        b"\xef\xbb\xbf# caf\xe9\r\n\r\n\tv\t0 0\t0 # origin\r\nv 1 0 0 \\\r\n\r\nv 1 1 0 1.0\r\nv 0 1 0\r\n"
        b"g caf\xe9\r\nvt 0.5\r\nvt 0.5 0.5 0\r\nf 1/1/ 2/2/ \\\r\n 3/2 # first\r\nf 1/1 3// 4"
    )
    mesh = only(tmp_path, text)
    assert len(mesh.triangles) == 2
    assert mesh.name == "café"
    assert np.allclose(mesh.uvs[mesh.triangles[0]], [(0.5, 1), (0.5, 0.5), (0.5, 0.5)])


def test_vertex_colours_are_srgb_and_white_where_missing(tmp_path: Path) -> None:
    mesh = only(tmp_path, "v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n")
    np.testing.assert_allclose(mesh.colors, [(1, 0.21404, 0, 1), (1, 1, 1, 1), (0, 0, 0, 1)], atol=1e-5)
    assert mesh.material.vertex_colors
    assert mesh.material.parameters["reflectance"].constant == (1, 1, 1)


def test_vertex_colours_of_zbrush(tmp_path: Path) -> None:
    mesh = only(tmp_path, "v 0 0 0\nv 1 0 0\nv 0 1 0\n#MRGB ffff8000ffFFFFFF\n#MRGB 00000000\nf 1 2 3\n")
    np.testing.assert_allclose(mesh.colors, [(1, 0.21586, 0, 1), (1, 1, 1, 1), (0, 0, 0, 1)], atol=1e-5)
    assert mesh.material.vertex_colors


@pytest.mark.parametrize(
    ("rgb", "digits", "reason"),
    [
        ("", "ffff8000", "eight hexadecimal digits for each of the 3 vertices"),
        ("", "ffff8000" * 2 + "pink8000", "eight hexadecimal digits"),
        (" 1 0 0", "ffff8000" * 3, "have colours of their own"),
    ],
)
def test_vertex_colours_of_zbrush_that_do_not_fit(tmp_path: Path, rgb: str, digits: str, reason: str) -> None:
    with pytest.warns(EclatWarning, match=rf"#MRGB comments are ignored, because .*{reason}") as caught:
        mesh = only(tmp_path, f"v 0 0 0{rgb}\nv 1 0 0{rgb}\nv 0 1 0{rgb}\n#MRGB {digits}\nf 1 2 3\n")
    assert len(caught) == 1 and (mesh.colors is not None) == bool(rgb)


def test_unknown_statements_are_named_once_each(tmp_path: Path) -> None:
    text = SQUARE + "curv 0 1\ncurv 2 3\np 1\nf 1 2 3\n"
    with pytest.warns(EclatWarning, match=r"test\.obj: .*ignored: 'curv' \(line 5\), 'p' \(line 7\)$"):
        only(tmp_path, text)


def test_flat_triangles_and_short_faces_are_left_out(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="1 triangles of zero area and 2 faces of fewer than three corners"):
        mesh = only(tmp_path, SQUARE + "f 1 2 3\nf 1 1 2\nf 1 2\nf\n")
    assert len(mesh.triangles) == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"test\.obj: expected an OBJ file with vertices \(v\) and faces \(f\), got 0 vertices and 0 faces"),
        (SQUARE, "got 4 vertices and 0 faces"),
        (SQUARE + "f 1 2 5\n", r"test\.obj, line 5: expected a v index in 1\.\.4 .*, got 5"),
        (SQUARE + "f 1 2 0\n", r"line 5: expected a v index .*, got 0"),
        (SQUARE + "f 1 2 -5\n", r"line 5: expected a v index .*, got -5"),
        (SQUARE + "f 1/1 2/1 3/1\n", r"line 5: expected a vt index in 1\.\.0"),
        (SQUARE + "vn 0 0 1\nf 1//1 2//1 3//2\n", r"line 6: expected a vn index in 1\.\.1 .*, got 2"),
        (SQUARE + "f 1 2 3\nf 1 2 99999999999999999999999\n", r"line 6: expected a v index"),
        (SQUARE + "f 1 2 x\n", r"line 5: expected a face corner like 7, .*, got 'x'"),
        (SQUARE + "f 1 2 3/4/5/6\n", "line 5: expected a face corner"),
        (SQUARE + "f 1 2 1.5\n", "line 5: expected a face corner"),
        ("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", r"line 2: expected finite coordinates .*, got 1 nan 0"),
        ("v 0 0 0\nv 1 0 1e99\nv 0 1 0\nf 1 2 3\n", "line 2: expected finite coordinates"),
        ("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", "line 1: expected 3 or more numbers after v, got '0 0'"),
        ("v 0 0 0\nv 1 zero 0\nv 0 1 0\nf 1 2 3\n", "line 2: expected 3 or more numbers after v, got '1 zero 0'"),
        ("v\nf 1 1 1\n", "line 1: expected 3 or more numbers after v"),
        (SQUARE + "vt\nf 1/1 2/1 3/1\n", "line 5: expected 1 or more numbers after vt"),
        (SQUARE + "f 1 1 2\n", "expected at least one triangle with an area"),
    ],
)
def test_errors_say_file_line_and_expectation(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        load_obj(write(tmp_path, text))


def test_the_line_of_an_error_is_right_after_a_continued_line(tmp_path: Path) -> None:
    with pytest.raises(EclatError, match="line 6: expected a v index"):
        load_obj(write(tmp_path, "v 0 0 \\\n 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 \\\n 9\n"))


def test_binary_junk_is_an_error(tmp_path: Path) -> None:
    junk = np.random.default_rng(1).integers(0, 256, 20_000, dtype=np.uint8).tobytes()
    with pytest.warns(EclatWarning, match="more kinds"), pytest.raises(EclatError, match="expected an OBJ file"):
        load_obj(write(tmp_path, junk))


@settings(
    derandomize=True, max_examples=250, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(mutated(RICH))
def test_damaged_files_never_crash(tmp_path: Path, data: bytes) -> None:
    path = write(tmp_path, data)
    survives(lambda: load_obj(path))
    survives(lambda: load_obj(path, materials=False, smooth=True))


def test_two_hundred_thousand_faces(tmp_path: Path) -> None:
    side = 318
    rows, columns = np.divmod(np.arange(side * side), side)
    points = "".join(f"v {x} {y} 0\nvt {x} {y}\n" for x, y in zip(columns.tolist(), rows.tolist(), strict=True))
    corner = np.arange(side * side).reshape(side, side)[:-1, :-1].ravel() + 1
    faces = "".join(f"f {i}/{i} {i + 1}/{i + 1} {i + side}/{i + side}\n" for i in corner.tolist())
    path = write(tmp_path, points + 2 * faces)
    (mesh,) = load_obj(path)
    assert len(mesh.triangles) == 2 * len(corner)


@pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")
def test_every_real_obj_loads(scenes: Path) -> None:
    paths = sorted(scenes.rglob("*.obj"))
    assert len(paths) > 10
    for path in paths:
        meshes = load_obj(path)
        for mesh in meshes:
            check_mesh(mesh)
        ignoring_material = load_obj(path, materials=False)
        assert sum(len(mesh.triangles) for mesh in meshes) == len(ignoring_material[0].triangles)


PYRAMID = "v 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\n"
SIDES = ["f 1 2 3\n", "f 1 3 4\n", "f 1 4 5\n", "f 1 5 2\n"]


def normals_at(mesh: Mesh, place: tuple[float, float, float]) -> np.ndarray:
    assert mesh.normals is not None
    return mesh.normals[(np.asarray(mesh.positions) == place).all(axis=1)]


def test_smoothing_groups_average_normals(tmp_path: Path) -> None:
    mesh = only(tmp_path, "s 1\n" + PYRAMID + "".join(SIDES))
    assert len(mesh.positions) == 5
    np.testing.assert_allclose(normals_at(mesh, (0, 0, 1)), [[0, 0, 1]], atol=1e-6)
    # The mean of (1, 1, 1)/√3 and (1, −1, 1)/√3.
    np.testing.assert_allclose(normals_at(mesh, (1, 0, 0)), [[2**-0.5, 0, 2**-0.5]], atol=1e-6)


@pytest.mark.parametrize("off", ["s off", "s 0", "s"])
def test_smoothing_ends_where_it_is_switched_off(tmp_path: Path, off: str) -> None:
    assert only(tmp_path, "s 1\n" + off + "\n" + PYRAMID + "".join(SIDES)).normals is None
    mesh = only(tmp_path, "s 1\n" + PYRAMID + SIDES[0] + SIDES[1] + off + "\n" + SIDES[2] + SIDES[3])
    # Two sides share a normal at the tip, (0, 1, 1)/√2; the other two have their own.
    expected = np.array([[-1, -1, 1], [1, -1, 1], [0, 1.5**0.5, 1.5**0.5]]) / 3**0.5
    found = normals_at(mesh, (0, 0, 1))
    np.testing.assert_allclose(found[np.lexsort(found.T[::-1])], expected[np.lexsort(expected.T[::-1])], atol=1e-6)


def test_smoothing_groups_end_at_each_other_and_go_across_materials(tmp_path: Path) -> None:
    apart = only(tmp_path, PYRAMID + "s 1\n" + SIDES[0] + SIDES[1] + "s 2\n" + SIDES[2] + SIDES[3])
    found = normals_at(apart, (0, 0, 1))
    np.testing.assert_allclose(found[np.argsort(found[:, 1])], np.array([[0, -1, 1], [0, 1, 1]]) / 2**0.5, atol=1e-6)
    with pytest.warns(EclatWarning, match="not defined in any MTL file"):
        two = load_obj(
            write(tmp_path, PYRAMID + "s 1\nusemtl a\n" + SIDES[0] + SIDES[1] + "usemtl b\n" + SIDES[2] + SIDES[3])
        )
    for mesh in two:
        np.testing.assert_allclose(normals_at(mesh, (0, 0, 1)), [[0, 0, 1]], atol=1e-6)


def test_normals_of_the_file_come_before_smoothing_groups(tmp_path: Path) -> None:
    mesh = only(tmp_path, PYRAMID + "vn 0 1 0\ns 1\nf 1//1 2//1 3//1\n" + SIDES[1])
    np.testing.assert_allclose(
        np.unique(normals_at(mesh, (0, 0, 1)), axis=0), [[0, 2**-0.5, 2**-0.5], [0, 1, 0]], atol=1e-6
    )
    smooth = only(tmp_path, PYRAMID + "s 1\n" + "".join(SIDES), face_normals=True)
    assert smooth.normals is None


@pytest.mark.parametrize("word", ["-nan(ind)", "nan", "-1.#IND", "1.#QNAN", "1.#INF00", "-nan(snan)"])
def test_normals_that_are_no_numbers_leave_the_face_flat(tmp_path: Path, word: str) -> None:
    faces = "f 1//1 2//1 3//1 4//1\n"
    with pytest.warns(EclatWarning, match=r"1 normals \(vn\) are not finite"):
        assert only(tmp_path, SQUARE + f"vn {word} {word} 0\n" + faces).normals is None
    with pytest.raises(EclatError, match="line 1: expected finite coordinates"):
        only(tmp_path, f"v {word} 0 0\n" + SQUARE + "f 1 2 3\n")
    with pytest.warns(EclatWarning, match="texture coordinates"):
        only(tmp_path, SQUARE + f"vt {word} 0\nf 1/1 2/1 3/1\n")


@pytest.mark.parametrize(
    ("color", "expected"),
    [
        ("128 64 0", (0.215861, 0.051269, 0)),
        ("127.5 64 0", (0.214041, 0.051269, 0)),
        ("255 255 255", (1, 1, 1)),
        ("0.5 0.25 0", (0.214041, 0.050876, 0)),
    ],
)
def test_vertex_colours_in_bytes(tmp_path: Path, color: str, expected: tuple[float, float, float]) -> None:
    text = "".join(f"v {p} {color}\n" for p in ("0 0 0", "1 0 0", "1 1 0")) + "f 1 2 3\n"
    if "." in color and color[0] == "0":
        mesh = only(tmp_path, text)
    else:
        with pytest.warns(
            EclatWarning, match=r"vertex colours in 0..1, got up to .*; they are taken for numbers in 0..255"
        ):
            mesh = only(tmp_path, text)
    assert mesh.colors is not None
    np.testing.assert_allclose(mesh.colors[:, :3], np.tile(expected, (3, 1)), atol=1e-5)


def test_vertex_colours_above_one_are_clamped_with_a_warning(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="expected vertex colours in 0..1, got up to 1.5; larger values are clipped"):
        only(tmp_path, "v 0 0 0 1.5 0 0\nv 1 0 0 1 1 1\nv 1 1 0 1 1 1\nf 1 2 3\n")


def test_utf16(tmp_path: Path) -> None:
    (tmp_path / "m.mtl").write_bytes("newmtl Wände\nKd 1 0 0\n".encode("utf-16"))
    mesh = only(tmp_path, ("mtllib m.mtl\nusemtl Wände\n" + SQUARE + "f 1 2 3 4\n").encode("utf-16"))
    assert mesh.material.name == "Wände" and mesh.material.parameters["reflectance"].constant == (1, 0, 0)


@pytest.mark.parametrize(
    "face", ["f 1//0 2//0 3//0 4//0", "f 1/1/0 2/1/0 3/1/0", "f 1/0/1 2/0/1 3/0/1", "f 1/0 2/0 3/0"]
)
def test_index_zero_of_an_attribute_is_a_missing_one(tmp_path: Path, face: str) -> None:
    with pytest.warns(EclatWarning, match="face corners have the index 0 of vt or vn .the first one in line 7, v"):
        mesh = only(tmp_path, SQUARE + "vt 0 0\nvn 0 0 1\n" + face + "\n")
    assert (mesh.normals is None) == ("/0/1" not in face)
    assert (mesh.uvs is None) == ("/1/" not in face)
    with pytest.raises(EclatError, match=r"expected a v index in 1\.\.4"):
        only(tmp_path, SQUARE + "f 0 1 2\n")
