# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""PLY files in all encodings, with all kinds of properties, and damaged ones."""

from __future__ import annotations

import struct
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image as PillowImage

from eclat.errors import EclatError, EclatWarning
from eclat.loaders.ply import load_ply, load_ply_scene
from eclat.scene import Mesh, Scene
from support.mutations import check_mesh, mutated, survives

VERTICES = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
CODES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}
Rows = list[tuple]


def ply(encoding: str, *elements: tuple[str, list[str], Rows]) -> bytes:
    """A PLY file; a row has a number for each property and a tuple for each list."""
    header = ["ply", f"format {encoding} 1.0", "comment made by a test"]
    for name, properties, rows in elements:
        header += [f"element {name} {len(rows)}", *(f"property {p}" for p in properties)]
    data = ("\n".join([*header, "end_header"]) + "\n").encode()
    for _, properties, rows in elements:
        for row in rows:
            data += row_data(encoding, properties, row)
    return data


def row_data(encoding: str, properties: list[str], row: tuple) -> bytes:
    order = ">" if "big" in encoding else "<"
    text, binary = [], b""
    for declared, value in zip(properties, row, strict=True):
        kinds = declared.split()[:-1]
        numbers = value if kinds[0] == "list" else (value,)
        if kinds[0] == "list":
            text.append(len(numbers))
            binary += struct.pack(order + CODES[kinds[1]], len(numbers))
        text += numbers
        binary += struct.pack(order + CODES[kinds[-1]] * len(numbers), *numbers)
    return (" ".join(map(str, text)) + "\n").encode() if encoding == "ascii" else binary


XYZ = ["float x", "float y", "float z"]
FACE = ["list uchar int vertex_indices"]
ENCODINGS = ("ascii", "binary_little_endian", "binary_big_endian")


def load(folder: Path, data: bytes, **options: bool) -> Mesh:
    path = folder / "test.ply"
    path.write_bytes(data)
    mesh = load_ply(path, **options)
    check_mesh(mesh)
    return mesh


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_polygons_of_all_sizes_and_smooth_normals(tmp_path: Path, encoding: str) -> None:
    faces = [((0, 1, 2),), ((0, 1, 2, 3),), ((0, 2, 3),)]
    mesh = load(tmp_path, ply(encoding, ("vertex", XYZ, VERTICES), ("face", FACE, faces)))
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 1, 2], [0, 2, 3], [0, 2, 3]]
    assert mesh.positions.tolist() == [list(map(float, v)) for v in VERTICES]
    assert mesh.positions.dtype.isnative and mesh.positions.dtype == np.float32
    np.testing.assert_allclose(mesh.normals, [(0, 0, 1)] * 4, atol=1e-6)
    assert mesh.material.parameters["reflectance"].constant == (0.5, 0.5, 0.5)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_any_order_of_properties_and_unusual_ones(tmp_path: Path, encoding: str) -> None:
    vertex = ["double z", "uchar blue", "short quality", "list ushort float extra", "double x", "uchar red"]
    vertex += ["float t", "float nx", "float ny", "float nz", "uchar green", "double y", "float s", "uchar alpha"]
    rows = [(z, 0, -5, (1.5,) * i, x, 255, 0.25, 0, 2, 0, 128, y, 0.75, 51) for i, (x, y, z) in enumerate(VERTICES)]
    face = ["uchar red", "list uint ushort vertex_index", "list uchar float texcoord"]
    data = ply(
        encoding, ("camera", ["float f"], [(1,)]), ("vertex", vertex, rows), ("face", face, [(1, (0, 1, 2), (0, 1))])
    )
    with pytest.warns(EclatWarning) as caught:
        mesh = load(tmp_path, data)
    assert [str(w.message) for w in caught] == [
        "test.ply: these properties of faces are ignored, because they are only read from vertices: red, texcoord",
        "test.ply: these unknown elements are ignored: 'camera'",
    ]
    assert mesh.positions.tolist() == [list(map(float, v)) for v in VERTICES]
    assert mesh.uvs.tolist() == [[0.75, 0.25]] * 4
    np.testing.assert_allclose(mesh.normals, [(0, 1, 0)] * 4)
    np.testing.assert_allclose(mesh.colors, [(1, 0.2158605, 0, 0.2)] * 4, atol=1e-6)
    assert mesh.material.vertex_colors and mesh.material.parameters["reflectance"].constant == (1, 1, 1)


