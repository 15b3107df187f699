# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Every Mitsuba scene of the shared folder loads; numbers that are known about each hold."""

from __future__ import annotations

import functools
import os
import warnings
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from eclat.loaders.mitsuba import load_xml
from eclat.scene import Scene

FOLDER = Path(os.environ.get("ECLAT_SCENES", Path(__file__).resolve().parents[5] / "shared" / "scenes"))

# scene: meshes, at least so many triangles, (width, height), a text in each warning
SCENES = {
    "targets/cbox-diffuse.xml": (8, 34, (512, 512), ()),
    "targets/cbox-glossy.xml": (8, 34, (512, 512), ()),
    "targets/sponza-sun.xml": (19, 60_000, (512, 512), ()),
    "sibenik/nave.xml": (None, 70_000, (1280, 720), None),
    "sibenik/nave-polished.xml": (None, 70_000, (1280, 720), None),
    "sponza-dabrovic/sun.xml": (None, 60_000, (1280, 720), None),
    "sponza-dabrovic/sponza.xml": (38, 60_000, (768, 575), ()),
    "cornell-box-mitsuba/cbox.xml": (8, 32, (512, 512), ()),
    "bitterli-veach-bidir/scene.xml": (14, 1000, (1024, 1024), ("path_guiding_integrator|the integrator type",)),
    "veach-door/scene.xml": (22, 20_000, (1280, 720), ("coating over a diffuse BSDF is replaced by plastic", "")),
}


@functools.cache
def load(name: str) -> tuple[Scene, list[str]]:
    path = FOLDER / name
    if not path.exists():
        pytest.skip(f"{name} is not in {FOLDER} (set ECLAT_SCENES)")
    with warnings.catch_warnings(record=True) as record:
        warnings.simplefilter("always")
        return load_xml(path), [str(warning.message) for warning in record]


@pytest.mark.parametrize("name", SCENES)
def test_every_scene_loads(name: str) -> None:
    meshes, triangles, size, messages = SCENES[name]
    scene, warned = load(name)
    assert meshes is None or len(scene.meshes) == meshes
    assert sum(len(mesh.triangles) for mesh in scene.meshes) >= triangles
    assert scene.cameras[0].size == size
    assert scene.up == (0, 1, 0)
    assert any(mesh.material.emission for mesh in scene.meshes) or scene.lights
    assert all(np.isfinite(mesh.positions).all() for mesh in scene.meshes)
    if messages == ():
        assert [message for message in warned if "rfilter" not in message] == []


def test_polish_replaces_one_material_of_sibenik() -> None:
    plain, _ = load("sibenik/nave.xml")
    polished, _ = load("sibenik/nave-polished.xml")
    changed = [
        (before.material, after.material)
        for before, after in zip(plain.meshes, polished.meshes, strict=True)
        if before.material.kind != after.material.kind
        or before.material.parameters.keys() != after.material.parameters.keys()
    ]
    (pair,) = changed
    assert pair[0].name == "pod" and pair[1].kind == "plastic"
    assert pair[1].parameters["alpha_u"].constant[0] == 0.2


def test_cornell_boxes_colours_are_mitsubas() -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    scene, _ = load("cornell-box-mitsuba/cbox.xml")
    # Mitsuba 3 refuses the file for its <lookAt>: give it the colours alone.
    tree = ElementTree.parse(FOLDER / "cornell-box-mitsuba" / "cbox.xml")
    for name in ("white", "red", "green"):
        ours = next(mesh.material for mesh in scene.meshes if mesh.material.name == name)
        bsdf = tree.find(f"bsdf[@id='{name}']")
        assert bsdf is not None
        bsdf.set("version", "3.0.0")
        theirs = mi.traverse(mi.load_string(ElementTree.tostring(bsdf, "unicode")))["reflectance.value"]
        assert np.allclose(ours.parameters["reflectance"].constant, theirs, atol=0.005)
    lamp = next(mesh.material.emission for mesh in scene.meshes if mesh.material.emission)
    spectrum = tree.find("shape/emitter/spectrum")
    assert spectrum is not None
    text = ElementTree.tostring(spectrum, "unicode")
    constant = mi.load_string(f'<emitter version="3.0.0" type="constant">{text}</emitter>')
    interaction = mi.SurfaceInteraction3f()
    interaction.wi = [0, 0, 1]
    assert np.allclose(lamp.constant, constant.eval(interaction), rtol=0.01)
