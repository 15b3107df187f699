# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Animations of glTF files: nodes, morph targets, skins, pointers; what is invalid; what moves."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.errors import EclatWarning
from eclat.scene import PointLight, Scene
from support.gltf_files import TRIANGLE, GltfFile

HALF = math.sqrt(0.5)


def animate(file: GltfFile, target: dict[str, Any], times: Any, values: Any, mode: str = "LINEAR") -> dict[str, Any]:
    """Add an animation of one channel; its sampler, which may be changed."""
    sampler = {"input": file.accessor(times), "output": file.accessor(values), "interpolation": mode}
    file.append("animations", {"samplers": [sampler], "channels": [{"sampler": 0, "target": target}]})
    return sampler


def pointer(path: str) -> dict[str, Any]:
    return {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": path}}}


def load(file: GltfFile, folder: Path) -> Scene:
    with warnings.catch_warnings():
        warnings.simplefilter("error", EclatWarning)
        return eclat.load(file.save(folder))


def test_translation_rotation_and_scale(tmp_path: Path) -> None:
    file = GltfFile()
    node = file.mesh_node(name="door")
    animate(file, {"node": node, "path": "translation"}, [0, 2], [[0, 0, 0], [4, 0, 0]])
    animate(file, {"node": node, "path": "rotation"}, [0, 2], [[0, 0, 0, 1], [0, 0, HALF, HALF]])
    animate(file, {"node": node, "path": "scale"}, [0, 2], [[1, 1, 1], [3, 3, 3]], "STEP")
    scene = load(file, tmp_path)
    assert scene.animation is not None
    assert (scene.animation.start, scene.animation.end) == (0, 2)
    np.testing.assert_array_equal(scene.meshes[0].positions, TRIANGLE)
    c = math.cos(math.radians(45))
    np.testing.assert_allclose(scene.at(1).meshes[0].positions, [[2, 0, 0], [2 + c, c, 0], [2 - c, c, 0]], atol=1e-6)
    np.testing.assert_allclose(scene.at(2).meshes[0].positions, [[4, 0, 0], [4, 3, 0], [1, 0, 0]], atol=1e-6)
    assert scene.at(1).animation is None
    np.testing.assert_array_equal(scene.meshes[0].positions, TRIANGLE)


def test_children_move_with_their_parents_and_nothing_else_does(tmp_path: Path) -> None:
    file = GltfFile()
    child, still = file.mesh_node(name="child"), file.mesh_node(name="still")
    for number, name in ((child, "child"), (still, "still")):
        file.json["meshes"][file.json["nodes"][number]["mesh"]]["name"] = name
    parent = file.append("nodes", {"children": [child]})
    file.append("scenes", {"nodes": [parent, still]})
    animate(file, {"node": parent, "path": "translation"}, [0, 1], [[0, 0, 0], [0, 1, 0]])
    scene = load(file, tmp_path)
    assert scene.animation is not None
    assert scene.animation.objects == ("child",)
    moved = scene.at(0.5)
    assert moved.meshes[1] is scene.meshes[1]
    np.testing.assert_allclose(moved.meshes[0].positions, np.array(TRIANGLE) + np.array([0, 0.5, 0]))


def test_cubic_translation(tmp_path: Path) -> None:
    file = GltfFile()
    node = file.mesh_node()
    keys = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [-1, 0, 0], [3, 0, 0], [0, 0, 0]]
    animate(file, {"node": node, "path": "translation"}, [0, 4], keys, "CUBICSPLINE")
    assert load(file, tmp_path).at(1).meshes[0].positions[0, 0] == pytest.approx(2.625)


def test_morph_targets(tmp_path: Path) -> None:
    file = GltfFile()
    primitive = file.primitive()
    up = file.accessor([[0, 0, 1]] * 3)
    aside = file.accessor([[1, 0, 0]] * 3)
    primitive["targets"] = [{"POSITION": up}, {"POSITION": aside}]
    node = file.mesh_node(primitive, weights=[0.0, 0.0])
    animate(file, {"node": node, "path": "weights"}, [0, 1], np.array([0.0, 0.0, 1.0, 4.0]))
    scene = load(file, tmp_path)
    np.testing.assert_allclose(scene.at(0.5).meshes[0].positions, np.array(TRIANGLE) + np.array([2, 0, 0.5]))
    assert scene.animation is not None
    assert len(scene.animation.objects) == 1


