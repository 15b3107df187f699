# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""glTF geometry, hierarchy, cameras, lights and containers."""

from __future__ import annotations

import json
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eclat.errors import EclatWarning
from eclat.loaders.gltf import load_gltf
from eclat.scene import DirectionalLight, Mesh, PointLight, Scene, SpotLight
from support.gltf_files import TRIANGLE, GltfFile

QUAD = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0))
HALF = math.sqrt(0.5)


def load(file: GltfFile, folder: Path, name: str = "scene.glb") -> Scene:
    return load_gltf(file.save(folder, name))


def load_quietly(path: Path) -> Scene:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EclatWarning)
        return load_gltf(path)


def only(scene: Scene) -> Mesh:
    (mesh,) = scene.meshes
    return mesh


def geometric_normals(mesh: Mesh) -> np.ndarray:
    a, b, c = (mesh.positions[mesh.triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


@pytest.mark.parametrize("name", ["scene.glb", "scene.gltf"])
def test_a_triangle_without_normals_is_flat(tmp_path: Path, name: str) -> None:
    file = GltfFile()
    file.mesh_node(file.primitive())
    scene = load(file, tmp_path, name)
    mesh = only(scene)
    np.testing.assert_array_equal(mesh.positions, TRIANGLE)
    np.testing.assert_array_equal(mesh.triangles, [[0, 1, 2]])
    assert mesh.normals is None and mesh.tangents is None and mesh.uvs is None
    assert scene.name == "scene" and not scene.photometric
    assert mesh.material.kind == "metallic_roughness" and not mesh.material.two_sided


@pytest.mark.parametrize("dtype", ["u1", "u2", "u4"])
def test_indices_of_each_size(tmp_path: Path, dtype: str) -> None:
    file = GltfFile()
    primitive = file.primitive(QUAD)
    primitive["indices"] = file.accessor([0, 1, 3, 0, 3, 2], dtype)
    file.mesh_node(primitive)
    np.testing.assert_array_equal(only(load(file, tmp_path)).triangles, [[0, 1, 3], [0, 3, 2]])


def test_strip_and_fan_keep_their_orientation(tmp_path: Path) -> None:
    file = GltfFile()
    fan = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    file.mesh_node(file.primitive(QUAD, mode=5), file.primitive(fan, mode=6))
    scene = load(file, tmp_path)
    assert [len(mesh.triangles) for mesh in scene.meshes] == [2, 2]
    for mesh in scene.meshes:
        np.testing.assert_allclose(geometric_normals(mesh), [[0, 0, 1]] * 2)


def test_degenerate_triangles_of_a_strip_are_left_out(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node(file.primitive(QUAD, [0, 1, 2, 2, 3, 3, 1, 0], mode=5))
    mesh = only(load(file, tmp_path))
    assert all(len(set(triangle)) == 3 for triangle in mesh.triangles.tolist()) and len(mesh.triangles) == 2


def test_matrix_and_trs_agree(tmp_path: Path) -> None:
    file = GltfFile()
    # 90° about z, then scaled by (2, 3, 4) before it, moved by (5, 6, 7); the matrix is column by column.
    matrix = [0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 5, 6, 7, 1]
    file.mesh_node(file.primitive(), matrix=matrix)
    file.mesh_node(file.primitive(), translation=[5, 6, 7], rotation=[0, 0, HALF, HALF], scale=[2, 3, 4])
    one, two = load(file, tmp_path).meshes
    np.testing.assert_allclose(one.positions, [[5, 6, 7], [5, 8, 7], [2, 6, 7]], atol=1e-12)
    np.testing.assert_allclose(two.positions, one.positions, atol=1e-6)


def test_children_are_transformed_by_their_parents(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node(file.primitive(), translation=[1, 0, 0])
    file.append("nodes", {"children": [0], "scale": [10, 10, 10]})
    file.json["scenes"] = [{"nodes": [1]}]
    np.testing.assert_allclose(only(load(file, tmp_path)).positions[0], [10, 0, 0])


def test_a_mirrored_node_keeps_the_front_side(tmp_path: Path) -> None:
    file = GltfFile()
    primitive = file.primitive()
    primitive["attributes"]["NORMAL"] = file.accessor([[0, 0, 1]] * 3)
    primitive["attributes"]["TANGENT"] = file.accessor([[1, 0, 0, 1]] * 3)
    file.mesh_node(primitive, scale=[-1, 1, 1])
    mesh = only(load(file, tmp_path))
    np.testing.assert_allclose(geometric_normals(mesh), [[0, 0, 1]])
    assert mesh.normals is not None and mesh.tangents is not None
    np.testing.assert_allclose(mesh.normals, [[0, 0, 1]] * 3)
    # The bitangent w (n × t) must stay +y, where the mirror leaves it.
    bitangents = np.cross(mesh.normals, mesh.tangents[:, :3]) * mesh.tangents[:, 3:]
    np.testing.assert_allclose(bitangents, [[0, 1, 0]] * 3)


@pytest.mark.parametrize("scale", [(2, 1, 1), (1, -3, 0.5), (-1, -1, -1), (1, 1, 0)])
def test_normals_stay_perpendicular_under_any_scale(tmp_path: Path, scale: tuple[float, ...]) -> None:
    file = GltfFile()
    corners = np.array([[0, 0, 0], [1, 0.2, 0.3], [0.1, 1, 0.4]])
    normal = np.cross(corners[1], corners[2])
    primitive = file.primitive(corners)
    primitive["attributes"]["NORMAL"] = file.accessor([normal / np.linalg.norm(normal)] * 3)
    file.mesh_node(primitive, scale=list(scale), rotation=[0, HALF, 0, HALF])
    mesh = only(load(file, tmp_path))
    assert mesh.normals is not None
    np.testing.assert_allclose(mesh.normals, geometric_normals(mesh).repeat(3, axis=0), atol=1e-6)


def test_quantized_attributes_are_decoded(tmp_path: Path) -> None:
    file = GltfFile()
    file.json["extensionsUsed"] = ["KHR_mesh_quantization"]
    attributes = {
        "POSITION": file.accessor([[0, 0, 0], [300, 0, 0], [0, -300, 0]], "i2"),
        "NORMAL": file.accessor([[0, 0, 127], [0, 0, -128], [127, 0, 0]], "i1", normalized=True),
        "TEXCOORD_0": file.accessor([[0, 65535], [65535, 0], [0, 0]], "u2", normalized=True),
        "TEXCOORD_1": file.accessor([[2, 3], [4, 5], [6, 7]], "u1"),
        "COLOR_0": file.accessor([[255, 0, 51, 0]] * 3, "u1", normalized=True),
    }
    file.mesh_node({"attributes": attributes})
    mesh = only(load(file, tmp_path))
    np.testing.assert_array_equal(mesh.positions, [[0, 0, 0], [300, 0, 0], [0, -300, 0]])
    np.testing.assert_array_equal(mesh.normals, [[0, 0, 1], [0, 0, -1], [1, 0, 0]])
    np.testing.assert_array_equal(mesh.uvs, [[0, 1], [1, 0], [0, 0]])
    np.testing.assert_array_equal(mesh.uvs2, [[2, 3], [4, 5], [6, 7]])
    # The material is opaque, so the colour's alpha means nothing.
    np.testing.assert_allclose(mesh.colors, [[1, 0, 0.2, 1]] * 3)
    assert mesh.material.vertex_colors


def test_colors_without_alpha_are_opaque(tmp_path: Path) -> None:
    file = GltfFile()
    primitive = file.primitive()
    primitive["attributes"]["COLOR_0"] = file.accessor([[0.25, 0.5, 1]] * 3)
    file.mesh_node(primitive)
    np.testing.assert_array_equal(only(load(file, tmp_path)).colors, [[0.25, 0.5, 1, 1]] * 3)


def test_interleaved_attributes(tmp_path: Path) -> None:
    file = GltfFile()
    vertices = np.hstack((np.array(TRIANGLE), [[0, 0, 1]] * 3)).astype("<f4")
    view = file.view(vertices.tobytes(), byteStride=24)
    common = {"bufferView": view, "componentType": 5126, "type": "VEC3", "count": 3}
    attributes = {
        "POSITION": file.append("accessors", common),
        "NORMAL": file.append("accessors", {**common, "byteOffset": 12}),
    }
    file.mesh_node({"attributes": attributes})
    mesh = only(load(file, tmp_path))
    np.testing.assert_array_equal(mesh.positions, TRIANGLE)
    np.testing.assert_array_equal(mesh.normals, [[0, 0, 1]] * 3)


@pytest.mark.parametrize("with_base", [True, False])
def test_sparse_accessors(tmp_path: Path, with_base: bool) -> None:
    file = GltfFile()
    base = {"bufferView": file.view(np.ones((4, 3), "<f4").tobytes())} if with_base else {}
    sparse = {
        "count": 2,
        "indices": {"bufferView": file.view(np.array([1, 3], "<u2").tobytes()), "componentType": 5123},
        "values": {"bufferView": file.view(np.array([[5, 0, 0], [0, 5, 0]], "<f4").tobytes())},
    }
    accessor = {**base, "componentType": 5126, "type": "VEC3", "count": 4, "sparse": sparse}
    file.mesh_node({"attributes": {"POSITION": file.append("accessors", accessor)}, "mode": 5})
    fill = 1.0 if with_base else 0.0
    np.testing.assert_array_equal(
        only(load(file, tmp_path)).positions[[0, 1, 2, 3]], [[fill] * 3, [5, 0, 0], [fill] * 3, [0, 5, 0]]
    )


def test_few_vertices_of_a_shared_pool_are_taken_out(tmp_path: Path) -> None:
    file = GltfFile()
    pool = file.accessor(np.arange(300).reshape(100, 3) ** 2)
    file.mesh_node({"attributes": {"POSITION": pool}, "indices": file.accessor([50, 70, 60], "u1")})
    mesh = only(load(file, tmp_path))
    np.testing.assert_array_equal(mesh.triangles, [[0, 2, 1]])
    np.testing.assert_array_equal(mesh.positions[:, 0], np.array([150, 180, 210]) ** 2)


def test_morph_targets_stand_at_their_default_weights(tmp_path: Path) -> None:
    file = GltfFile()
    targets = [{"POSITION": file.accessor([[0, 0, z]] * 3)} for z in (1, 10)]
    file.append("meshes", {"primitives": [file.primitive(targets=targets)], "weights": [0.5, 0.25]})
    file.append("nodes", {"mesh": 0})
    file.append("nodes", {"mesh": 0, "weights": [2, 0]})
    one, two = load(file, tmp_path).meshes
    np.testing.assert_array_equal(one.positions[:, 2], [3, 3, 3])
    np.testing.assert_array_equal(two.positions[:, 2], [2, 2, 2])


def test_instances_share_material_and_texture_coordinates(tmp_path: Path) -> None:
    file = GltfFile()
    file.append("materials", {"name": "paint"})
    primitive = file.primitive(material=0)
    primitive["attributes"]["TEXCOORD_0"] = file.accessor([[0, 0], [1, 0], [0, 1]])
    file.mesh_node(primitive)
    file.append("nodes", {"mesh": 0, "translation": [0, 0, 9]})
    one, two = load(file, tmp_path).meshes
    assert one.material is two.material and one.uvs is two.uvs
    np.testing.assert_array_equal(two.positions - one.positions, [[0, 0, 9]] * 3)


def test_gpu_instancing_places_one_mesh_each(tmp_path: Path) -> None:
    file = GltfFile()
    moves = {"TRANSLATION": file.accessor([[1, 0, 0], [2, 0, 0]]), "SCALE": file.accessor([[1, 1, 1], [2, 2, 2]])}
    file.mesh_node(file.primitive(), extensions={"EXT_mesh_gpu_instancing": {"attributes": moves}}, scale=[10, 10, 10])
    one, two = load(file, tmp_path).meshes
    np.testing.assert_array_equal(one.positions[:2, 0], [10, 20])
    np.testing.assert_array_equal(two.positions[:2, 0], [20, 40])


def test_only_the_default_scene_is_loaded(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node(file.primitive(), name="first")
    file.mesh_node(file.primitive(), name="second")
    file.json |= {"scenes": [{"nodes": [0]}, {"nodes": [1]}], "scene": 1}
    with pytest.warns(EclatWarning, match=r"the file has 2 scenes; only scenes\[1\] is loaded"):
        assert only(load(file, tmp_path)).name == "second"


def test_perspective_cameras(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node()
    file.append("cameras", {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1, "aspectRatio": 1.5}})
    file.append("cameras", {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}})
    file.append("nodes", {"camera": 0, "name": "front", "translation": [0, 1, 5], "scale": [2, 3, 4]})
    file.append("nodes", {"camera": 1, "rotation": [0, HALF, 0, HALF]})
    front, side = load(file, tmp_path).cameras
    assert (front.name, front.fov_axis, front.size, side.size) == ("front", "y", (1080, 720), None)
    assert front.fov == pytest.approx(math.degrees(1)) and side.fov == pytest.approx(math.degrees(0.5))
    np.testing.assert_allclose(front.to_world, [[1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 1, 5], [0, 0, 0, 1]])
    np.testing.assert_allclose(-side.to_world[:3, 2], [-1, 0, 0], atol=1e-6)


def test_an_orthographic_camera_has_its_full_height(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node()
    lens = {"xmag": 4, "ymag": 2, "znear": 0, "zfar": 1}
    file.append("cameras", {"type": "orthographic", "orthographic": lens})
    file.append("nodes", {"camera": 0})
    (camera,) = load(file, tmp_path).cameras
    assert (camera.projection, camera.fov, camera.size) == ("orthographic", 4.0, (1440, 720))


def lit(file: GltfFile, light: dict[str, Any], **node: Any) -> None:
    file.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"].append(light)
    index = len(file.json["extensions"]["KHR_lights_punctual"]["lights"]) - 1
    file.append("nodes", {"extensions": {"KHR_lights_punctual": {"light": index}}, **node})


def test_emission_is_photometric(tmp_path: Path) -> None:
    file = GltfFile()
    material = file.append("materials", {"emissiveFactor": [1, 1, 1]})
    file.mesh_node(file.primitive() | {"material": material})
    assert load(file, tmp_path).photometric


def test_punctual_lights_are_photometric(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node()
    lit(file, {"type": "point", "intensity": 10, "color": [1, 0.5, 0]}, translation=[1, 2, 3])
    lit(file, {"type": "directional", "intensity": 3}, rotation=[-HALF, 0, 0, HALF], scale=[2, 2, 2])
    lit(file, {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}})
    lit(file, {"type": "spot", "spot": {}})
    scene = load(file, tmp_path)
    point, sun, spot, wide = scene.lights
    assert scene.photometric
    assert point == PointLight((1, 2, 3), (10, 5, 0))
    assert isinstance(sun, DirectionalLight) and sun.irradiance == (3, 3, 3)
    np.testing.assert_allclose(sun.direction, [0, -1, 0], atol=1e-6)
    assert isinstance(spot, SpotLight) and isinstance(wide, SpotLight) and spot.falloff == "smooth"
    assert (spot.inner_angle, spot.outer_angle) == pytest.approx((math.degrees(0.1), math.degrees(0.2)))
    assert (wide.inner_angle, wide.outer_angle) == pytest.approx((0, 45))


def test_the_range_of_a_light_is_ignored_with_a_warning(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node()
    lit(file, {"type": "point", "range": 3})
    with pytest.warns(EclatWarning, match="the range of a light is not supported"):
        load(file, tmp_path)


def test_external_buffers_with_encoded_names(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node()
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "my buffer.bin").write_bytes(bytes(file.binary))
    file.json["buffers"] = [{"byteLength": len(file.binary), "uri": "data/my%20buffer.bin"}]
    np.testing.assert_array_equal(only(load(file, tmp_path, "scene.gltf")).positions, TRIANGLE)


def test_json_with_a_byte_order_mark(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node()
    path = file.save(tmp_path, "scene.gltf")
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert load_gltf(path).meshes


def test_unsupported_features_are_named(tmp_path: Path) -> None:
    file = GltfFile()
    file.append("materials", {"extensions": {"KHR_materials_sheen": {}}})
    file.append("animations", {})
    file.json |= {"extensionsUsed": ["KHR_materials_clearcoat", "ACME_x"], "extensionsRequired": ["ACME_x"]}
    file.mesh_node(file.primitive(mode=0), file.primitive(mode=3), file.primitive(), skin=0)
    with pytest.warns(EclatWarning) as caught:
        load(file, tmp_path)
    text = "\n".join(str(entry.message) for entry in caught)
    assert "the file requires extensions that are not supported, so the image may be wrong: ACME_x" in text
    assert "not supported and are ignored: KHR_materials_clearcoat, KHR_materials_sheen" in text
    for words in (
        "consists of points, which have no area",
        "lines in a strip, which have no area",
        "expected an index below 0, the number of skins",
    ):
        assert words in text


def test_zero_normals_become_their_triangles(tmp_path: Path) -> None:
    file = GltfFile()
    primitive = file.primitive()
    primitive["attributes"]["NORMAL"] = file.accessor([[0, 1, 0], [0, 0, 0], [0, 0, 0]])
    file.mesh_node(primitive)
    with pytest.warns(EclatWarning, match="2 normals have length 0"):
        np.testing.assert_array_equal(only(load(file, tmp_path)).normals, [[0, 1, 0], [0, 0, 1], [0, 0, 1]])


def test_real_scenes_load(scenes: Path) -> None:
    files = sorted(scenes.glob("**/*.glb"))
    assert len(files) >= 14
    for path in files:
        scene = load_quietly(path)
        for mesh in scene.meshes:
            assert np.isfinite(mesh.positions).all() and mesh.triangles.max() < len(mesh.positions)
            if mesh.normals is not None:
                np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-5)


def test_real_scenes_have_what_their_files_say(scenes: Path) -> None:
    sibenik = load_quietly(scenes / "sibenik" / "sibenik.glb")
    assert sum(len(mesh.triangles) for mesh in sibenik.meshes) == 75145
    lights = load_quietly(scenes / "khronos-material-tests" / "Lights.glb")
    assert (len(lights.lights), len(lights.cameras), lights.photometric) == (4, 1, True)
    document = (scenes / "cornell-box-gltf" / "CornellBox.glb").read_bytes()
    text = json.loads(document[20 : 20 + int.from_bytes(document[12:16], "little")])
    box = load_quietly(scenes / "cornell-box-gltf" / "CornellBox.glb")
    assert {mesh.material.name for mesh in box.meshes} == {material["name"] for material in text["materials"]}
    assert any(mesh.material.emission is not None for mesh in box.meshes)


def test_vertex_colors_above_white_are_clamped(tmp_path: Path) -> None:
    file = GltfFile()
    primitive = file.primitive()
    primitive["attributes"]["COLOR_0"] = file.accessor([[3, 2, 0.5]] * 3)
    file.mesh_node(primitive)
    with pytest.warns(EclatWarning, match="expected COLOR_0 in 0..1, got up to 3"):
        np.testing.assert_array_equal(only(load(file, tmp_path)).colors, [[1, 1, 0.5, 1]] * 3)
