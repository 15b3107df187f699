# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""With a root, no file outside of it is read, whatever the format calls it and however the path leads there."""

from __future__ import annotations

import json
import os
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.cli import main
from eclat.errors import EclatError, EclatWarning
from eclat.files.arrays import read_file
from eclat.files.confinement import confined_to, is_outside
from fuzz.corpus import ply_file, serialized_file
from support.gltf_files import png_bytes

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
RED = np.full((2, 2, 3), (255, 0, 0), np.uint8)
SHAPE = '<shape type="{}"><string name="filename" value="{}"/></shape>'
QUAD = '<shape type="rectangle"><bsdf type="diffuse">{}</bsdf></shape>'
BITMAP = '<texture name="reflectance" type="bitmap"><string name="filename" value="{}"/></texture>'
GLTF = {
    "asset": {"version": "2.0"},
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
}
HIDDEN = {
    "part.xml": b'<scene version="3.0.0"><shape type="sphere"/></scene>',
    "a.obj": (TRIANGLE + "f 1 2 3\n").encode(),
    "a.mtl": b"newmtl m\nKd 1 0 0\n",
    "a.ply": ply_file("binary_little_endian"),
    "a.serialized": serialized_file(4),
    "a.png": png_bytes(RED),
    "a.pfm": b"PF\n2 2\n-1\n" + np.ones((2, 2, 3), "<f4").tobytes(),
    "a.spd": b"300 0.3\n900 0.3\n",
    "a.bin": np.eye(3, dtype="<f4").tobytes(),
}
"""Files outside of the root."""


def xml(body: str) -> str:
    return f'<scene version="3.0.0">{body}</scene>'


NAMING = {
    # The file that is named, the file that names it, and its content with {} for the name.
    "include": ("part.xml", "s.xml", xml('<include filename="{}"/>')),
    "obj": ("a.obj", "s.xml", xml(SHAPE.format("obj", "{}"))),
    "ply": ("a.ply", "s.xml", xml(SHAPE.format("ply", "{}"))),
    "serialized": ("a.serialized", "s.xml", xml(SHAPE.format("serialized", "{}"))),
    "bitmap": ("a.png", "s.xml", xml(QUAD.format(BITMAP))),
    "environment": ("a.pfm", "s.xml", xml('<emitter type="envmap"><string name="filename" value="{}"/></emitter>')),
    "spectrum": ("a.spd", "s.xml", xml(QUAD.format('<spectrum name="reflectance" filename="{}"/>'))),
    "mtllib": ("a.mtl", "s.obj", "mtllib {}\n" + TRIANGLE + "usemtl m\nf 1 2 3\n"),
    "texturefile": ("a.png", "s.ply", "comment TextureFile {}\n"),
    "buffer": ("a.bin", "s.gltf", json.dumps(GLTF | {"buffers": [{"byteLength": 36, "uri": "URI"}]})),
}


def written(folder: Path, kind: str, name: str) -> Path:
    """The scene file that names a file `name` as `kind` does."""
    _, scene, content = NAMING[kind]
    path = folder / scene
    if kind == "texturefile":
        path.write_bytes(ply_file("ascii", texture=True).replace(b"a.png", name.encode()))
    else:
        path.write_text(content.replace("URI" if kind == "buffer" else "{}", name))
    return path


