# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`eclat.load`: what is loaded by whom, and what is said when nothing is."""

from __future__ import annotations

import importlib
import subprocess
import sys
import threading
import warnings
from pathlib import Path

import pytest

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.loaders import SUFFIXES, load, load_dict

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def test_every_suffix_has_its_loader() -> None:
    for module, function in SUFFIXES.values():
        assert callable(getattr(importlib.import_module(module), function))


def test_eclat_load_is_the_load_of_the_loaders() -> None:
    assert eclat.load is load


def test_files_by_suffix_in_any_capitals(tmp_path: Path) -> None:
    path = tmp_path / "Test.OBJ"
    path.write_text(TRIANGLE)
    for given in (path, str(path)):
        assert len(load(given).meshes) == 1


def test_xml_and_dict(tmp_path: Path) -> None:
    (tmp_path / "room.xml").write_text('<scene version="3.0.0"><shape type="$kind"/></scene>')
    assert len(load(tmp_path / "room.xml", kind="rectangle").meshes) == 1
    (tmp_path / "test.obj").write_text(TRIANGLE + "curv 1\n")
    with pytest.warns(EclatWarning, match="'curv'"):
        scene = load_dict({"type": "scene", "shape": {"type": "obj", "filename": "test.obj"}}, tmp_path)
    assert any("'curv'" in message for message in scene.warnings)


def test_built_in_scenes_by_name_with_parameters() -> None:
    assert load("cornell-box").meshes
    assert load("furnace", rho=0.5).meshes
    with pytest.raises(EclatError, match=r"expected one of .*, got 'rhoo'; did you mean 'rho'"):
        load("furnace", rhoo=0.5)


def test_warnings_are_issued_and_kept(tmp_path: Path) -> None:
    path = tmp_path / "test.obj"
    path.write_text("mtllib none.mtl\n" + TRIANGLE + "f 1 1 2\n")
    with pytest.warns(EclatWarning) as caught:
        scene = load(path)
    assert scene.warnings == tuple(str(warning.message) for warning in caught)
    assert [message.partition(":")[0] for message in scene.warnings] == ["test.obj", "test.obj, line 1"]


def test_warnings_are_issued_even_if_loading_fails(tmp_path: Path) -> None:
    path = tmp_path / "test.obj"
    path.write_text("curv 0\n")
    with pytest.warns(EclatWarning, match="'curv'"), pytest.raises(EclatError):
        load(path)


def test_warnings_as_errors_are_the_user_s_choice(tmp_path: Path) -> None:
    path = tmp_path / "test.obj"
    path.write_text("curv 0\n" + TRIANGLE)
    with warnings.catch_warnings(), pytest.raises(EclatWarning):
        warnings.simplefilter("error", EclatWarning)
        load(path)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("room.obk", r"expected a scene file \(\.gltf, .*\), got one with the suffix '\.obk'; did you mean '\.obj'\?"),
        ("room.png", r"got one with the suffix '\.png'$"),
        ("romo.obj", r"romo\.obj: expected a scene file, but no such file exists; did you mean 'room\.obj'\?"),
        ("absent/room.obj", r"expected a scene file, but no such file exists$"),
        ("folder.obj", "expected a scene file, got a folder"),
        ("", r"expected a scene file .* or a built-in scene \(cornell-box, .*\), got a folder"),
        ("a\0.obj", "but no such file exists"),
        ("x" * 300 + ".obj", "but no such file exists"),
    ],
)
def test_files_that_are_not_scenes_are_refused(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "room.obj").write_text(TRIANGLE)
    (tmp_path / "folder.obj").mkdir()
    with pytest.raises(EclatError, match=message):
        load(tmp_path / name)


def test_an_unknown_name_suggests_the_nearest() -> None:
    with pytest.raises(EclatError, match=r"^cornel-box: expected .*, got 'cornel-box'; did you mean 'cornell-box'\?"):
        load("cornel-box")


def test_parameters_are_refused_where_nobody_reads_them(tmp_path: Path) -> None:
    (tmp_path / "room.obj").write_text(TRIANGLE)
    with pytest.raises(EclatError, match=r"expected no parameters, because .*, got rho$"):
        load(tmp_path / "room.obj", rho=0.5)


@pytest.mark.parametrize("suffix", sorted(SUFFIXES))
def test_empty_files_are_errors(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"empty{suffix}"
    path.write_bytes(b"")
    with pytest.raises(EclatError, match=r"empty\."):
        load(path)


def test_only_the_needed_loader_is_imported(tmp_path: Path) -> None:
    (tmp_path / "room.ply").write_text("ply\n")
    code = (
        "import sys, eclat.loaders\n"
        "try: eclat.loaders.load(sys.argv[1])\n"
        "except eclat.loaders.EclatError: pass\n"
        "print([m for m in sys.modules if m.startswith('eclat.loaders.')])"
    )
    found = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "room.ply")], capture_output=True, text=True, check=True
    )
    assert "eclat.loaders.ply" in found.stdout
    assert "gltf" not in found.stdout and "mitsuba" not in found.stdout and "mtl" not in found.stdout


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")
def test_every_real_scene_loads(scenes: Path) -> None:
    paths = [path for path in sorted(scenes.rglob("*")) if path.suffix.lower() in SUFFIXES]
    assert len(paths) > 40
    for path in paths:
        assert load(path).meshes, path


def test_scenes_loaded_in_two_threads_keep_their_own_warnings(tmp_path: Path) -> None:
    for name in ("a", "b"):
        text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" * 50 + f"odd_{name} 1\n"
        (tmp_path / f"{name}.obj").write_text(text)
    found: dict[str, set[tuple[str, ...]]] = {"a": set(), "b": set()}

    def work(name: str) -> None:
        for _ in range(20):
            found[name].add(eclat.load(tmp_path / f"{name}.obj").warnings)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        threads = [threading.Thread(target=work, args=(name,)) for name in found]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
    for name, seen in found.items():
        ((text,),) = seen
        assert f"odd_{name}" in text
