# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Names and groups of lamps, from every format, and the scenes in which one group shines."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import eclat
from eclat.gltf_export import encode_glb
from eclat.scene import DirectionalLight, Material, grey
from eclat.stage.light_groups import light_groups
from support.gltf_files import GltfFile
from support.two_lamps import lamps_of_all_kinds


def test_each_name_is_a_group_in_which_only_its_lamps_shine() -> None:
    scene = lamps_of_all_kinds()
    groups = light_groups(scene)
    assert list(groups) == ["light", "globe", "bulb", "sky"]
    for name, part in groups.items():
        glowing = [mesh.name for mesh in part.meshes if mesh.material.emission is not None]
        assert glowing == ([name] if name in ("light", "globe") else [])
        assert [light.name for light in part.lights] == (["bulb"] if name == "bulb" else [])
        assert (part.environment is not None) == (name == "sky")
        assert part.cameras == scene.cameras and len(part.meshes) == len(scene.meshes)


def test_groups_of_the_caller_and_the_others() -> None:
    groups = light_groups(lamps_of_all_kinds(), {"warm": ["gl*", "light"], "cold": "bulb"})
    assert list(groups) == ["warm", "cold", "others"]
    assert [m.name for m in groups["warm"].meshes if m.material.emission is not None] == ["light", "globe"]
    assert groups["others"].environment is not None


def test_lamps_without_names() -> None:
    scene = lamps_of_all_kinds()
    lights = (DirectionalLight((0, -1, 0), (1, 1, 1)), replace(scene.lights[0], name=""))
    bare = tuple(replace(mesh, name="", material=replace(mesh.material, name="")) for mesh in scene.meshes)
    assert list(light_groups(replace(scene, meshes=bare, lights=lights))) == ["unnamed", "sun", "sky"]


def test_emission_below_blends_and_on_backs_is_put_out() -> None:
    scene = lamps_of_all_kinds()
    shine = Material(emission=grey(1.0), name="shine")
    mixed = Material("blend", {"weight": grey(0.5)}, children=(shine, Material()), back=shine, name="mixed")
    mesh = replace(scene.meshes[0], material=mixed, name="poster")
    groups = light_groups(replace(scene, meshes=(mesh, *scene.meshes[1:])))
    assert groups["poster"].meshes[0].material is mixed
    dark = groups["sky"].meshes[0].material
    assert dark.back is not None and dark.back.emission is None and dark.children[0].emission is None


@pytest.mark.parametrize(
    ("groups", "message"),
    [
        (
            {"a": "glob"},
            r"light_groups, a: expected the name of a lamp \(light, globe, bulb, sky\), got 'glob'; did you mean 'globe'",
        ),
        (
            {"a": "*", "b": "globe"},
            "light_groups, b: expected at least one lamp that no earlier group contains, got none",
        ),
        ({"": "globe"}, "expected a name of 1 to 100 characters, got ''"),
        ({"a": [3]}, "light_groups, a: expected the name of a lamp, got 3"),
    ],
)
def test_mistakes(groups: dict[str, str], message: str) -> None:
    with pytest.raises(eclat.EclatError, match=message):
        light_groups(lamps_of_all_kinds(), groups)


def test_names_from_mitsuba() -> None:
    def square(**more: object) -> dict[str, object]:
        return {"type": "rectangle", "emitter": {"type": "area"}, **more}

    scene = eclat.load_dict(
        {
            "type": "scene",
            "desk": square(),
            "second": {"type": "rectangle", "named": {"type": "area", "id": "tube"}},
            "bulb": {"type": "point"},
            "dawn": {"type": "sunsky", "sun_direction": [0, 1, 1]},
        }
    )
    assert list(light_groups(scene)) == ["desk", "tube", "bulb", "dawn sun", "dawn sky"]


def test_names_from_gltf_and_back(tmp_path: Path) -> None:
    file = GltfFile()
    material = file.append("materials", {"emissiveFactor": [1, 1, 1], "name": "glow"})
    file.mesh_node(file.primitive() | {"material": material}, name="Lamp.001")
    lights = [{"type": "point", "name": "data"}, {"type": "point", "name": "only"}]
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    file.append("nodes", {"extensions": {"KHR_lights_punctual": {"light": 0}}, "name": "Bulb"})
    file.append("nodes", {"extensions": {"KHR_lights_punctual": {"light": 1}}})
    names = ["Lamp.001", "Bulb", "only"]
    scene = eclat.load(file.save(tmp_path))
    assert list(light_groups(scene)) == names
    (tmp_path / "again.glb").write_bytes(encode_glb(scene))
    assert list(light_groups(eclat.load(tmp_path / "again.glb"))) == names


def test_names_from_obj_materials(tmp_path: Path) -> None:
    (tmp_path / "a.mtl").write_text("newmtl neon\nKe 1 0 0\nnewmtl wall\nKd 0.5 0.5 0.5\n")
    square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    (tmp_path / "a.obj").write_text(f"mtllib a.mtl\no thing\n{square}usemtl neon\nf 1 2 3\nusemtl wall\nf 1 3 4\n")
    assert list(light_groups(eclat.load(tmp_path / "a.obj"))) == ["neon"]
