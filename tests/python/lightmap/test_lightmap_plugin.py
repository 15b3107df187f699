# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""web/eclat-lightmap.js in three.js, in headless Chromium: radiance is ρ/π · E of texels that are known."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from eclat.images.tone import srgb_decode
from support.browser import View, gltf_issues, open_example, render_in_three
from support.lit_quads import expected_radiance, save_lit_quad

SIZE = 32
INTENSITY = 12.5

_rng = np.random.default_rng(5)
# Not square, without symmetry; the two maps differ, so that the one cannot be taken for the other.
IRRADIANCE = _rng.uniform(0.5, 40.0, (5, 7, 3))
ENCODED = _rng.integers(0, 256, IRRADIANCE.shape, dtype=np.uint8)
EMBEDDED = expected_radiance(INTENSITY * srgb_decode(ENCODED / 255), SIZE)

Views = tuple[dict[str, View | str], list[str]]


def _sidecar(change: Callable[[dict[str, Any]], Any]) -> Callable[[Path, str], None]:
    """What rewrites the JSON side-car as `change` does."""

    def rewrite(folder: Path, stem: str) -> None:
        path = folder / f"{stem}.lightmap.json"
        content = json.loads(path.read_text(encoding="utf-8"))
        change(content)
        path.write_text(json.dumps(content), encoding="utf-8")

    return rewrite


def _page(suffix: str) -> Callable[[Path, str], None]:
    """What puts a page of HTML in a side-car's place, as servers do that answer everything."""

    def write(folder: Path, stem: str) -> None:
        (folder / f"{stem}.lightmap.{suffix}").write_text("<!doctype html><title>Home</title>", encoding="utf-8")

    return write


BROKEN: dict[str, tuple[Callable[[Path, str], None], str]] = {
    # name: what happens to the side-cars, what the warning says of it
    "no-json": (
        lambda folder, stem: (folder / f"{stem}.lightmap.json").unlink(),
        "no-json.lightmap.json cannot be read",
    ),
    "no-exr": (lambda folder, stem: (folder / f"{stem}.lightmap.exr").unlink(), "no-exr.lightmap.exr cannot be read"),
    "bad-json": (_page("json"), "bad-json.lightmap.json is not JSON"),
    "bad-exr": (_page("exr"), "bad-exr.lightmap.exr is not an EXR file that three.js can read"),
    "later-version": (_sidecar(lambda content: content.update(version=2)), "version 1, got version 2"),
    "other-bake": (
        _sidecar(lambda content: content.update(set="another bake")),
        "other-bake.lightmap.json is of another bake than the scene",
    ),
    "no-page": (_sidecar(lambda content: content.update(pages=[])), "no-page.lightmap.json has no page for texture 0"),
}


def _edit_glb(path: Path, old: bytes, new: bytes) -> None:
    """Replace text of the same length in a GLB's JSON."""
    data = path.read_bytes()
    assert old in data and len(old) == len(new)
    path.write_bytes(data.replace(old, new))


@pytest.fixture(scope="module")
def views(tmp_path_factory: pytest.TempPathFactory) -> Views:
    """All pictures of this module by name, made in one browser, and what the console said."""
    folder = tmp_path_factory.mktemp("quads")
    save_lit_quad(folder, "quad", IRRADIANCE, ENCODED, INTENSITY, materials=3)
    save_lit_quad(folder, "daylight", 1e5 * IRRADIANCE, ENCODED, INTENSITY)
    save_lit_quad(folder, "moonless", 1e-8 * IRRADIANCE, ENCODED, INTENSITY)
    _edit_glb(save_lit_quad(folder, "draft", IRRADIANCE, ENCODED, INTENSITY), b'"texCoord": 1, ', b" " * 15)
    _edit_glb(save_lit_quad(folder, "bare", IRRADIANCE, ENCODED, INTENSITY), b"MOZ_lightmap", b"XYZ_lightmap")
    _edit_glb(
        save_lit_quad(folder, "astray", IRRADIANCE, ENCODED, INTENSITY), b'htmap": {"index": 0', b'htmap": {"index": 7'
    )
    save_lit_quad(folder, "50 % of #1?", IRRADIANCE, ENCODED, INTENSITY)
    jobs = {
        name: {"file": f"{name}.glb"}
        for name in ("quad", "daylight", "moonless", "draft", "bare", "astray", "50 % of #1?")
    }
    jobs["embedded"] = {"file": "quad.glb", "plugin": {"exr": False}}
    for name, (damage, _) in BROKEN.items():
        save_lit_quad(folder, name, IRRADIANCE, ENCODED, INTENSITY)
        damage(folder, name)
        jobs[name] = {"file": f"{name}.glb"}
    made, said = render_in_three(folder, [{"width": SIZE, "height": SIZE, **job} for job in jobs.values()])
    return dict(zip(jobs, made, strict=True)), said