def test_uv_is_kept_as_mitsuba_does_and_turned_for_scenes(tmp_path: Path) -> None:
    for u, v in (("s", "t"), ("u", "v"), ("texture_u", "texture_v")):
        vertex = [*XYZ, f"float {u}", f"float {v}"]
        data = ply("ascii", ("vertex", vertex, [(*p, 0.25, 0.75) for p in VERTICES]), ("face", FACE, [((0, 1, 2),)]))
        assert load(tmp_path, data).uvs.tolist() == [[0.25, 0.75]] * 4
        assert load(tmp_path, data, flip_v=True).uvs.tolist() == [[0.25, 0.25]] * 4
        scene = load_ply_scene(tmp_path / "test.ply")
        assert scene.name == "test" and scene.meshes[0].uvs.tolist() == [[0.25, 0.25]] * 4


def test_floating_colours_are_linear(tmp_path: Path) -> None:
    vertex = [*XYZ, "float red", "float green", "float blue"]
    data = ply("ascii", ("vertex", vertex, [(*p, 0.5, 2, -1) for p in VERTICES]), ("face", FACE, [((0, 1, 2),)]))
    with pytest.warns(EclatWarning, match="in 0..1, got up to 2; larger values are clipped"):
        assert load(tmp_path, data).colors.tolist() == [[0.5, 1, 0, 1]] * 4


def test_face_normals_make_it_flat(tmp_path: Path) -> None:
    data = ply("ascii", ("vertex", XYZ, VERTICES), ("face", FACE, [((0, 1, 2),)]))
    assert load(tmp_path, data, face_normals=True).normals is None


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_triangle_strips(tmp_path: Path, encoding: str) -> None:
    strips = [((0, 1, 3, 2, -1, 0, 1, 2),), ((1, 2),), ((1, 2, 3),)]
    mesh = load(
        tmp_path, ply(encoding, ("vertex", XYZ, VERTICES), ("tristrips", ["list int int vertex_indices"], strips))
    )
    assert mesh.triangles.tolist() == [[0, 1, 3], [3, 1, 2], [0, 1, 2], [1, 2, 3]]
    np.testing.assert_allclose(mesh.normals, [(0, 0, 1)] * 4, atol=1e-6)


@pytest.mark.parametrize("newline", [b"\n", b"\r\n", b"\r"])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_any_line_endings_of_the_header(tmp_path: Path, encoding: str, newline: bytes) -> None:
    # The first byte of the data is a line feed, which must not be taken for part of the header.
    first = struct.unpack("<f" if "little" in encoding else ">f", b"\n\0\0\n")[0]
    data = ply(encoding, ("vertex", XYZ, [(first, 0, 0), *VERTICES[1:]]), ("face", FACE, [((0, 1, 2),)]))
    end = data.index(b"end_header\n") + len(b"end_header\n")
    mesh = load(tmp_path, data[:end].replace(b"\n", newline) + data[end:])
    assert mesh.positions[0, 0] == np.float32(first)


