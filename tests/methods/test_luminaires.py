# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Measured luminaires in pictures and at points, for every method, against I / d² and against each format."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.gltf_export import encode_glb
from eclat.intensity_profile import IntensityProfile
from eclat.loaders.ies import encode_ies
from eclat.measure.photometry import LUMENS_PER_WATT
from eclat.scene import Material, Mesh, ProfileLight, Scene, grey
from eclat.scenes import build
from support.gltf_files import GltfFile
from support.luminaires import cosine_lamp, lopsided_lamp
from support.quick_methods import GLOBAL, QUICK
from support.statistics import block_means

HEIGHT = 2.0
PLACES = np.array([[0, 0, 0], [0.5, 0, 0], [-1, 0, 0.7], [0.2, 0, -1.5], [2, 0, 2]], np.float64)
UP = np.tile([0.0, 1.0, 0.0], (len(PLACES), 1))


def floor_below(profile: IntensityProfile, **more: Any) -> Scene:
    corners = np.array([[-9, 0, -9], [-9, 0, 9], [9, 0, 9], [9, 0, -9.0]])
    floor = Mesh(corners, np.array([(0, 1, 2), (0, 2, 3)]), Material(parameters={"reflectance": grey(0.5)}))
    return Scene((floor,), (ProfileLight((0, HEIGHT, 0), profile, **more),), photometric=True)


def expected(profile: IntensityProfile, intensity: Any) -> np.ndarray:
    """I cos / d² at the places, by a function of V and H in radians; the lamp aims down, with +x of its frame along +x."""
    x, z = PLACES[:, 0], PLACES[:, 2]
    d2 = x**2 + z**2 + HEIGHT**2
    v, h = np.arctan2(np.hypot(x, z), HEIGHT), np.arctan2(-z, x)  # +y of the frame is −z of the world
    return intensity(v, h) / d2 * (HEIGHT / np.sqrt(d2))


CASES: dict[str, tuple[IntensityProfile, Any]] = {
    "cosine": (cosine_lamp(), lambda v, h: 100 * np.cos(v)),
    "lopsided": (lopsided_lamp(), lambda v, h: 100 * (1 + np.cos(h) / 2 + np.sin(h) / 4) * np.sin(v) ** 2),
}


@pytest.mark.parametrize("name", CASES)
def test_illuminance_is_intensity_by_distance_squared(name: str) -> None:
    profile, intensity = CASES[name]
    found = eclat.irradiance(floor_below(profile, scale=(1, 0.5, 0)), PLACES, UP, "direct")
    exact = expected(profile, intensity)
    np.testing.assert_allclose(found, exact[:, None] * (1, 0.5, 0), rtol=2e-3, atol=1e-3)


@pytest.mark.parametrize("method", GLOBAL)
def test_all_methods_agree(method: str) -> None:
    box = build("cornell-box")
    dark = tuple(replace(mesh, material=replace(mesh.material, emission=None)) for mesh in box.meshes)
    turn = np.array([[1, 0, 0], [0, 0.6, 0.8], [0, -0.8, 0.6]])
    light = ProfileLight((0.1, 0.3, 0.3), lopsided_lamp(10), (0.01, 0.01, 0.01), turn)
    scene = replace(box, meshes=dark, lights=(light,))
    image = eclat.render(scene, QUICK[method], samples=64, size=(32, 32), check=False, denoise=False).pixels
    truth = eclat.render(scene, "path", samples=256, size=(32, 32), seed=5, denoise=False).pixels
    ours, theirs = block_means(image, 8), block_means(truth, 8)
    assert np.sqrt(np.mean((ours - theirs) ** 2 / (theirs**2 + (0.1 * theirs.mean()) ** 2))) < 0.03


def test_from_mitsuba(tmp_path: Path) -> None:
    (tmp_path / "lamp.ies").write_bytes(encode_ies(lopsided_lamp()))
    scene = eclat.load_dict(
        {
            "type": "scene",
            "lamp": {
                "type": "ies", "filename": str(tmp_path / "lamp.ies"), "scale": 2.0,
                "to_world": np.array([[1, 0, 0, 0], [0, 0, -1, HEIGHT], [0, 1, 0, 0], [0, 0, 0, 1.0]]),
            },
        }
    )  # fmt: skip
    (light,) = scene.lights
    assert isinstance(light, ProfileLight) and light.name == "lamp"
    # +z of the emitter points down, and so does −z of the frame.
    np.testing.assert_allclose(light.to_world @ (0, 0, -1), (0, -1, 0), atol=1e-12)
    floor = floor_below(lopsided_lamp())
    found = eclat.irradiance(replace(floor, lights=(light,), photometric=False), PLACES, UP, "direct")
    frame_is_turned = CASES["lopsided"][1]
    exact = expected(lopsided_lamp(), lambda v, h: frame_is_turned(v, h)) * 2 / LUMENS_PER_WATT
    np.testing.assert_allclose(found[:, 0], exact, rtol=2e-3, atol=1e-5)


@pytest.mark.parametrize("embedded", [False, True])
def test_from_gltf_and_back(tmp_path: Path, embedded: bool) -> None:
    data = encode_ies(lopsided_lamp())
    file = GltfFile()
    corners = [[-9, 0, -9], [-9, 0, 9], [9, 0, 9], [9, 0, -9]]
    file.mesh_node(file.primitive(corners, [0, 1, 2, 0, 2, 3]))
    entry: dict[str, Any] = {"uri": "lamp.ies"}
    if embedded:
        entry = {"bufferView": file.view(data), "mimeType": "application/x-ies-lm-63"}
    (tmp_path / "lamp.ies").write_bytes(data)
    file.json["extensions"] = {"EXT_lights_ies": {"lights": [entry]}}
    half = 0.5**0.5
    use = {"EXT_lights_ies": {"light": 0, "multiplier": 3, "color": [1, 0.5, 0]}}
    # −z turns down by −90° about x; the scale does not matter.
    file.append(
        "nodes", {"extensions": use, "translation": [0, HEIGHT, 0], "rotation": [-half, 0, 0, half], "scale": [2, 2, 2]}
    )
    scene = eclat.load(file.save(tmp_path))
    assert scene.photometric
    exact = 3 * expected(lopsided_lamp(), CASES["lopsided"][1])[:, None] * (1, 0.5, 0)
    found = eclat.irradiance(scene, PLACES, UP, "direct")
    np.testing.assert_allclose(found, exact, rtol=2e-3, atol=1e-3)
    (tmp_path / "again.glb").write_bytes(encode_glb(scene))
    again = eclat.irradiance(eclat.load(tmp_path / "again.glb"), PLACES, UP, "direct")
    np.testing.assert_allclose(again, found, rtol=1e-5, atol=1e-6)


def test_a_profile_that_is_no_rotation_is_refused() -> None:
    with pytest.raises(eclat.EclatError, match="to_world must be a 3×3 rotation"):
        eclat.irradiance(floor_below(cosine_lamp(), to_world=np.ones((3, 3))), PLACES, UP, "direct")
