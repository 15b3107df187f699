# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What is written: a scene that loads again, the same irradiance twice, and what it means."""

from __future__ import annotations

import hashlib
import io
import json
import pickle
import signal
import struct
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage

import eclat
from eclat.errors import EclatError
from eclat.images.tone import srgb_decode
from eclat.scene import PointLight
from eclat.scenes import build


@pytest.fixture(scope="module")
def baked() -> eclat.Lightmap:
    return eclat.bake(eclat.load("cornell-box"), texel_size=0.1, samples=16)


def chunks(path: Path) -> tuple[dict, bytes]:
    data = path.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def test_files(baked: eclat.Lightmap, tmp_path: Path) -> None:
    glb, exr, side_car = baked.save(tmp_path / "a room.glb")
    assert [p.name for p in (glb, exr, side_car)] == ["a room.glb", "a room.lightmap.exr", "a room.lightmap.json"]
    root, binary = chunks(glb)
    said = json.loads(side_car.read_text(encoding="utf-8"))
    assert root["asset"]["extras"]["eclat"]["lightmap"] == "a%20room.lightmap.json"
    assert root["asset"]["extras"]["eclat"]["lightmap_set"] == said["set"]
    (page,) = said["pages"]
    assert (said["version"], said["unit"], said["component"], said["method"]) == (
        1,
        "W/m2",
        "total",
        "irradiance-cache",
    )
    assert (said["glb"], page["exr"]) == ("a room.glb", "a room.lightmap.exr")
    np.testing.assert_array_equal(eclat.Image.load(exr).pixels, baked.irradiance)
    for material in root["materials"]:
        moz = material["extensions"]["MOZ_lightmap"]
        assert (moz["index"], moz["texCoord"], moz["intensity"]) == (page["gltf_texture"], 1, page["intensity"])
    view = root["bufferViews"][root["images"][root["textures"][page["gltf_texture"]]["source"]]["bufferView"]]
    png = binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
    pixels = np.asarray(PillowImage.open(io.BytesIO(png)))
    assert pixels.shape == baked.irradiance.shape == (page["height"], page["width"], 3)
    # The next byte up and the next one down enclose the value.
    low, high = (srgb_decode((pixels + step) / 255) * page["intensity"] for step in (-0.501, 0.501))
    inside = baked.irradiance <= page["intensity"]
    assert ((low <= baked.irradiance) & (baked.irradiance <= high))[inside].all()


KILLED = """
import os, pickle, signal, sys
with open("map.pickle", "rb") as file:
    lightmap = pickle.load(file)
real, left = os.replace, [int(sys.argv[1])]
def replace(source, target):
    if left[0] == 0:
        os.kill(os.getpid(), signal.SIGKILL)
    left[0] -= 1
    real(source, target)
os.replace = replace
lightmap.save("room.glb")
"""


@pytest.mark.parametrize("renames", [0, 1, 2, 3])
def test_a_kill_between_the_renames_leaves_a_scene_that_knows_its_files(
    baked: eclat.Lightmap, tmp_path: Path, renames: int
) -> None:
    glb, exr, side_car = baked.save(tmp_path / "room.glb")
    before = glb.read_bytes()
    with open(tmp_path / "map.pickle", "wb") as file:
        pickle.dump(replace(baked, irradiance=2 * baked.irradiance), file)
    run = subprocess.run([sys.executable, "-c", KILLED, str(renames)], cwd=tmp_path)
    assert run.returncode == (0 if renames == 3 else -signal.SIGKILL)
    assert (glb.read_bytes() == before) == (renames < 3)
    mark = chunks(glb)[0]["asset"]["extras"]["eclat"]["lightmap_set"]
    same = json.loads(side_car.read_bytes())["set"] == mark
    assert same == (renames in (0, 3))
    if same:
        assert hashlib.sha256(exr.read_bytes()).hexdigest().startswith(mark)


def test_a_solution_describes_itself_in_one_line(baked: eclat.Lightmap) -> None:
    size = "{1} x {0}".format(*baked.irradiance.shape)
    assert repr(baked) == f"<Lightmap of cornell-box: {size} texels of 0.1 m, total light by irradiance-cache>"


def test_the_scene_comes_back(baked: eclat.Lightmap, tmp_path: Path) -> None:
    again = eclat.load(baked.save(tmp_path / "room.glb")[0])
    before, after = (
        eclat.render(scene, eclat.Path(), size=(24, 24), samples=16, seed=3).pixels for scene in (baked.scene, again)
    )
    # Vertices have changed their order, so that other points of the light are drawn: noise, and no more.
    assert after.mean() == pytest.approx(before.mean(), rel=0.05)
    for a, b in zip(baked.scene.meshes, again.meshes, strict=True):
        np.testing.assert_allclose(
            np.asarray(a.positions)[a.triangles], np.asarray(b.positions)[b.triangles], atol=1e-6
        )


def test_few_bright_texels_are_clipped(baked: eclat.Lightmap) -> None:
    irradiance = np.ones((100, 100, 3), np.float32)
    irradiance[0, 0] = 50
    spotty = replace(baked, irradiance=irradiance)
    assert spotty.intensity() == 1 and spotty.clipped_share() == pytest.approx(1e-4)
    irradiance[0] = 50
    assert replace(baked, irradiance=irradiance).intensity() == 50
    dark = replace(baked, irradiance=np.zeros((4, 4, 3), np.float32))
    assert dark.intensity() == 1 and dark.clipped_share() == 0


def test_lights_are_written_beside_indirect_light_only(tmp_path: Path) -> None:
    scene = replace(eclat.load("cornell-box"), lights=(PointLight((0, 0.5, 0), (1, 1, 1)),), photometric=True)
    for component, count in (("total", 0), ("direct", 0), ("indirect", 1)):
        lightmap = eclat.bake(scene, eclat.Path(), component=component, texel_size=0.2, samples=1)  # type: ignore[arg-type]
        glb, _, side_car = lightmap.save(tmp_path / f"{component}.glb")
        assert len(eclat.load(glb).lights) == count
        assert json.loads(side_car.read_text())["unit"] == "lux"


def test_places_that_cannot_be_written(baked: eclat.Lightmap, tmp_path: Path) -> None:
    with pytest.raises(EclatError, match=r"ends in \.glb"):
        baked.save(tmp_path / "room.gltf")
    with pytest.raises(EclatError, match="does not exist"):
        baked.save(tmp_path / "nowhere" / "room.glb")
    (tmp_path / "room.lightmap.json").mkdir()
    with pytest.raises(EclatError, match="folder or a device"):
        baked.save(tmp_path / "room.glb")
    assert not (tmp_path / "room.glb").exists() and not (tmp_path / "room.lightmap.exr").exists()


def test_sheets_that_were_split_for_export_are_joined_when_loaded(tmp_path: Path) -> None:
    scene = build("two-rooms")
    lightmap = eclat.bake(scene, eclat.Path(), texel_size=0.2, samples=1)
    assert [part.mesh.name for part in lightmap.parts if part.back] == ["shell"]
    again = eclat.load(lightmap.save(tmp_path / "rooms.glb")[0])
    assert [mesh.name for mesh in again.meshes] == [mesh.name for mesh in scene.meshes]
    assert all(mesh.material.two_sided for mesh in again.meshes)
    for a, b in zip(scene.meshes, again.meshes, strict=True):
        np.testing.assert_allclose(
            np.asarray(a.positions)[a.triangles], np.asarray(b.positions)[b.triangles], atol=1e-6
        )