def skinned_strip(**skin: Any) -> tuple[GltfFile, int]:
    """A strip of two squares along +y from 0 to 2, in the plane z = 0. Its lower edge follows joint 0 at the origin, its upper
    edge joint 1 at (0, 1, 0), and the edge between both halves equally. The upper joint is returned."""
    file = GltfFile()
    positions = [[x, y, 0] for y in (0, 1, 2) for x in (0, 1)]
    triangles = [0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4]
    primitive = file.primitive(positions, triangles)
    primitive["attributes"]["NORMAL"] = file.accessor([[0, 0, 1]] * 6)
    primitive["attributes"]["JOINTS_0"] = file.accessor([[0, 1, 0, 0]] * 6, "u1")
    weights = [[1, 0, 0, 0]] * 2 + [[0.5, 0.5, 0, 0]] * 2 + [[0, 1, 0, 0]] * 2
    primitive["attributes"]["WEIGHTS_0"] = file.accessor(weights)
    upper = file.append("nodes", {"translation": [0, 1, 0]})
    lower = file.append("nodes", {"children": [upper]})
    binds = np.stack([np.eye(4), np.eye(4)])
    binds[1, :3, 3] = [0, -1, 0]
    columns = binds.transpose(0, 2, 1).reshape(2, 16)
    accessor = file.append(
        "accessors",
        {"bufferView": file.view(columns.astype("<f4").tobytes()), "componentType": 5126, "type": "MAT4", "count": 2},
    )
    file.append("skins", {"joints": [lower, upper], "inverseBindMatrices": accessor, **skin})
    # The transform of a node with a skin has no effect.
    node = file.mesh_node(primitive, skin=0, translation=[50, 50, 50])
    file.append("scenes", {"nodes": [lower, node]})
    return file, upper


def test_a_skin_bends_a_strip(tmp_path: Path) -> None:
    """The upper joint turns by 90° around x: the upper edge at (x, 2) goes to (x, 1, 1), and the middle edge stays."""
    file, upper = skinned_strip()
    animate(file, {"node": upper, "path": "rotation"}, [0, 1], [[0, 0, 0, 1], [HALF, 0, 0, HALF]])
    scene = load(file, tmp_path)
    np.testing.assert_allclose(scene.meshes[0].positions[:, 1], [0, 0, 1, 1, 2, 2], atol=1e-6)
    bent = scene.at(1).meshes[0]
    expected = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 1, 1], [1, 1, 1]]
    np.testing.assert_allclose(bent.positions, expected, atol=1e-6)
    assert bent.normals is not None
    np.testing.assert_allclose(bent.normals[0], [0, 0, 1], atol=1e-6)
    np.testing.assert_allclose(bent.normals[4], [0, -1, 0], atol=1e-6)
    # Half of each joint: the mean of the matrices turns the normal by the mean of their cofactors.
    np.testing.assert_allclose(bent.normals[2], [0, -HALF, HALF], atol=1e-6)
    assert scene.animation is not None
    assert scene.animation.objects == ("meshes[0]",)


def test_a_skin_is_bent_at_rest_as_its_joints_lie(tmp_path: Path) -> None:
    """No animation: the upper joint's own rotation bends the strip, as the other test's animation does at its end."""
    file, upper = skinned_strip()
    file.json["nodes"][upper]["rotation"] = [HALF, 0, 0, HALF]
    mesh = load(file, tmp_path).meshes[0]
    expected = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 1, 1], [1, 1, 1]]
    np.testing.assert_allclose(mesh.positions, expected, atol=1e-6)


def test_an_invalid_skin_leaves_the_mesh_in_its_place(tmp_path: Path) -> None:
    file, _ = skinned_strip(joints=[])
    with pytest.warns(EclatWarning, match="loaded without its skin"):
        scene = eclat.load(file.save(tmp_path))
    np.testing.assert_allclose(scene.meshes[0].positions[0], [50, 50, 50])


