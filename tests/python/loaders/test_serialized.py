# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mitsuba's .serialized meshes: written here, read there; damaged and hostile ones."""

from __future__ import annotations

import struct
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from eclat.errors import EclatError
from eclat.loaders.serialized import load_serialized
from eclat.scene import Mesh
from support.mutations import check_mesh, mutated, survives

POSITIONS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.5)])
TRIANGLES = np.array([(0, 1, 2), (0, 2, 3)])


def body(
    version: int = 4, flags: int = 0x1000, *tables: np.ndarray, triangles: np.ndarray = TRIANGLES, name: str = "façade"
) -> bytes:
    """What is compressed: header, positions, the given tables, triangles."""
    real = "<f8" if flags & 0x2000 else "<f4"
    data = struct.pack("<I", flags) + (name.encode() + b"\0" if version == 4 else b"")
    data += struct.pack("<QQ", len(POSITIONS), len(triangles))
    return data + b"".join(t.astype(real).tobytes() for t in (POSITIONS, *tables)) + triangles.astype("<u4").tobytes()


def container(version: int, *bodies: bytes) -> bytes:
    data, offsets = b"", []
    for shape in bodies:
        offsets.append(len(data))
        data += struct.pack("<HH", 0x041C, version) + zlib.compress(shape)
    return (
        data + struct.pack(f"<{len(offsets)}{'Q' if version == 4 else 'I'}", *offsets) + struct.pack("<I", len(bodies))
    )


def load(folder: Path, data: bytes, shape_index: int = 0, **options: bool) -> Mesh:
    path = folder / "test.serialized"
    path.write_bytes(data)
    mesh = load_serialized(path, shape_index, **options)
    check_mesh(mesh)
    return mesh


@pytest.mark.parametrize("version", [3, 4])
@pytest.mark.parametrize("precision", [0x1000, 0x2000])
def test_both_versions_and_precisions(tmp_path: Path, version: int, precision: int) -> None:
    normals, uvs, colors = np.full((4, 3), (0, 3, 4)), np.full((4, 2), (0.25, 0.75)), np.full((4, 3), 0.5)
    full = body(version, precision | 0xB, normals, uvs, colors)
    data = container(version, body(version, precision, triangles=TRIANGLES[:1]), full)
    mesh = load(tmp_path, data, 1)
    assert mesh.positions.tolist() == POSITIONS.tolist()
    assert mesh.positions.dtype == (np.float64 if precision == 0x2000 else np.float32)
    assert mesh.triangles.tolist() == TRIANGLES.tolist()
    np.testing.assert_allclose(mesh.normals, [(0, 0.6, 0.8)] * 4, atol=1e-6)
    assert mesh.uvs.tolist() == [[0.25, 0.75]] * 4
    assert mesh.colors.tolist() == [[0.5, 0.5, 0.5, 1]] * 4
    assert mesh.name == ("façade" if version == 4 else "test[1]")
    assert len(load(tmp_path, data, 0).triangles) == 1


def test_normals_are_computed_unless_flat(tmp_path: Path) -> None:
    assert load(tmp_path, container(4, body())).normals is not None
    assert load(tmp_path, container(4, body()), face_normals=True).normals is None
    assert load(tmp_path, container(4, body(4, 0x1010))).normals is None


