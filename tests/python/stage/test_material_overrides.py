# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Other materials by name, in scenes from every loader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Picture

import eclat
from eclat.errors import EclatError
from eclat.scene import Material, Scene, grey
from eclat.stage.material_overrides import material_names, override_materials, parsed_override
from support.gltf_files import GltfFile

POLISH = {"type": "roughplastic", "distribution": "ggx", "alpha": 0.2}

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"


def obj(folder: Path) -> Path:
    """A floor with a textured, half transparent material, and a wall."""
    Picture.new("RGB", (2, 2), (200, 100, 50)).save(folder / "tiles.png")
    (folder / "hall.mtl").write_text("newmtl tiles\nmap_Kd tiles.png\nKd 1 1 1\nd 0.5\nnewmtl wall\nKd 0.2 0.3 0.4\n")
    faces = "usemtl tiles\nf 1/1 2/2 3/3\nusemtl wall\nf 1/1 3/3 2/2\n"
    (folder / "hall.obj").write_text("mtllib hall.mtl\n" + TRIANGLE + faces)
    return folder / "hall.obj"


def xml(folder: Path) -> Path:
    obj(folder)
    inner = '<bsdf type="diffuse" name="tiles"><rgb name="reflectance" value="0.1, 0.2, 0.3"/></bsdf>'
    shape = f'<shape type="obj"><string name="filename" value="hall.obj"/>{inner}</shape>'
    (folder / "hall.xml").write_text(f'<scene version="3.0.0">{shape}</scene>')
    return folder / "hall.xml"


def gltf(folder: Path) -> Path:
    file = GltfFile()
    file.append("materials", {"name": "tiles", "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1]}})
    file.mesh_node(file.primitive(material=0))
    return file.save(folder)


def ply(folder: Path) -> Path:
    header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    (folder / "tiles.ply").write_text(header + faces + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    return folder / "tiles.ply"


def only(scene: Scene, name: str) -> Material:
    (found,) = {id(m.material): m.material for m in scene.meshes if name in (m.material.name, m.name)}.values()
    return found


@pytest.mark.parametrize("file", [obj, xml, gltf, ply])
def test_a_floor_is_polished_in_a_scene_from_any_format(file, tmp_path: Path) -> None:
    scene = eclat.load(file(tmp_path))
    assert "tiles" in material_names(scene)
    polished = override_materials(scene, {"tiles": POLISH})
    floor, before = only(polished, "tiles"), only(scene, "tiles")
    assert floor.kind == "plastic" and floor.distribution == "ggx"
    assert floor.parameters["alpha_u"].constant == (0.2, 0.2, 0.2)
    # What was not said stays.
    colour = next(before.parameters[n] for n in ("reflectance", "base_color") if n in before.parameters)
    assert floor.parameters["diffuse_reflectance"] is colour
    assert floor.opacity is before.opacity and floor.two_sided == before.two_sided
    others = [m.material for m in polished.meshes if m.material is not floor]
    assert others == [m.material for m in scene.meshes if m.material is not before]


def test_a_built_in_scene_by_the_name_of_a_mesh() -> None:
    scene = eclat.load("cornell-box")
    metal = Material("conductor", {"alpha_u": grey(0.3)}, name="metal")
    changed = override_materials(scene, {"floor": metal})
    assert [m.material is metal for m in changed.meshes] == [m.name == "floor" for m in scene.meshes]
    # The name of a material means all that is made of it.
    changed = override_materials(scene, {"white": {"type": "diffuse", "reflectance": 0.3}})
    whites = [m.material for m in changed.meshes if m.material.name == "white"]
    before = [m.material for m in scene.meshes if m.material.name == "white"]
    assert len(whites) == len(before) == 5
    assert len({id(w) for w in whites}) == len({id(w) for w in before})
    assert all(w.parameters["reflectance"].constant == (0.3, 0.3, 0.3) for w in whites)


def test_refining_does_not_move_light() -> None:
    changed = override_materials(eclat.load("cornell-box"), {"light": POLISH})
    assert only(changed, "light").emission is not None


def test_the_picture_shows_it() -> None:
    scene = eclat.load("cornell-box")
    mirror = override_materials(scene, {"floor": {"type": "conductor"}})
    a, b = (eclat.render(s, eclat.Path(), samples=1, size=(8, 8)).pixels for s in (scene, mirror))
    assert not np.array_equal(a, b)


MISTAKES = {
    "flor": (
        POLISH,
        "material 'flor': expected one of light, white, green, red, back, ceiling, .*did you mean 'floor'",
    ),
    "floor": (
        {"type": "roughplastik"},
        "material 'floor': expected a BSDF whose type is one of .*'roughplastik'; did you mean 'roughplastic'",
    ),
    "white": (
        POLISH | {"aplha": 0.2},
        "material 'white': expected a property of the BSDF type roughplastic, got 'aplha'; did you mean 'alpha'",
    ),
    "red": ({"type": "roughplastic", "alpha": "rough"}, "material 'red': .*expected"),
    "green": ({"alpha": 0.2}, "material 'green': expected a BSDF whose type is one of .*got None"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_are_named(name: str) -> None:
    given, message = MISTAKES[name]
    with pytest.raises(EclatError, match=message):
        override_materials(eclat.load("cornell-box"), {name: given})


def test_the_text_of_a_flag() -> None:
    assert parsed_override("floor=roughplastic, alpha=0.2,distribution=ggx") == (
        "floor", {"type": "roughplastic", "alpha": 0.2, "distribution": "ggx"},
    )  # fmt: skip
    assert parsed_override("a=diffuse,reflectance=0.1 0.2 0.3")[1]["reflectance"] == {
        "type": "rgb", "value": [0.1, 0.2, 0.3],
    }  # fmt: skip


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("floor", "expected NAME=KIND,property=value"),
        ("floor=", "expected NAME=KIND"),
        ("=diffuse", "expected NAME=KIND"),
        ("floor=alpha=0.2", "expected NAME=KIND"),
        ("floor=diffuse,0.3", "floor: expected property=value after the kind, got '0.3'"),
        ("floor=plastic,alpha=1,alpha=2", "floor: alpha is given twice, expected it once"),
    ],
)
def test_bad_texts(text: str, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        parsed_override(text)
