# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Broken and hostile glTF files: an EclatError that says where, or a scene; nothing else."""

from __future__ import annotations

import json
import tracemalloc
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from eclat.errors import EclatError, EclatWarning
from eclat.loaders import load
from eclat.loaders.gltf import load_gltf
from support.gltf_files import GltfFile


def saved(data: bytes | str, folder: Path, name: str = "scene.gltf") -> Path:
    path = folder / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


def rich_file() -> GltfFile:
    """A little of everything."""
    file = GltfFile()
    texture = {"index": file.texture(np.full((4, 4, 4), 128), wrapS=33071)}
    pbr = {"baseColorTexture": texture, "metallicRoughnessTexture": texture, "roughnessFactor": 0.5}
    file.append("materials", {"pbrMetallicRoughness": pbr, "normalTexture": texture, "alphaMode": "MASK"})
    primitive = file.primitive(indices=[0, 1, 2], material=0)
    primitive["attributes"] |= {
        "NORMAL": file.accessor([[0, 0, 1]] * 3),
        "TANGENT": file.accessor([[1, 0, 0, 1]] * 3),
        "TEXCOORD_0": file.accessor([[0, 0], [65535, 0], [0, 65535]], "u2", normalized=True),
        "COLOR_0": file.accessor([[255, 255, 0, 255]] * 3, "u1", normalized=True),
    }
    file.mesh_node(primitive, rotation=[0, 0, 0, 1], scale=[1, -1, 1])
    file.append("cameras", {"type": "perspective", "perspective": {"yfov": 1, "znear": 1}})
    file.append("nodes", {"camera": 0, "children": [0], "matrix": np.eye(4).ravel().tolist()})
    lights = {"lights": [{"type": "spot", "spot": {"outerConeAngle": 0.5}}]}
    file.json["extensions"] = {"KHR_lights_punctual": lights}
    file.append("nodes", {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 1, 0]})
    file.json |= {"scenes": [{"nodes": [1, 2]}], "scene": 0, "extensionsUsed": ["KHR_lights_punctual"]}
    return file


RICH = rich_file().glb()


