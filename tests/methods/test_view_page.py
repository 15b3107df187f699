# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The page of `eclat view` as people use it: keys, pointer, settings, screen readers, browsers without WebGL 2."""

from __future__ import annotations

import base64
import io
import json
import shlex
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import eclat
from eclat.cli.scene_options import camera_options
from support.browser import WEB, look_at_page, require_browser, require_node, require_page, serve, use_page


@pytest.fixture(scope="module")
def used() -> dict[str, Any]:
    require_node(), require_browser(), require_page()
    method = eclat.IrradianceCache(max_error=0.3)
    with eclat.view("cornell-box", method, texel_size=0.3, samples=16) as viewer:
        return use_page(viewer.url)


def test_axe_finds_nothing(used: dict[str, Any]) -> None:
    assert used["violations"] == {name: [] for name in ("light", "dark", "narrow", "without")}


def test_the_tab_key_reaches_everything(used: dict[str, Any]) -> None:
    reached = used["tabs"]
    assert reached[0] == "picture" and len(set(reached)) == len(reached)
    assert {"Exposure in stops", "Tone mapping", "Overlay", "Save screenshot", "Full screen"} <= set(reached)


def flags_of(text: str) -> dict[str, list[float]]:
    words = shlex.split(text)
    return {
        name.removeprefix("--"): [float(x) for x in value.replace("x", ",").split(",")]
        for name, value in zip(words[::2], words[1::2], strict=True)
    }


def test_keys_walk_and_the_pointer_turns_the_camera(used: dict[str, Any]) -> None:
    begin, walked, turned, back = (flags_of(used["flags"][name]) for name in ("begin", "walked", "turned", "back"))
    # The camera of the Cornell box looks along -z.
    assert walked["camera-from"][2] < begin["camera-from"][2] - 1e-3
    np.testing.assert_allclose(walked["camera-from"][:2], begin["camera-from"][:2], atol=1e-4)
    assert np.linalg.norm(np.subtract(turned["camera-from"], walked["camera-from"])) > 0.1
    assert back == begin


def test_fingers_turn_and_zoom(used: dict[str, Any]) -> None:
    begin, touched, pinched = (flags_of(used["flags"][name]) for name in ("begin", "touched", "pinched"))
    assert np.linalg.norm(np.subtract(touched["camera-from"], begin["camera-from"])) > 0.1
    assert pinched["camera-from"][2] < begin["camera-from"][2] - 0.05
    np.testing.assert_allclose(pinched["camera-from"][:2], begin["camera-from"][:2], atol=0.1)


def test_the_page_fills_the_screen_and_leaves_it(used: dict[str, Any]) -> None:
    assert used["full"] == ["HTML", None]


def test_a_notebook_shows_the_viewer_in_a_frame(tmp_path: Path) -> None:
    require_node(), require_browser(), require_page()
    method = eclat.IrradianceCache(max_error=0.5)
    with eclat.view("cornell-box", method, texel_size=0.3, samples=16) as viewer:
        # As in a notebook: a page of another server on this machine, with what the value of the cell shows.
        (tmp_path / "notebook.html").write_text(
            f"<!doctype html><meta charset='utf-8'><title>cells</title>{viewer._repr_html_()}"
        )
        with serve(tmp_path) as url:
            command = [
                require_node(),
                str(WEB / "tests/view-frame.mjs"),
                require_browser(),
                f"{url}/files/notebook.html",
            ]
            done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr
    assert "iframe" not in viewer._repr_html_() and "closed" in repr(viewer)
    answer = json.loads(done.stdout)
    assert answer["title"] == "Éclat: cornell-box" and answer["records"] > 20
    assert [m for m in answer["messages"] if "favicon" not in m and "404" not in m] == []
    picture = np.asarray(Image.open(io.BytesIO(base64.b64decode(answer["shot"]))).convert("RGB"), float)
    assert picture.std() > 20


