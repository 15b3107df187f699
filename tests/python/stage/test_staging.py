# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Python is the command line: names and scenes without camera or light are completed alike, with the same warnings."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.cli import main
from eclat.errors import EclatError, EclatWarning
from eclat.images.image import Image
from eclat.scenes import build
from eclat.stage.staging import staged

PYRAMID = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
QUICK = {"samples": 4, "size": (8, 8)}


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lonely.obj").write_text(PYRAMID)
    return tmp_path / "lonely.obj"


def test_a_picture_from_python_is_the_command_line_s(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["render", str(file), "--method", "path", "--samples", "4", "--size", "8x8", "-o", "a.exr"]) == 0
    said = [line.removeprefix("eclat: warning: ") for line in capsys.readouterr().err.splitlines() if "warning" in line]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        image = eclat.render(eclat.load(file), "path", **QUICK)
    assert [str(w.message) for w in caught] == said and len(said) == 2
    np.testing.assert_array_equal(image.pixels, Image.load("a.exr").pixels)
    with pytest.warns(EclatWarning, match="the scene has no light"):
        np.testing.assert_array_equal(eclat.render(file, eclat.Path, **QUICK).pixels, image.pixels)


def test_all_verbs_see_the_same_light(file: Path) -> None:
    scene = eclat.load(file)
    with pytest.warns(EclatWarning, match="the scene has no light"):
        E = eclat.irradiance(scene, [[0.4, 0.4, 0.4]], [[1, 1, 1]], eclat.Path, samples=16)
    assert E.min() > 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # said once for one scene
        assert eclat.bake(scene, "direct", texel_size=0.5, samples=4).irradiance.max() > 0
        solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.4), size=(8, 8), check=False)
        solution.save("a.npz")
        loaded = eclat.load_solved("a.npz", scene)
        assert eclat.render(scene, loaded, **QUICK).pixels.max() > 0


def test_whole_scenes_are_kept_and_others_completed_once(file: Path) -> None:
    cornell = build("cornell-box")
    assert staged(cornell) is cornell
    scene = eclat.load(file)
    with pytest.warns(EclatWarning):
        first = staged(scene)
    assert staged(scene) is first and first.cameras and first is not scene


@pytest.mark.parametrize("wrong", [None, 3, ["cornell-box"], {"type": "scene"}])
def test_values_that_are_no_scenes_are_refused(wrong: object) -> None:
    with pytest.raises(
        EclatError, match="expected a scene, the path of a scene file or the name of a built-in scene, got"
    ):
        eclat.render(wrong)  # type: ignore[arg-type]
    with pytest.raises(EclatError, match="did you mean 'cornell-box'"):
        eclat.render("cornel-box")


def test_scenes_and_pictures_have_a_short_repr(file: Path) -> None:
    cornell = build("cornell-box")
    assert repr(cornell).startswith("<Scene 'cornell-box': 8 meshes of 36 triangles, 1 glowing mesh, ")
    assert len(repr(cornell)) < 200 and len(repr(cornell.meshes[0])) < 100
    image = Image(np.arange(18, dtype=np.float32).reshape(2, 3, 3))
    assert np.asarray(image) is image.pixels
    assert np.array(image, dtype=np.float64).dtype == np.float64
    assert np.mean(image) == image.pixels.mean()


@pytest.mark.parametrize(
    ("change", "near"),
    [
        ({"a": {"type": "spheer"}}, "'sphere'"),
        ({"a": {"type": "sphere", "bsdf": {"type": "difuse"}}}, "'diffuse'"),
        ({"a": {"type": "constnt"}}, "'constant'"),
        ({"a": {"type": "perspectiv"}}, "'perspective'"),
    ],
)
def test_misspelt_types_in_a_dict(change: dict[str, object], near: str) -> None:
    with pytest.raises(EclatError, match=f"dict.*expected the type of a Mitsuba plugin, got .*did you mean {near}"):
        eclat.load_dict({"type": "scene", **change})