def test_mitsuba_reads_the_same(tmp_path: Path) -> None:
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    uvs = np.random.default_rng(0).random((4, 2))
    mesh = load(tmp_path, container(4, body(), body(4, 0x1002, uvs)), 1)
    theirs = {"type": "serialized", "filename": str(tmp_path / "test.serialized"), "shape_index": 1}
    parameters = mitsuba.traverse(mitsuba.load_dict(theirs))
    np.testing.assert_allclose(mesh.positions, np.reshape(parameters["vertex_positions"], (-1, 3)))
    np.testing.assert_allclose(mesh.uvs, np.reshape(parameters["vertex_texcoords"], (-1, 2)))
    np.testing.assert_allclose(mesh.normals, np.reshape(parameters["vertex_normals"], (-1, 3)), atol=1e-6)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", r"test\.serialized: expected a \.serialized file, got 0 bytes"),
        (b"PK\3\4" + bytes(20), r"expected Mitsuba's \.serialized format, version 3 or 4 \(0x041c\), got 0x4b50"),
        (container(4, body())[:-9], "the file may be truncated"),
        (container(5, body()), "version 3 or 4 .*, got 0x041c, version 5"),
        (container(4, body(4, 0)), "shape 0: expected flags for either single or double precision, got 0x0"),
        (container(4, body(4, 0x3000)), "expected flags for either single or double precision"),
        (container(4, body()[:-4]), "shape 0: expected 4 more bytes of mesh data; the data are truncated"),
        (container(4, body(triangles=TRIANGLES + 2)), r"triangle 0: expected vertex indices in 0\.\.3, got 4"),
        (container(4, body(triangles=TRIANGLES[:0])), "expected at least one triangle with an area"),
        (container(4, body(name="x" * 5000)), "expected a name of at most 4096 bytes"),
        (
            container(4, b"")[:-12] + struct.pack("<QI", 9999, 1),
            "expected shape 0 within the first 12 bytes of the file",
        ),
    ],
)
def test_errors_say_file_shape_and_expectation(tmp_path: Path, data: bytes, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        load(tmp_path, data)


@pytest.mark.parametrize("index", [-1, 2, 10**12])
def test_shape_indices_out_of_range(tmp_path: Path, index: int) -> None:
    with pytest.raises(EclatError, match=rf"test\.serialized: expected a shape index in 0\.\.1, got {index}"):
        load(tmp_path, container(4, body(), body()), index)


def test_corruption_is_found_by_the_checksum(tmp_path: Path) -> None:
    stored = zlib.compressobj(0)
    data = bytearray(container(4, body()))
    raw = stored.compress(body()) + stored.flush()
    data = bytearray(struct.pack("<HH", 0x041C, 4) + raw + struct.pack("<QI", 0, 1))
    data[60] ^= 1
    with pytest.raises(EclatError, match="shape 0: the compressed data are corrupted"):
        load(tmp_path, bytes(data))


@pytest.mark.parametrize("counts", [(10**12, 1), (4, 10**12), (2**64 - 1, 2**64 - 1), (3_000_000, 10)])
def test_counts_that_exceed_the_file_allocate_no_memory(tmp_path: Path, counts: tuple[int, int]) -> None:
    bomb = struct.pack("<I", 0x1000) + b"\0" + struct.pack("<QQ", *counts) + bytes(1000)
    tracemalloc.start()
    try:
        with pytest.raises(EclatError, match=r"is more than .* compressed bytes can contain"):
            load(tmp_path, container(4, bomb))
        assert tracemalloc.get_traced_memory()[1] < 4 << 20
    finally:
        tracemalloc.stop()


def test_a_zlib_bomb_is_decompressed_no_further_than_its_header_says(tmp_path: Path) -> None:
    data = container(4, body() + bytes(200 << 20))
    tracemalloc.start()
    try:
        assert len(load(tmp_path, data).triangles) == 2
        assert tracemalloc.get_traced_memory()[1] < 16 << 20
    finally:
        tracemalloc.stop()


@settings(
    derandomize=True, max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(mutated(container(4, body(), body(4, 0x1002, np.zeros((4, 2))))))
def test_damaged_files_never_crash(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "test.serialized"
    path.write_bytes(data)
    survives(lambda: [load_serialized(path, 1)])


@settings(
    derandomize=True, max_examples=250, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(mutated(body(4, 0x100B, np.ones((4, 3)), np.ones((4, 2)), np.ones((4, 3)))))
def test_damaged_contents_never_crash(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "test.serialized"
    path.write_bytes(container(4, data))
    survives(lambda: [load_serialized(path)])


def test_real_shapes_are_those_of_mitsuba(scenes: Path) -> None:
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    path = scenes / "sponza-dabrovic" / "sponza.serialized"
    total = 0
    for index in range(37):
        mesh = load_serialized(path, index)
        check_mesh(mesh)
        total += len(mesh.triangles)
        theirs = mitsuba.load_dict({"type": "serialized", "filename": str(path), "shape_index": index})
        parameters = mitsuba.traverse(theirs)
        assert np.array_equal(mesh.positions, np.reshape(parameters["vertex_positions"], (-1, 3)))
        np.testing.assert_allclose(mesh.normals, np.reshape(parameters["vertex_normals"], (-1, 3)), atol=1e-5)
        np.testing.assert_allclose(mesh.uvs, np.reshape(parameters["vertex_texcoords"], (-1, 2)), atol=1e-6)
    assert total == 66445
