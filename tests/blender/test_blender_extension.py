# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip of the extension follows the rules of Blender's manifests."""

import tomllib
import zipfile
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

import pytest

import eclat

ROOT = Path(__file__).parents[2]
LOADER = SourceFileLoader("build_blender_extension", str(ROOT / "tools/build_blender_extension"))
SPEC = spec_from_loader(LOADER.name, LOADER)
assert SPEC is not None
builder = module_from_spec(SPEC)
LOADER.exec_module(builder)


def wheels_in(folder, without=""):
    folder.mkdir()
    for package in builder.NEEDED:
        if package == without:
            continue
        for tag in ("cp311-cp311", "cp312-abi3"):
            (folder / f"{package}-1.0-{tag}-manylinux_2_36_x86_64.whl").write_bytes(b"")
    (folder / "numpy-2.0-cp313-cp313-manylinux_2_36_x86_64.whl").write_bytes(b"")
    return folder


def test_the_zip_holds_the_manifest_the_code_the_licence_and_the_wheels(tmp_path):
    target = builder.build(wheels_in(tmp_path / "wheels"), "linux-x64", tmp_path)
    with zipfile.ZipFile(target) as archive:
        names = archive.namelist()
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
    assert {"__init__.py", "blender_manifest.toml", "LICENSE", "engine.py"} <= set(names)
    assert not [name for name in names if "__pycache__" in name or "numpy" in name]
    assert sorted(f"./{name}" for name in names if name.endswith(".whl")) == sorted(manifest["wheels"])
    assert manifest["platforms"] == ["linux-x64"] and not list(builder.faults(manifest))
    assert target.name == f"eclat_blender-{eclat.__version__}-linux_x64.zip"


def test_a_missing_wheel_is_named(tmp_path):
    with pytest.raises(ValueError, match=r"no wheel of msgspec for Python 3\.11"):
        builder.build(wheels_in(tmp_path / "wheels", "msgspec"), "linux-x64", tmp_path)


def test_the_version_is_that_of_the_package():
    manifest = tomllib.loads((builder.SOURCE / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert manifest["version"] == eclat.__version__


@pytest.mark.parametrize(
    ("key", "value", "fault"),
    [
        ("id", "two__lines", "id must"), ("version", "1.0", "version must"), ("tags", ["Light"], "unknown tag"),
        ("license", ["GPL-3.0-or-later"], "license must"), ("blender_version_min", "4.1.0", "blender_version_min"),
        ("tagline", "Ends with a point.", "tagline must"), ("copyright", ["the authors"], "copyright must"),
        ("wheels", ["wheels/a.whl"], "not the path of a wheel"), ("name", "", "name is missing"),
        ("permissions", {"files": "x" * 65}, "files must"),
    ],
)  # fmt: skip
def test_broken_rules_are_named(key, value, fault):
    manifest = tomllib.loads((builder.SOURCE / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert not list(builder.faults(manifest))
    assert any(text.startswith(fault) for text in builder.faults(manifest | {key: value}))


def test_the_panel_lists_the_methods_of_eclat():
    import ast

    tree = ast.parse((builder.SOURCE / "settings.py").read_text(encoding="utf-8"))
    listed = next(n.value for n in tree.body if isinstance(n, ast.Assign) and n.targets[0].id == "METHODS")
    assert {name for name, _, _ in ast.literal_eval(listed)} == set(eclat.METHODS)
