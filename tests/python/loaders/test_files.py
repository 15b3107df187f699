# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Names in scene files become paths safely, and unusable images get a stand-in."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from eclat.errors import EclatError, EclatWarning
from eclat.loaders.files import read_bytes, read_texture, resolve, texture_from_bytes
from support.gltf_files import png_bytes


def make(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(name.encode())


@pytest.mark.parametrize(
    "name", ["Maps/Wood.png", "maps/wood.PNG", "Maps\\Wood.png", "./Maps//Wood.png", "a/../Maps/Wood.png"]
)
@pytest.mark.parametrize("allow_parent", [True, False])
def test_spellings_of_one_file(tmp_path: Path, name: str, allow_parent: bool) -> None:
    make(tmp_path, "Maps/Wood.png", "a/b")
    assert read_bytes(resolve(tmp_path, name, where="x", allow_parent=allow_parent), where="x") == b"Maps/Wood.png"


def test_the_exact_name_wins_over_other_capitals(tmp_path: Path) -> None:
    make(tmp_path, "A.png", "a.png")
    assert resolve(tmp_path, "a.png", where="x").name == "a.png"
    assert resolve(tmp_path, "A.png", where="x").name == "A.png"


def test_parents_and_absolute_paths_where_they_are_allowed(tmp_path: Path) -> None:
    make(tmp_path, "scene/here.obj", "Other/mesh.obj")
    folder = tmp_path / "scene"
    for name in ("../Other/mesh.obj", "..\\other\\MESH.OBJ", str(tmp_path / "Other" / "mesh.obj")):
        assert resolve(folder, name, where="x", allow_parent=True).samefile(tmp_path / "Other" / "mesh.obj")
        with pytest.raises(
            EclatError, match=r"^x: expected a file in the scene's folder, got .* which leads out of it$"
        ):
            resolve(folder, name, where="x")


def test_a_path_of_another_machine_falls_back_to_the_name_with_a_warning(tmp_path: Path) -> None:
    make(tmp_path, "wood.png")
    with pytest.warns(
        EclatWarning, match="x: 'C:/Maps/wood.png' does not exist; the file 'wood.png' in the scene's folder"
    ):
        assert resolve(tmp_path, "C:\\Maps\\wood.png", where="x", allow_parent=True) == tmp_path / "wood.png"


@pytest.mark.parametrize("allow_parent", [True, False])
@pytest.mark.parametrize("name", ["", " ", "a\0b", "a\nb", "http://host/a", "file:///etc/passwd", "HTTPS:a"])
def test_texts_that_are_no_file_names_are_refused(tmp_path: Path, name: str, allow_parent: bool) -> None:
    with pytest.raises(EclatError, match=r"^room\.obj, map_Kd: expected (a file name|the name of a local file), got"):
        resolve(tmp_path, name, where="room.obj, map_Kd", allow_parent=allow_parent)


def test_names_that_the_system_refuses(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")
    for name in ("x" * 5000, "loop", "a\ud800"):
        with pytest.raises(EclatError):
            read_bytes(resolve(tmp_path, name, where="x"), where="x")


def test_links_that_lead_out_are_refused(tmp_path: Path) -> None:
    make(tmp_path, "secret", "scene/a")
    (tmp_path / "scene" / "link").symlink_to(tmp_path / "secret")
    with pytest.raises(EclatError, match="a symbolic link that leads out"):
        resolve(tmp_path / "scene", "link", where="x")
    (tmp_path / "scene" / "inner").symlink_to("a")
    assert read_bytes(resolve(tmp_path / "scene", "inner", where="x"), where="x") == b"scene/a"


def test_pipes_folders_and_large_files_are_not_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    make(tmp_path, "file")
    for name in ("pipe", "."):
        with pytest.raises(EclatError, match=r"^x: expected a file"):
            read_bytes(tmp_path / name, where="x")
    with pytest.raises(EclatError, match=r"expected a file of at most 3 bytes, got .* with 4 bytes"):
        read_bytes(tmp_path / "file", where="x", limit=3)


def test_a_texture_keeps_its_options(tmp_path: Path) -> None:
    pixels = np.arange(12).reshape(2, 2, 3)
    (tmp_path / "a.png").write_bytes(png_bytes(pixels))
    texture = read_texture(tmp_path / "a.png", srgb=True, where="x", wrap_u="clamp", filter="nearest")
    assert (texture.srgb, texture.wrap_u, texture.wrap_v, texture.filter) == (True, "clamp", "repeat", "nearest")
    assert texture.name == "a.png"
    np.testing.assert_array_equal(texture.image, pixels)


def test_stand_ins_are_visible_and_told(tmp_path: Path) -> None:
    with pytest.warns(
        EclatWarning, match="^room.obj, map_Kd: file not found: .*; a mauve and grey checkerboard is used instead$"
    ):
        color = read_texture(tmp_path / "gone.png", srgb=True, where="room.obj, map_Kd")
    assert color.srgb and color.image.min() > 100 and len(np.unique(color.image.reshape(-1, 3), axis=0)) == 2
    with pytest.warns(EclatWarning, match=r"the constant \(1.0, 1.0, 1.0\) is used instead"):
        data = read_texture(tmp_path / "gone.png", srgb=False, where="x")
    np.testing.assert_array_equal(data.image, [[[1, 1, 1]]])
    with pytest.warns(EclatWarning, match=r"cannot be decoded.*the constant \(0.5, 0.5, 1.0\) is used instead"):
        normal = texture_from_bytes(b"no image", srgb=False, where="x", neutral=(0.5, 0.5, 1.0))
    np.testing.assert_array_equal(normal.image, [[[0.5, 0.5, 1]]])