def test_pointers_to_a_light_a_material_and_a_camera(tmp_path: Path) -> None:
    file = GltfFile()
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 1.0}}
    material = file.append("materials", {"emissiveFactor": [1, 1, 1], "extensions": strength})
    file.mesh_node(file.primitive(material=material))
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 1.0, "name": "bulb"}]}}
    file.append("nodes", {"extensions": {"KHR_lights_punctual": {"light": 0}}})
    camera = file.append("cameras", {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}, "name": "eye"})
    file.append("nodes", {"camera": camera})
    light = "/extensions/KHR_lights_punctual/lights/0"
    animate(file, pointer(f"{light}/intensity"), [0, 1], [1.0, 5.0])
    animate(file, pointer(f"{light}/color"), [0, 1], [[1, 1, 1], [1, 0, 0]])
    path = f"/materials/{material}/extensions/KHR_materials_emissive_strength/emissiveStrength"
    animate(file, pointer(path), [0, 1], [1.0, 3.0])
    animate(
        file, pointer(f"/materials/{material}/pbrMetallicRoughness/baseColorFactor"), [0, 1], [[1] * 4, [0, 0, 0, 1]]
    )
    file.json["materials"][material]["pbrMetallicRoughness"] = {}
    animate(file, pointer("/cameras/0/perspective/yfov"), [0, 1], [1.0, 0.5])
    scene = load(file, tmp_path)
    half = scene.at(0.5)
    assert isinstance(half.lights[0], PointLight)
    assert half.lights[0].intensity == pytest.approx((3, 1.5, 1.5))
    emission = half.meshes[0].material.emission
    assert emission is not None
    assert emission.constant == pytest.approx((2, 2, 2))
    assert half.meshes[0].material.parameters["base_color"].constant == pytest.approx((0.5, 0.5, 0.5))
    assert half.cameras[0].fov == pytest.approx(math.degrees(0.75))
    animation = scene.animation
    assert animation is not None
    assert (animation.objects, animation.lights, animation.cameras) == (("meshes[0]",), ("bulb",), ("eye",))


def test_an_object_that_grows_from_nothing(tmp_path: Path) -> None:
    file = GltfFile()
    node = file.mesh_node(scale=[0, 0, 0])
    animate(file, {"node": node, "path": "scale"}, [0, 1], [[0, 0, 0], [2, 2, 2]])
    scene = load(file, tmp_path)
    assert len(scene.meshes) == 1
    assert len(scene.meshes[0].triangles) == 0
    assert len(scene.at(0.5).meshes[0].triangles) == 1
    assert len(scene.at(0).meshes[0].triangles) == 0


def test_what_the_user_changed_stays_changed(tmp_path: Path) -> None:
    file = GltfFile()
    node = file.mesh_node(file.primitive(material=file.append("materials", {"name": "paint"})))
    animate(file, {"node": node, "path": "translation"}, [0, 1], [[0, 0, 0], [0, 1, 0]])
    scene = eclat.override_materials(load(file, tmp_path), {"paint": {"type": "diffuse"}})
    moved = scene.at(1)
    assert moved.meshes[0].material is scene.meshes[0].material
    assert moved.meshes[0].material.kind == "diffuse"
    np.testing.assert_allclose(moved.meshes[0].positions[0], [0, 1, 0])


def _bad_times(file: GltfFile, node: int) -> None:
    animate(file, {"node": node, "path": "translation"}, [1, 0], [[0, 0, 0], [9, 0, 0]])


def _nan_keys(file: GltfFile, node: int) -> None:
    animate(file, {"node": node, "path": "translation"}, [0, 1], [[0, 0, 0], [math.nan, 0, 0]])


def _no_accessor(file: GltfFile, node: int) -> None:
    animate(file, {"node": node, "path": "translation"}, [0, 1], [[0, 0, 0], [9, 0, 0]])["output"] = 999


def _no_input(file: GltfFile, node: int) -> None:
    del animate(file, {"node": node, "path": "translation"}, [0, 1], [[0, 0, 0], [9, 0, 0]])["input"]


def _too_few_values(file: GltfFile, node: int) -> None:
    animate(file, {"node": node, "path": "translation"}, [0, 1, 2], [[0, 0, 0], [9, 0, 0]])


def _wrong_width(file: GltfFile, node: int) -> None:
    animate(file, {"node": node, "path": "rotation"}, [0, 1], [[0, 0, 0], [9, 0, 0]])


def _unknown_mode(file: GltfFile, node: int) -> None:
    animate(file, {"node": node, "path": "translation"}, [0, 1], [[0, 0, 0], [9, 0, 0]], "BOUNCE")


