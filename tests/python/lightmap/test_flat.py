# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Lit scenes for viewers without light maps: the colours that they show are the light that a render finds."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError
from eclat.lightmap.flat import evaluate
from eclat.scene import Material, PointLight, Scene, Texture, Value, grey
from support.planes import square

CHECKS = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)


def test_cornell_box_looks_as_it_should(tmp_path: Path) -> None:
    """Unlit materials load as emission alone: their picture beside one by paths."""
    scene = eclat.load("cornell-box")
    lightmap = eclat.bake(scene, texel_size=0.08, samples=128)
    stops = -1.0
    flat = eclat.load(lightmap.save_flat(tmp_path / "flat.glb", exposure=stops))
    camera = scene.cameras[0]
    shown = eclat.render(replace(flat, cameras=(camera,)), eclat.Path(), size=(48, 48), samples=16).pixels
    truth = np.minimum(eclat.render(scene, eclat.Path(), size=(48, 48), samples=1024).pixels * 2**stops, 1)
    # Pixels at the lamp's edge are a mean of clipped values in one, and the clipped mean in the other.
    apart = truth.max(axis=2) < 0.5
    error = np.abs(shown - truth).mean(axis=2)[apart] / truth[apart].mean()
    assert np.median(error) < 0.04
    assert shown[apart].mean() == pytest.approx(truth[apart].mean(), rel=0.03)


def test_textures_are_in_the_map(tmp_path: Path) -> None:
    """A coloured square under a lamp: colour times light over π."""
    value = Value((1.0,) * 3, Texture(CHECKS, srgb=True, filter="nearest"))
    surface = Material("diffuse", {"reflectance": value}, two_sided=False)
    scene = Scene((square(surface),), (PointLight((0, 0, 3), (9, 9, 9)),))
    lightmap = eclat.bake(scene, eclat.Direct(), texel_size=0.05, samples=4)
    flat = eclat.load(lightmap.save_flat(tmp_path / "flat.glb", exposure=0.0))
    emission = flat.meshes[0].material.emission
    assert emission is not None
    # Quarters of the square, which lies in the plane z = 0 with the image upright on it.
    for x, y, color in ((-0.5, 0.5, (1, 0, 0)), (0.5, 0.5, (0, 1, 0)), (-0.5, -0.5, (0, 0, 1)), (0.5, -0.5, (1, 1, 1))):
        wanted = 9 * 3 / (x * x + y * y + 9) ** 1.5 / math.pi
        weights = np.linalg.lstsq(
            np.vstack((np.asarray(flat.meshes[0].positions)[:3, :2].T, np.ones(3))), [x, y, 1], rcond=None
        )[0]
        assert flat.meshes[0].uvs is not None
        found = evaluate(emission, [(weights @ np.asarray(flat.meshes[0].uvs)[:3])[None]])[0]
        np.testing.assert_allclose(found, wanted * np.array(color), atol=0.01)


def test_lamps_without_texels_shine(tmp_path: Path) -> None:
    lamp = Material("diffuse", {"reflectance": grey(0)}, two_sided=False, emission=grey(0.5), name="lamp")
    floor = replace(square(Material(two_sided=False)), positions=square(Material()).positions - np.array([0, 0, 1]))
    up = square(lamp)
    down = replace(up, triangles=np.asarray(up.triangles)[:, ::-1])
    lightmap = eclat.bake(Scene((down, floor)), eclat.Direct(), texel_size=0.1, samples=16)
    flat = eclat.load(lightmap.save_flat(tmp_path / "flat.glb", exposure=0.0))
    found = {mesh.material.name: mesh.material.emission for mesh in flat.meshes}["lamp"]
    assert found is not None and found.texture is None and found.constant == pytest.approx((0.5,) * 3)


@pytest.mark.parametrize("wrap", ["repeat", "mirror", "clamp"])
def test_lookups_wrap(wrap: str) -> None:
    image = np.arange(4, dtype=np.float32).reshape(1, 4, 1).repeat(3, axis=2)
    value = Value((1.0,) * 3, Texture(image, wrap_u=wrap, filter="nearest"))  # type: ignore[arg-type]
    uvs = np.column_stack(((np.arange(-4, 8) + 0.5) / 4, np.full(12, 0.5)))
    there, back = [0, 1, 2, 3], [3, 2, 1, 0]
    wanted = {"repeat": there * 3, "mirror": back + there + back, "clamp": [0] * 4 + there + [3] * 4}
    assert evaluate(value, [uvs])[:, 0].tolist() == wanted[wrap]


def test_exposures_out_of_range(tmp_path: Path) -> None:
    scene = Scene((square(Material()),), (PointLight((0, 0, 3), (9, 9, 9)),))
    lightmap = eclat.bake(scene, eclat.Direct(), texel_size=0.5, samples=1)
    with pytest.raises(EclatError, match="exposure"):
        lightmap.save_flat(tmp_path / "flat.glb", exposure=1000.0)
    with pytest.raises(EclatError, match="tone_mapping"):
        lightmap.save_flat(tmp_path / "flat.glb", tone_mapping="loud")
    assert not (tmp_path / "flat.glb").exists()