def test_the_copied_flags_are_flags_of_render(used: dict[str, Any]) -> None:
    known = {option for parameter in camera_options(lambda: None).__click_params__ for option in parameter.opts}
    assert {f"--{name}" for name in flags_of(used["flags"]["turned"])} <= known
    assert flags_of(used["flags"]["begin"])["fov"] == pytest.approx(
        [eclat.load("cornell-box").cameras[0].fov], abs=1e-3
    )


def test_the_screenshot_shows_the_picture(used: dict[str, Any]) -> None:
    picture = np.asarray(Image.open(io.BytesIO(base64.b64decode(used["screenshot"]))).convert("RGB"), float)
    red, green = picture[..., 0].mean(), picture[..., 1].mean()
    assert picture.std() > 20 and red > green > 5  # the box is lit by a warm lamp


def test_without_webgl_2_the_page_says_so(used: dict[str, Any]) -> None:
    assert "WebGL 2" in used["without"]
    assert used["messages"] == []


INSPECT = """
[...document.querySelectorAll('button')].find((b) => b.textContent.startsWith('Inspect')).click();
const end = performance.now() + 60000;
const told = () => document.querySelector('.hemisphere p').textContent.startsWith('The normal');
while (!told() && performance.now() < end) await new Promise((done) => setTimeout(done, 100));
const discs = [...document.querySelectorAll('.hemisphere canvas')].map((canvas) => {
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  return [...data];
});
window.inspected = discs;
"""
"""Clicks a record and waits for its hemisphere."""


def test_a_record_that_is_inspected_shows_its_hemisphere() -> None:
    require_node(), require_browser(), require_page()
    method = eclat.IrradianceCache(max_error=0.3)
    solution = eclat.solve("cornell-box", method, size=(64, 64), check=False)
    with eclat.view("cornell-box", solution, texel_size=0.3, samples=16) as viewer:
        shot = {"width": 640, "height": 480, "wait": 100, "script": f"(async () => {{ {INSPECT} }})()"}
        page = look_at_page(viewer.url, shot=shot | {"result": "inspected"})
    assert page.message == "" and page.messages == []
    radiance, distances, harmonics = (np.array(disc).reshape(144, 144, 4) for disc in page.result)
    assert (radiance[0, 0] == 0).all() and (radiance[72, 40:60, 3] == 255).all()
    # The record in the middle of the picture lies on a box or the back wall: red is on one side, green on the other.
    red, green = (
        (disc[20:124, 4:24, c].mean(), disc[20:124, 120:140, c].mean()) for disc, c in ((radiance, 0), (radiance, 1))
    )
    assert abs(red[0] / max(green[0], 1) - red[1] / max(green[1], 1)) > 0.5
    assert distances[..., 0].max() > 200 and harmonics[..., :3].std() > 5


def test_the_overlay_of_obstacles_is_darker_in_corners() -> None:
    choose = (
        "const overlay = [...document.querySelectorAll('select')].find((s) => "
        "[...s.options].some((o) => o.value === 'clearance')); overlay.value = 'clearance'; "
        "overlay.dispatchEvent(new Event('change'));"
    )
    scene = eclat.load("cornell-box")
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.1), size=(64, 64), check=False)
    with eclat.view(scene, solution, texel_size=0.3, samples=16) as viewer:
        page = look_at_page(viewer.url, shot={"width": 360, "height": 300, "wait": 3000, "script": choose})
    assert page.message == "" and page.messages == []
    # The picture is the upper 180 rows, and the box the middle of it: the lower edge of the back wall beside its middle.
    box = page.shot[:180, 90:270].astype(float) if page.shot is not None else np.zeros((180, 180, 3))
    middle, corners = box[70:80, 120:140], box[[37, 37], [37, 143]]
    assert corners[:, 1].mean() < middle[..., 1].mean() - 20
    assert middle[..., 1].mean() > middle[..., 0].mean() + 20  # the colours of the overlay, not of the warm wall