def _unknown_node(file: GltfFile, node: int) -> None:
    animate(file, {"node": 77, "path": "translation"}, [0, 1], [[0, 0, 0], [9, 0, 0]])


def _unknown_pointer(file: GltfFile, node: int) -> None:
    animate(file, pointer("/textures/0/sampler"), [0, 1], [0.0, 1.0])


def _pointer_to_nothing(file: GltfFile, node: int) -> None:
    animate(file, pointer("/materials/5/emissiveFactor"), [0, 1], [[0, 0, 0], [9, 0, 0]])


def _zero_quaternions(file: GltfFile, node: int) -> None:
    animate(file, {"node": node, "path": "rotation"}, [0, 1], [[0, 0, 0, 1], [0, 0, 0, 0]])


def _no_list(file: GltfFile, node: int) -> None:
    file.append("animations", {"samplers": 3, "channels": {}})


@pytest.mark.parametrize(
    "damage",
    [
        _bad_times, _nan_keys, _no_accessor, _no_input, _too_few_values, _wrong_width, _unknown_mode, _unknown_node,
        _unknown_pointer, _pointer_to_nothing, _zero_quaternions, _no_list,
    ],
)  # fmt: skip
def test_a_bad_channel_is_left_out_with_a_warning(damage: Any, tmp_path: Path) -> None:
    file = GltfFile()
    node = file.mesh_node()
    damage(file, node)
    with pytest.warns(EclatWarning, match="this channel of the animation is left out"):
        scene = eclat.load(file.save(tmp_path))
    assert len(scene.meshes) == 1
    assert scene.animation is None
    assert scene.at(0.5) is scene


def test_animations_that_are_no_list(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node()
    file.json["animations"] = 5
    with pytest.warns(EclatWarning, match="animations"):
        assert eclat.load(file.save(tmp_path)).meshes


def test_a_million_keys(tmp_path: Path) -> None:
    file = GltfFile()
    node = file.mesh_node()
    count = 1_000_000
    times = np.arange(count) / 2**10  # exact as float32
    animate(file, {"node": node, "path": "translation"}, times, np.outer(np.arange(count) % 7, [1, 0, 0]))
    scene = load(file, tmp_path)
    assert scene.animation is not None
    assert scene.animation.end == (count - 1) / 2**10
    assert scene.at(5 / 2**10).meshes[0].positions[0, 0] == 5


def test_of_two_animations_of_one_property_the_first_counts(tmp_path: Path) -> None:
    file = GltfFile()
    node = file.mesh_node()
    for reach in (1, 5):
        animate(file, {"node": node, "path": "translation"}, [0, 1], [[0, 0, 0], [reach, 0, 0]])
    with pytest.warns(EclatWarning, match="the first channel of each property is used"):
        scene = eclat.load(file.save(tmp_path))
    assert scene.at(1).meshes[0].positions[0, 0] == 1


def test_a_camera_and_a_light_on_a_moving_node(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node()
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}}
    camera = file.append("cameras", {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}})
    light = {"extensions": {"KHR_lights_punctual": {"light": 0}}}
    node = file.append("nodes", {"camera": camera, "name": "dolly", **light})
    animate(file, {"node": node, "path": "translation"}, [0, 1], [[0, 0, 0], [0, 0, 6]])
    scene = load(file, tmp_path)
    assert scene.at(0.5).cameras[0].to_world[2, 3] == pytest.approx(3)
    assert scene.at(0.5).lights[0].position == (0, 0, 3)  # type: ignore[union-attr]
    assert scene.animation is not None
    assert (scene.animation.lights, scene.animation.cameras) == (("dolly",), ("dolly",))


def test_what_rests_is_the_same_object_at_all_times(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node()
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}
    file.append("nodes", {"extensions": {"KHR_lights_punctual": {"light": 0}}})
    camera = file.append("cameras", {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}})
    file.append("nodes", {"camera": camera})
    node = file.append("nodes", {"camera": camera})
    animate(file, {"node": node, "path": "translation"}, [0, 1], [[0, 0, 0], [0, 0, 6]])
    scene = load(file, tmp_path)
    moved = scene.at(0.5)
    assert moved.meshes[0] is scene.meshes[0]
    assert moved.lights[0] is scene.lights[0]
    assert moved.cameras[0] is scene.cameras[0]
    assert moved.cameras[1].to_world[2, 3] == pytest.approx(3)