def outcome(path: Path, root: Path | None) -> str:
    """Everything that was refused or replaced, as text."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EclatWarning)
        try:
            return "\n".join(eclat.load(path, root=root).warnings)
        except EclatError as error:
            return str(error)


@pytest.fixture
def root(tmp_path: Path) -> Path:
    (tmp_path / "outside").mkdir()
    for name, content in HIDDEN.items():
        (tmp_path / "outside" / name).write_bytes(content)
    (tmp_path / "root" / "scene").mkdir(parents=True)
    return tmp_path / "root"


@pytest.mark.parametrize("way", ["parent", "absolute", "link", "linked folder"])
@pytest.mark.parametrize("kind", list(NAMING))
def test_files_outside_are_refused(root: Path, kind: str, way: str) -> None:
    hidden = NAMING[kind][0]
    folder, outside = root / "scene", root.parent / "outside"
    name = {
        "parent": f"../../outside/{hidden}",
        "absolute": str(outside / hidden),
        "link": "link" + Path(hidden).suffix,
    }
    if way == "link":
        (folder / name[way]).symlink_to(outside / hidden)
    if way == "linked folder":
        (folder / "linked").symlink_to(outside)
    path = written(folder, kind, name.get(way, f"linked/{hidden}"))
    if kind != "buffer":
        # Without a root, the same file is read: it is the root that refuses it.
        assert outcome(path, None) == outcome(path, root.parent)
        assert "lies outside" not in outcome(path, None)
    said = outcome(path, root)
    assert "lies outside" in said or "leads out of it" in said, said
    refusals = [line for line in said.splitlines() if "outside" in line or "leads out" in line]
    assert len(refusals) == 1, refusals


@pytest.mark.parametrize("kind", list(NAMING))
def test_files_below_are_read(root: Path, kind: str) -> None:
    hidden = NAMING[kind][0]
    (root / "scene" / hidden).write_bytes(HIDDEN[hidden])
    path = written(root / "scene", kind, hidden)
    assert outcome(path, root) == outcome(path, None)
    if kind != "buffer":
        (root / hidden).write_bytes(HIDDEN[hidden])
        assert "lies outside" not in outcome(written(root / "scene", kind, f"../{hidden}"), root)


def test_textures_of_mtl_files(root: Path) -> None:
    (root / "s.obj").write_text("mtllib s.mtl\n" + TRIANGLE + "usemtl m\nf 1 2 3\n")
    (root / "s.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd ../outside/a.png\n")
    assert "lies outside" in outcome(root / "s.obj", root)
    assert "checkerboard" not in outcome(root / "s.obj", None)


def test_what_is_there_is_not_told(root: Path) -> None:
    """A file outside that exists is refused in the same words as one that does not."""
    there = outcome(written(root, "obj", "../outside/a.obj"), root)
    absent = outcome(written(root, "obj", "../outside/b.obj"), root)
    assert there.replace("a.obj", "b.obj") == absent


def test_a_path_of_another_machine_finds_the_file_beside_the_scene(root: Path) -> None:
    (root / "a.obj").write_bytes(HIDDEN["a.obj"])
    said = outcome(written(root, "obj", str(root.parent / "outside" / "a.obj")), root)
    assert "lies outside the root folder; the file 'a.obj' in the scene's folder is used" in said


def test_the_scene_itself_and_dicts(root: Path) -> None:
    (root / "s.obj").symlink_to(root.parent / "outside" / "a.obj")
    assert "lies outside" in outcome(root / "s.obj", root)
    assert "lies outside" in outcome(root / "scene" / ".." / ".." / "outside" / "a.obj", root)
    shape = {"type": "scene", "a": {"type": "obj", "filename": "../outside/a.obj"}}
    assert len(eclat.load_dict(shape, root).meshes) == 1
    with pytest.raises(EclatError, match="lies outside"):
        eclat.load_dict(shape, root, root=root)


def test_folders_that_are_none(root: Path) -> None:
    (root / "file").write_text("")
    for bad in (root / "none", root / "file", "\0", "n" * 300):
        with pytest.raises(EclatError, match=r"^root: expected an existing folder, got "):
            eclat.load("cornell-box", root=bad)


def test_a_root_may_be_a_link_and_ends_with_its_block(root: Path) -> None:
    (root.parent / "alias").symlink_to(root)
    (root / "a.obj").write_bytes(HIDDEN["a.obj"])
    with confined_to(root.parent / "alias"):
        assert read_file(root / "a.obj", where="x") and not is_outside(root.parent / "alias" / "a.obj")
        assert is_outside(f"{root}-other/a.obj")
        with pytest.raises(
            EclatError, match=r"^x: expected a file below the root folder, got .*, which lies outside of it$"
        ):
            read_file(root.parent / "outside" / "a.obj", where="x")
    assert read_file(root.parent / "outside" / "a.obj", where="x")


def test_two_threads_have_two_roots(root: Path) -> None:
    seen = []
    with confined_to(root):
        thread = threading.Thread(target=lambda: seen.append(is_outside("/")))
        thread.start()
        thread.join()
        assert is_outside("/")
    assert seen == [False]


@pytest.mark.parametrize("command", ["info", "render", "solve", "bake", "irradiance", "compare"])
def test_every_command_that_loads_a_scene(command: str, root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    os.chdir(root)
    Path("points.csv").write_text("0 0.5 0 0 1 0\n")
    written(root, "obj", "../outside/a.obj")
    beside = {"irradiance": ["--points", "points.csv"]}.get(command, [])
    assert main([command, "s.xml", "--root", ".", *beside]) == 2
    *begun, line = capsys.readouterr().err.splitlines()
    assert "lies outside" in line
    assert begun == (["eclat: load 0 %"] if command == "bake" else []), "a bake tells at once what it does"