HEADER = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
FACES = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
POINTS = "0 0 0\n1 0 0\n0 1 0\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"test\.ply: expected a PLY file, which starts with 'ply', got b''"),
        ("OFF\n3 1 0\n", "expected a PLY file"),
        ("ply\nformat ascii 1.0\n", "expected a PLY header that ends with 'end_header', got none"),
        ("ply\nend_header\n", "expected a 'format' statement"),
        ("ply\nformat binary 1.0\nend_header\n", "line 2: expected format ascii, binary_little_endian"),
        (HEADER + "element face many\nend_header\n", "line 7: expected a number of rows, got 'many'"),
        (HEADER + "element face -1\nend_header\n", "line 7: expected a number of rows, got '-1'"),
        (
            HEADER + "property quad w\nend_header\n",
            "line 7: expected the type and the name of a property, got 'quad w'",
        ),
        (HEADER + "property list float int i\nend_header\n", "line 7: expected the type and the name of a property"),
        (HEADER + "property float x\nend_header\n", "line 7: expected different property names, got 'x' twice"),
        (HEADER + "materials 3\nend_header\n", "line 7: expected a PLY header statement, got 'materials 3'"),
        (HEADER + "end_header\n" + POINTS, "expected a mesh with faces or triangle strips, got only 3 vertices"),
        (HEADER + FACES + POINTS, "element 'face': expected data up to row 1, but the file ends before"),
        (HEADER + FACES + POINTS + "3 0 1\n", "element 'face': expected data up to row 1, but the file ends before"),
        (HEADER + FACES + "0 0 0\n", "element 'vertex': expected data up to row 3, but the file ends before"),
        (HEADER + FACES + POINTS + "3 0 1 3\n", r"face 0: expected vertex indices in 0\.\.2, got 3"),
        (HEADER + FACES + POINTS + "3 0 1 -1\n", r"face 0: expected vertex indices in 0\.\.2, got -1"),
        (
            HEADER + FACES + POINTS + "-3 0 1 2\n",
            "face 0: expected a non-negative length of the list 'vertex_indices', got '-3'",
        ),
        (
            HEADER + FACES + POINTS + "3 0 1 two\n",
            "'face', property 'vertex_indices', number 3: expected a number of type i4, got 'two'",
        ),
        (HEADER + FACES + POINTS + "3 0 1 1e30\n", "number 3: expected a number of type i4"),
        (HEADER + FACES + POINTS.replace("1", "nan") + "3 0 1 2\n", "vertex 1: expected finite coordinates"),
        (HEADER + FACES + POINTS + "3 0 1 1\n", "expected at least one triangle with an area"),
        (
            "ply\nformat ascii 1.0\nelement face 1\nproperty int vertex_indices\nend_header\n3\n",
            "expected at least one vertex",
        ),
    ],
)
def test_errors_say_file_place_and_expectation(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        load(tmp_path, text.encode())


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("element", ["vertex", "face", "other"])
def test_absurd_counts_allocate_no_memory(tmp_path: Path, encoding: str, element: str) -> None:
    faces = [((0, 1, 2),), ((0, 1, 2, 3),)]
    data = ply(encoding, ("vertex", XYZ, VERTICES), ("face", FACE, faces), ("other", ["char c"], [(1,)]))
    position = data.index(f"element {element} ".encode()) + len(f"element {element} ")
    data = data[:position] + b"1000000000000" + data[position + 1 :]
    tracemalloc.start()
    try:
        with pytest.raises(EclatError, match=f"element '{element}': expected data up to row 1000000000000"):
            load(tmp_path, data)
        assert tracemalloc.get_traced_memory()[1] < 4 << 20
    finally:
        tracemalloc.stop()


def test_absurd_lists_allocate_no_memory(tmp_path: Path) -> None:
    data = ply(
        "binary_little_endian", ("vertex", XYZ, VERTICES), ("face", ["list uint int vertex_indices"], [((0, 1, 2),)])
    )
    data = data[: -16 if data.endswith(struct.pack("<Iiii", 3, 0, 1, 2)) else None]
    with pytest.raises(EclatError, match="element 'face': expected data up to row 1"):
        load(tmp_path, data + struct.pack("<Iiii", 0xFFFFFFFF, 0, 1, 2))


def test_absurd_headers_are_refused_at_once(tmp_path: Path) -> None:
    many = "".join(f"property char p{i}\n" for i in range(30_000))
    with pytest.raises(EclatError, match="expected at most 1000 elements with at most 1000 properties"):
        load(tmp_path, (HEADER + many + "end_header\n").encode())


@st.composite
def damaged(draw: st.DrawFn) -> bytes:
    vertex = [*XYZ, "uchar red", "uchar green", "uchar blue", "float s", "float t", "float nx", "float ny", "float nz"]
    rows = [(*p, 9, 99, 255, 0.5, 0.5, 0, 0, 1) for p in VERTICES]
    elements = [("vertex", vertex, rows), ("face", FACE, [((0, 1, 2),), ((0, 1, 2, 3),)])]
    if draw(st.booleans()):
        elements.append(("tristrips", ["list int int vertex_indices"], [((0, 1, 2, -1, 0, 1, 2),)]))
    return draw(mutated(ply(draw(st.sampled_from(ENCODINGS)), *elements)))


@settings(
    derandomize=True, max_examples=400, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(damaged())
def test_damaged_files_never_crash(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "test.ply"
    path.write_bytes(data)
    survives(lambda: [load_ply(path)])


def test_every_real_ply_loads_as_in_mitsuba(scenes: Path) -> None:
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    paths = sorted(scenes.rglob("*.ply"))
    assert paths
    for path in paths:
        mesh = load_ply(path)
        check_mesh(mesh)
        parameters = mitsuba.traverse(mitsuba.load_dict({"type": "ply", "filename": str(path)}))
        used = np.unique(mesh.triangles)
        expected = np.reshape(parameters["vertex_normals"], (-1, 3))
        # One in a hundred of the dragon's vertices lies between triangles back to back, whose sum is rounding noise.
        assert np.quantile(np.abs(mesh.normals[used] - expected[used]).max(axis=1), 0.985) < 1e-5


def textured_scene(folder: Path, data: bytes, names: tuple[str, ...] = ("t.png",)) -> Scene:
    for number, name in enumerate(names):
        PillowImage.fromarray(np.full((2, 2, 3), 100 * (number + 1), np.uint8)).save(folder / name)
    comments = b"".join(b"comment TextureFile " + name.encode() + b"\n" for name in names)
    (folder / "test.ply").write_bytes(data.replace(b"comment made by a test\n", comments))
    return load_ply_scene(folder / "test.ply")


UVS = [(0, 0), (1, 0), (1, 1), (0, 0.25)]


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("names", [("s", "t"), ("u", "v"), ("texture_u", "texture_v")])
def test_a_texture_named_in_a_comment(tmp_path: Path, encoding: str, names: tuple[str, str]) -> None:
    rows = [(*p, *uv) for p, uv in zip(VERTICES, UVS, strict=True)]
    vertex = [*XYZ, *(f"float {name}" for name in names)]
    (mesh,) = textured_scene(
        tmp_path, ply(encoding, ("vertex", vertex, rows), ("face", FACE, [((0, 1, 2, 3),)]))
    ).meshes
    value = mesh.material.parameters["reflectance"]
    assert value.texture is not None and value.texture.srgb and value.texture.image[0, 0].tolist() == [100, 100, 100]
    assert value.constant == (1, 1, 1)
    np.testing.assert_allclose(mesh.uvs, [(u, 1 - v) for u, v in UVS])


@pytest.mark.parametrize(
    "comment", ["comment texture t.png", 'obj_info Texture: "t.png"', "comment texture_file t.png"]
)
def test_other_comments_that_name_a_texture(tmp_path: Path, comment: str) -> None:
    rows = [(*p, *uv) for p, uv in zip(VERTICES, UVS, strict=True)]
    data = ply("ascii", ("vertex", [*XYZ, "float s", "float t"], rows), ("face", FACE, [((0, 1, 2, 3),)]))
    prose = b"comment texture coordinates grow upwards"
    lines = comment.encode() + b"\n" + prose
    (mesh,) = textured_scene(tmp_path, data.replace(b"comment made by a test", lines)).meshes
    value = mesh.material.parameters["reflectance"]
    assert value.texture is not None and value.texture.image[0, 0].tolist() == [100, 100, 100]


def test_the_name_of_a_texture_may_be_quoted(tmp_path: Path) -> None:
    PillowImage.fromarray(np.full((2, 2, 3), 100, np.uint8)).save(tmp_path / "a b.png")
    rows = [(*p, *uv) for p, uv in zip(VERTICES, UVS, strict=True)]
    vertex = [*XYZ, "float s", "float t"]
    data = ply("ascii", ("vertex", vertex, rows), ("face", FACE, [((0, 1, 2, 3),)]))
    path = tmp_path / "test.ply"
    path.write_bytes(data.replace(b"comment made by a test", b'comment TextureFile "a b.png"'))
    (mesh,) = load_ply_scene(path).meshes
    value = mesh.material.parameters["reflectance"]
    assert value.texture is not None and value.texture.image[0, 0].tolist() == [100, 100, 100]


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_textures_by_face_and_their_corners(tmp_path: Path, encoding: str) -> None:
    face = ["list uchar int vertex_indices", "list uchar float texcoord", "int texnumber"]
    faces = [((0, 1, 2), (0, 0, 1, 0, 1, 1), 1), ((0, 2, 3), (0.5, 0, 1, 1, 0, 1), 0)]
    data = ply(encoding, ("vertex", XYZ, VERTICES), ("face", face, faces))
    first, second = textured_scene(tmp_path, data, ("a.png", "b c.png")).meshes
    assert [m.material.name for m in (first, second)] == ["a.png", "b c.png"]
    for mesh, (indices, uvs, _) in zip((first, second), reversed(faces), strict=True):
        corners = mesh.triangles[0]
        np.testing.assert_array_equal(np.asarray(mesh.positions)[corners], [VERTICES[i] for i in indices])
        assert mesh.uvs is not None
        np.testing.assert_allclose(mesh.uvs[corners], [(u, 1 - v) for u, v in zip(uvs[::2], uvs[1::2], strict=True)])


@pytest.mark.parametrize(
    ("vertex", "message"),
    [
        ([], "is ignored, because the file has no texture coordinates"),
        (["float s", "float t", "uchar red", "uchar green", "uchar blue"], "because the file also has a texture"),
    ],
)
def test_textures_with_too_little_or_too_much(tmp_path: Path, vertex: list[str], message: str) -> None:
    rows = [(*p, *((0, 0, 9, 9, 9) if vertex else ())) for p in VERTICES]
    with pytest.warns(EclatWarning, match=message):
        textured_scene(tmp_path, ply("ascii", ("vertex", [*XYZ, *vertex], rows), ("face", FACE, [((0, 1, 2),)])))


def test_a_missing_texture_has_a_stand_in(tmp_path: Path) -> None:
    rows = [(*p, 0, 0) for p in VERTICES]
    data = ply("ascii", ("vertex", [*XYZ, "float s", "float t"], rows), ("face", FACE, [((0, 1, 2),)]))
    (tmp_path / "test.ply").write_bytes(data.replace(b"comment made by a test", b"comment TextureFile gone.png"))
    with pytest.warns(EclatWarning, match="a mauve and grey checkerboard is used instead"):
        load_ply_scene(tmp_path / "test.ply")


@pytest.mark.parametrize("kind", ["float", "double", "int", "ushort"])
def test_colours_in_bytes_of_another_type(tmp_path: Path, kind: str) -> None:
    vertex = [*XYZ, *(f"{kind} {name}" for name in ("red", "green", "blue"))]
    data = ply("ascii", ("vertex", vertex, [(*p, 128, 64, 0) for p in VERTICES]), ("face", FACE, [((0, 1, 2),)]))
    with pytest.warns(EclatWarning, match="they are taken for numbers in 0..255"):
        mesh = load(tmp_path, data)
    assert mesh.colors is not None
    np.testing.assert_allclose(mesh.colors[0, :3], (0.215861, 0.051269, 0), atol=1e-5)


def test_text_of_windows(tmp_path: Path) -> None:
    vertex = [*XYZ, "float nx", "float ny", "float nz"]
    data = ply("ascii", ("vertex", vertex, [(*p, 0, 0, 1) for p in VERTICES]), ("face", FACE, [((0, 1, 2),)]))
    data = data.replace(b"0 0 1\n", b"-nan(ind) 1.#QNAN 0\n", 1)
    with pytest.warns(EclatWarning, match="1 normals are not finite"):
        load(tmp_path, data.decode().encode("utf-16"))


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_quad_beside_a_face_of_two_corners_is_cut(tmp_path: Path, encoding: str) -> None:
    faces: Rows = [((0, 1, 2, 3),), ((0, 1),)]
    with pytest.warns(EclatWarning, match="1 faces of fewer than three corners"):
        mesh = load(tmp_path, ply(encoding, ("vertex", XYZ, VERTICES), ("face", FACE, faces)))
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_many_triangles_are_read_in_proportion_to_their_file(tmp_path: Path) -> None:
    size = 300
    rows, columns = np.mgrid[0:size, 0:size]
    points = np.stack([rows, columns, 0.3 * np.sin(rows)], axis=-1).reshape(-1, 3).astype("<f4")
    first = (rows * size + columns)[:-1, :-1].ravel()
    table = np.zeros(2 * len(first), [("count", "u1"), ("items", "<i4", 3)])
    table["count"] = 3
    table["items"] = np.concatenate(
        [np.stack([first, first + size, first + 1], 1), np.stack([first + 1, first + size, first + size + 1], 1)]
    )
    header = ply("binary_little_endian", ("vertex", XYZ, []), ("face", FACE, []))
    header = header.replace(b"vertex 0", b"vertex %d" % len(points)).replace(b"face 0", b"face %d" % len(table))
    (tmp_path / "a.ply").write_bytes(header + points.tobytes() + table.tobytes())
    load_ply(tmp_path / "a.ply")
    tracemalloc.start()
    mesh = load_ply(tmp_path / "a.ply")
    kept, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    check_mesh(mesh)
    assert kept < 40 * len(table) and peak < 200 * len(table)