def view(views: Views, name: str) -> View:
    made = views[0][name]
    assert isinstance(made, View), made
    return made


def check(pixels: NDArray[np.float32], expected: NDArray[np.float64]) -> None:
    """Half floats have 11 bits, and graphics cards interpolate with weights of 8."""
    np.testing.assert_allclose(pixels, expected, rtol=2**-11, atol=2**-8 * expected.max())


@pytest.mark.parametrize(
    ("name", "scale"), [("quad", 1.0), ("daylight", 1e5), ("moonless", 1e-8), ("draft", 1.0), ("50 % of #1?", 1.0)]
)
def test_an_unclipped_texel_is_albedo_over_pi_times_irradiance(views: Views, name: str, scale: float) -> None:
    # Millions of lux exceed the range of half floats, starlight falls below it.
    check(view(views, name).pixels, scale * expected_radiance(IRRADIANCE, SIZE))


def test_embedded_map_is_srgb_times_intensity(views: Views) -> None:
    check(view(views, "embedded").pixels, EMBEDDED)


@pytest.mark.parametrize(("name", "color_space"), [("quad", "srgb-linear"), ("embedded", "srgb")])
def test_materials_share_one_texture_without_mipmaps(views: Views, name: str, color_space: str) -> None:
    maps = view(views, name).light_maps
    assert len(maps) == 3
    assert len({m["texture"] for m in maps.values()}) == 1
    assert {(m["channel"], m["colorSpace"], m["mipmaps"]) for m in maps.values()} == {(1, color_space, False)}


@pytest.mark.parametrize("name", BROKEN)
def test_without_a_side_car_the_embedded_map_is_taken_and_said(views: Views, name: str) -> None:
    check(view(views, name).pixels, EMBEDDED)
    warnings = [line for line in views[1] if line.startswith("warning: EclatLightmap") and BROKEN[name][1] in line]
    assert len(warnings) == 1, views[1]


def test_a_valid_scene_causes_no_warning(views: Views) -> None:
    # The browser itself reports the files that are not there.
    said = [line for line in views[1] if "EclatLightmap" in line]
    assert len(said) == len(BROKEN), said


def test_files_without_light_map_stay_as_they_are(views: Views) -> None:
    made = view(views, "bare")
    assert [m["texture"] for m in made.light_maps.values()] == [None]
    assert not made.pixels.any()


def test_a_texture_that_is_not_there_is_an_error(views: Views) -> None:
    assert views[0]["astray"] == "EclatLightmap: material 0: the file has no texture 7"


def test_hand_made_files_are_valid(tmp_path: Path) -> None:
    issues = gltf_issues(save_lit_quad(tmp_path, "quad", IRRADIANCE, ENCODED, INTENSITY))
    assert issues["errors"] == issues["warnings"] == []


def test_the_example_shows_a_file_with_and_without_its_light_map(tmp_path: Path) -> None:
    save_lit_quad(tmp_path, "quad", IRRADIANCE, ENCODED, INTENSITY)
    shown, said = open_example(tmp_path, "quad.glb")
    assert said == []
    assert [message for message, _ in shown.values()] == ["", "", ""]
    # Above the controls: two maps of noise that differ, and one colour where there is none.
    pages = {light: page[20:260, 160:480].astype(float) for light, (_, page) in shown.items()}
    assert min(pages["exr"].std(axis=(0, 1)).max(), pages["embedded"].std(axis=(0, 1)).max()) > 10
    assert np.abs(pages["exr"] - pages["embedded"]).mean() > 10
    assert pages["none"].mean() > 20
    assert pages["none"].std(axis=(0, 1)).max() < 5