def load_or_refuse(path: Path) -> None:
    """Anything but success and EclatError fails the test; so do Python's own warnings."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", EclatWarning)
        try:
            scene = load_gltf(path)
        except EclatError as error:
            assert path.name in str(error)
            return
    for mesh in scene.meshes:
        assert np.isfinite(mesh.positions).all()
        assert mesh.triangles.min() >= 0 and mesh.triangles.max() < len(mesh.positions)


fuzz = settings(
    max_examples=300,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


@fuzz
@given(changes=st.lists(st.tuples(st.integers(0, len(RICH) - 1), st.integers(0, 255)), min_size=1, max_size=4))
def test_files_with_changed_bytes(tmp_path: Path, changes: list[tuple[int, int]]) -> None:
    data = bytearray(RICH)
    for place, byte in changes:
        data[place] = byte
    load_or_refuse(saved(bytes(data), tmp_path, "scene.glb"))


@fuzz
@given(length=st.integers(0, len(RICH) - 1), tail=st.binary(max_size=8))
def test_files_that_are_cut_off(tmp_path: Path, length: int, tail: bytes) -> None:
    load_or_refuse(saved(RICH[:length] + tail, tmp_path, "scene.glb"))


ODD = st.sampled_from(
    [None, True, -1, 0, 1, 2, 3, 1.5, 10**9, 10**30, 1e300, "x", "../x", "data:,", [], [0], [1e38] * 3, {}]
)


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The paths of all values in a JSON document."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(place for key, item in items for place in places(item, (*path, key)))]


@fuzz
@given(data=st.data())
def test_json_with_odd_values(tmp_path: Path, data: st.DataObject) -> None:
    file = rich_file()
    for place in data.draw(st.lists(st.sampled_from(places(file.json)[1:]), min_size=1, max_size=3)):
        owner: Any = file.json
        try:
            for key in place[:-1]:
                owner = owner[key]
            owner[place[-1]] = data.draw(ODD)
        except (TypeError, LookupError):
            continue  # an earlier change took this place away
    load_or_refuse(file.save(tmp_path))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "expected a glTF file, got an empty file"),
        (b"glTF", "expected a GLB header"),
        (b"[]", "expected a JSON object, got list"),
        (b"{", "expected valid JSON"),
        (b'{"asset": NaN}', "JSON does not allow the number NaN"),
        (b'"\xff"', "expected JSON in UTF-8, got the byte 0xff"),
        (b"[" * 100_000, "nested too deeply"),
        (b'{"a":' * 100_000, "nested too deeply"),
        (b'{"asset": {"version": "1.0"}}', "expected glTF version 2.x, got '1.0'"),
        (b'{"asset": {"version": "2.0"}, "nodes": 3}', "nodes: expected a list, got 3"),
        (RICH[:4] + b"\x01" + RICH[5:], "expected GLB version 2, got 1"),
        (RICH[:100], "the file is truncated"),
        (RICH[:12] + b"\xff\xff\xff\x7f" + RICH[16:], "expected a chunk of 2147483647 bytes at offset 12"),
        (RICH[:16] + b"ABCD" + RICH[20:], "expected a JSON chunk as the first chunk"),
    ],
)
def test_broken_containers(tmp_path: Path, data: bytes, message: str) -> None:
    with pytest.raises(EclatError, match=message) as caught:
        load_gltf(saved(data, tmp_path))
    assert str(caught.value).startswith("scene.gltf")


def set_node_cycle(file: GltfFile) -> None:
    file.json |= {"nodes": [{"children": [1]}, {"children": [0]}], "scenes": [{"nodes": [0]}]}


def set_two_parents(file: GltfFile) -> None:
    file.json["nodes"] = [{"children": [2]}, {"children": [2]}, {}]


def set_huge_count(file: GltfFile) -> None:
    file.json["accessors"][0]["count"] = 10**9


def set_huge_count_of_zeros(file: GltfFile) -> None:
    file.json["accessors"][0] |= {"count": 10**9}
    del file.json["accessors"][0]["bufferView"]


def set_index_out_of_range(file: GltfFile) -> None:
    file.json["meshes"][0]["primitives"][0]["indices"] = file.accessor([0, 1, 3], "u2")


def set_nan_position(file: GltfFile) -> None:
    file.binary[0:4] = np.float32("nan").tobytes()


def set_signed_indices(file: GltfFile) -> None:
    file.json["meshes"][0]["primitives"][0]["indices"] = file.accessor([0, 1, 2], "i2")


def set_endless_scale(file: GltfFile) -> None:
    file.json["nodes"][0]["scale"] = [1e38, 1e38, 1e38]
    file.binary[0:4] = np.float32(1e38).tobytes()


def set_many_instances(file: GltfFile) -> None:
    attributes = {"SCALE": file.append("accessors", {"componentType": 5126, "type": "VEC3", "count": 1 << 20})}
    file.json["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}


def set_no_instances(file: GltfFile) -> None:
    attributes = {"ROTATION": file.append("accessors", {"componentType": 5126, "type": "VEC4", "count": 0})}
    file.json["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (set_no_instances, r"nodes\[0\].*expected at least one instance, got none"),
        (set_node_cycle, r"nodes\[0\]: expected a tree of nodes"),
        (set_two_parents, r"nodes\[2\]: expected one parent, got nodes\[0\] and nodes\[1\]"),
        (
            set_huge_count,
            r"accessors\[0\]: expected a bufferView of at least 12000000000 bytes for 1000000000 elements, got 36 bytes",
        ),
        (set_huge_count_of_zeros, r"accessors\[0\]: expected a bufferView, or at most"),
        (set_index_out_of_range, r"primitives\[0\].indices: expected indices below 3, .* got 3 as number 2"),
        (
            set_nan_position,
            r"meshes\[0\].primitives\[0\]: expected finite positions, got \[nan, 0.0, 0.0\] for vertex 0",
        ),
        (set_signed_indices, r"accessors\[1\]: expected unsigned integers"),
        (set_endless_scale, r"expected finite positions in world space"),
        (set_many_instances, r"expected at most 5\d\d MiB of geometry"),
    ],
)
def test_invalid_documents_are_refused(tmp_path: Path, spoil: Callable[[GltfFile], None], message: str) -> None:
    file = GltfFile()
    file.mesh_node()
    spoil(file)
    tracemalloc.start()
    with pytest.raises(EclatError, match=message) as caught:
        load(file.save(tmp_path))
    assert tracemalloc.get_traced_memory()[1] < 1 << 29
    tracemalloc.stop()
    assert str(caught.value).startswith("scene.glb")


@pytest.mark.parametrize(
    "uri",
    [
        *(
            "../../etc/passwd",
            "..%2f..%2fetc%2fpasswd",
            "/etc/passwd",
            "%2Fetc/passwd",
            "a/../../b",
            "..\\..\\b",
            "C:\\b",
        ),
        *(
            "http://localhost/x.bin",
            "file:///etc/passwd",
            "%00",
            "a%0ab",
            "..",
            "%ff",
            "outside/x.bin",
            ".",
            "x\\..\\..\\y",
        ),
    ],
)
@pytest.mark.parametrize("kind", ["buffers", "images"])
def test_uris_that_leave_the_folder_are_refused(tmp_path: Path, uri: str, kind: str) -> None:
    folder = tmp_path / "inner"
    folder.mkdir()
    (tmp_path / "x.bin").write_bytes(bytes(100))
    (folder / "outside").symlink_to(tmp_path)
    file = GltfFile()
    file.append("materials", {"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}})
    file.append("textures", {"source": 0})
    primitive = file.primitive(material=0)
    primitive["attributes"]["TEXCOORD_0"] = file.accessor([[0, 0]] * 3)
    file.mesh_node(primitive)
    file.append("images", {"uri": uri if kind == "images" else "data:,"})
    if kind == "buffers":
        file.json["buffers"] = [{"byteLength": 36, "uri": uri}]
    if uri == "." and kind == "images":
        with pytest.warns(EclatWarning, match="expected a file"):
            load_gltf(file.save(folder, "scene.gltf"))
        return
    with pytest.raises(EclatError, match=kind):
        load_gltf(file.save(folder, "scene.gltf"))


@pytest.mark.parametrize(
    ("uri", "message"),
    [
        ("gone.bin", r"buffers\[0\]: file not found"),
        ("data:;base64,####", r"buffers\[0\]: expected valid base64 in the data URI"),
        ("data:;base64", r"buffers\[0\]: expected a data URI with a comma"),
        ("data:;base64,AAAA", r"buffers\[0\]: expected 36 bytes \(byteLength\), got 3"),
        ("", r"buffers\[0\]: expected a 'uri', or a binary chunk in the file, got neither"),
    ],
)
def test_missing_buffers(tmp_path: Path, uri: str, message: str) -> None:
    file = GltfFile()
    file.mesh_node()
    file.json["buffers"] = [{"byteLength": 36, "uri": uri}]
    with pytest.raises(EclatError, match=message):
        load_gltf(file.save(tmp_path, "scene.gltf"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"byteOffset": 4},
            r"bufferViews\[0\]: expected a range within the 36 bytes of buffers\[0\], got byteOffset 4",
        ),
        ({"byteLength": 10**30}, r"bufferViews\[0\]: expected a range within"),
        ({"byteStride": 4}, r"accessors\[0\]: expected a byteStride of at least 12 bytes, got 4"),
        ({"buffer": 1}, r"bufferViews\[0\].buffer: expected an index below 1, the number of buffers, got 1"),
        ({"buffer": None}, r"bufferViews\[0\]: expected the index of a buffer as 'buffer', but it is missing"),
    ],
)
def test_buffer_views_that_exceed_their_buffer_are_refused(
    tmp_path: Path, change: dict[str, Any], message: str
) -> None:
    file = GltfFile()
    file.mesh_node()
    file.json["bufferViews"][0] |= change
    with pytest.raises(EclatError, match=message):
        load_gltf(file.save(tmp_path))


@pytest.mark.parametrize("primitives", [[], [{"attributes": {}}], [{}]])
def test_empty_meshes_are_skipped(tmp_path: Path, primitives: list[dict[str, Any]]) -> None:
    file = GltfFile()
    file.mesh_node()
    file.append("meshes", {"primitives": primitives})
    file.append("nodes", {"mesh": 1})
    with pytest.warns(EclatWarning, match="is left out"):
        assert len(load_gltf(file.save(tmp_path)).meshes) == 1


def test_a_node_scaled_to_nothing_is_skipped(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node(scale=[0, 0, 0])
    with pytest.warns(EclatWarning, match="the transform of a node scales the mesh to a line or a point"):
        assert not load_gltf(file.save(tmp_path)).meshes


def test_names_that_the_terminal_cannot_encode(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node(name="\ud800", extensions={"\ud800": {}})
    file.json["extensionsUsed"] = ["\udfff"]
    with pytest.warns(EclatWarning) as caught:
        scene = load_gltf(
            saved(json.dumps({**file.json, "buffers": [{"byteLength": 36, "uri": "data:," + "%00" * 36}]}), tmp_path)
        )
    "".join([str(entry.message) for entry in caught] + [mesh.name for mesh in scene.meshes]).encode()


def test_a_folder_and_a_missing_file(tmp_path: Path) -> None:
    for path, message in ((tmp_path, "expected a file"), (tmp_path / "gone.glb", "file not found")):
        with pytest.raises(EclatError, match=message):
            load_gltf(path)


def test_a_primitive_without_an_area_is_named(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node(file.primitive(((0, 0, 0), (1, 1, 1), (2, 2, 2))), file.primitive())
    with pytest.warns(EclatWarning, match=r"primitives\[0\]: no triangle of the primitive has an area"):
        load_gltf(file.save(tmp_path, "flat.glb"))
